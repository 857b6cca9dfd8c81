#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Each command that writes is disturbed: killed or interrupted at a random moment, by a limit on the size of files, by a
# read-only folder, by a full disk. Called again, it must end with the bytes of a run that was not disturbed (times
# excepted), and nothing else may be left. "Again": the folder holds results of a run before. The moments follow from a
# fixed seed, and from the speed of the machine.
# Usage: faults_test.sh PATH_OF_RESIGHT [ROUNDS per command] [COMMAND...]
set -uo pipefail
resight=$(realpath "$1")
rounds=${2:-1}
chosen=("${@:3}")
source "$(dirname "${BASH_SOURCE[0]}")/small_scene.sh"
cd "$work" || exit 1
RANDOM=1

# Commands run in a folder of their own beside the data.
declare -A arguments=(
  [simulate]="../scene.toml --out out --format bop"
  [convert]="../data/test/000001 out --to tuw"
  [convert_models]="../meshes out --to bop"
  [convert_rendered]="../meshes out --to tuw"
  [train]="../meshes --out out.resight"
  [recognize]="--models ../models.resight --sequence ../data/test/000001 --out out"
  [changes]="--sequence ../data/test/000001 --out out"
  [track]="--sequence ../data/test/000001 --out out.txt --fused out.ply --write-sequence posed"
  [evaluate]="--models ../models.resight --dataset ../data --presets mvr -k 0,1 --out out"
  [model]="--sequence ../side --every 4 --out out"
)
arguments[recognize_again]=${arguments[recognize]}
arguments[changes_again]=${arguments[changes]}
commands=(simulate convert convert_models train recognize recognize_again changes changes_again track evaluate)
((rounds >= 5)) && commands+=(convert_rendered model) # these take longer
((${#chosen[@]} > 0)) && commands=("${chosen[@]}")
faults=(kill interrupt file_limit read_only full_disk)

write_scene 3 -110 -90 false >scene.toml
run simulate scene.toml --out data --format bop --seed 1
run train data/models --out models.resight
mkdir meshes && cp data/models/obj_000002.ply meshes
if [[ " ${commands[*]} " == *" model "* ]]; then
  run simulate --preset turntable-recording --out recording
  run convert recording/side_1 side --to bop # of which views can be left out
fi

can_mount=true
unshare -m mount -t tmpfs none "$work" 2>/dev/null || can_mount=false
$can_mount || echo "without the right to mount: no full disk, and no read-only folder for root"

program() { # program COMMAND: its arguments, "convert_models" being a "convert"
  echo "$resight ${1%_*} ${arguments[$1]}"
}

# Every name with a hash of what does not depend on time.
list() { # list FOLDER
  (
    cd "$1" && find . -mindepth 1 | LC_ALL=C sort | while read -r file; do
      case $file in
        *.json | *.csv | *.md | *.svg | *.html) ;;
        *) [[ -f $file ]] && echo "$file $(md5sum <"$file")" || echo "$file" && continue ;;
      esac
      case $file in
        */detections.csv) echo "$file $(sed 's/,[^,]*$//' "$file" | md5sum)" ;;
        */summary.json | */report.html | */times.* | */view_time.svg | */verification_time* | ./out/runs/*) echo "$file" ;;
        *) echo "$file $(md5sum <"$file")" ;;
      esac
    done
  )
}

random() { # random FROM TO: into `picked`, because a substitution of commands would start its own series
  picked=$(($1 + (RANDOM * 32768 + RANDOM) % ($2 - $1 + 1)))
}

disturb() { # disturb COMMAND FAULT: in the folder `round`; returns the status of the command
  local call ms size
  call=$(program "$1")
  random 20 $((duration_ms[$1] * 11 / 10))
  ms=$picked
  what="$2"
  case $2 in
    kill | interrupt)
      what="$2 after $ms ms"
      local signal=KILL
      [[ $2 == interrupt ]] && signal=INT
      (cd round && timeout -s $signal "$((ms / 1000)).$(printf %03d $((ms % 1000)))" $call >../log 2>&1) 2>/dev/null
      ;;
    file_limit)
      random 1 "${largest_kb[$1]}"
      size=$picked
      what="$2 of $size kB"
      (cd round && ulimit -f "$size" && $call 2>&1 | cat >../log)
      ;;
    read_only)
      $can_mount || ((UID > 0)) || return 0
      if ((UID > 0)); then
        chmod a-w round && (cd round && $call >../log 2>&1)
      else
        unshare -m bash -c "mount --bind round round && mount -o remount,ro,bind round && cd round && $call >../log 2>&1"
      fi
      local status=$?
      chmod u+w round
      return $status
      ;;
    full_disk)
      $can_mount || return 0
      random 1 $((total_kb[$1] + 16))
      size=$picked
      what="$2 of $size kB"
      # What is left on the full disk is copied to one with space.
      unshare -m bash -c "mount -t tmpfs -o size=${size}k none round && (cd round && $call >../log 2>&1)
                          status=\$?; mkdir kept && cp -a round/. kept; exit \$status"
      local status=$?
      rm -rf round && mv kept round
      return $status
      ;;
  esac
}

check_mixture() { # check_mixture COMMAND: a folder into which files were being moved is not read
  [[ -e round/out/.resight-unfinished ]] || return
  num_mixtures=$((num_mixtures + 1))
  "$resight" view round/out --no-open >log 2>&1 && fail "$1, $what: the mixture was read"
  grep -q 'is not finished' log || fail "$1, $what: of a mixture it is said: $(tail -1 log)"
}

check_after_fault() { # check_after_fault COMMAND FAULT STATUS: of what the first run has left
  if [[ $2 == kill ]]; then
    check_mixture "$1"
    return
  fi
  local left
  left=$(find round -name '*.resight-*')
  [[ -z $left ]] || fail "$1, $what: left $left"
  ((${3} < 120)) || [[ $2 == interrupt ]] || fail "$1, $what: ended with status $3"
  [[ $2 == interrupt ]] && return
  grep -q '^resight: ' log || fail "$1, $what: no line says why: $(tail -1 log)"
}

declare -A duration_ms largest_kb total_kb num_disturbed
num_mixtures=0
for command in "${commands[@]}"; do
  mkdir "$command"
  begin=$(date +%s%N)
  (cd "$command" && $(program "$command") >../log 2>&1) || { fail "$command failed: $(tail -1 log)"; exit 1; }
  duration_ms[$command]=$((($(date +%s%N) - begin) / 1000000))
  largest_kb[$command]=$(($(find "$command" -type f -printf '%s\n' | sort -n | tail -1) / 1024 + 1))
  total_kb[$command]=$(du -sk "$command" | cut -f 1)
  list "$command" >"$command.list"
done

for ((i = 0; i < ${#commands[@]}; ++i)); do
  command=${commands[i]}
  for ((round = 0; round < rounds; ++round)); do
    fault=${faults[(i + round) % ${#faults[@]}]}
    rm -rf round && mkdir round
    [[ $command == *_again ]] && cp -a "$command/." round
    what=""
    disturb "$command" "$fault"
    status=$?
    # A run may have ended before it was disturbed, or just then.
    if ((status != 0)); then
      check_after_fault "$command" "$fault" "$status"
      num_disturbed[$command.$fault]=$((${num_disturbed[$command.$fault]:-0} + 1))
      list round | cmp -s - "$command.list" && continue
      (cd round && $(program "$command") >../log 2>&1) || { fail "$command, $what: then refused: $(tail -1 log)"; continue; }
    elif [[ -z $(ls -A round) ]]; then
      continue # not tested here
    fi
    list round >round.list
    cmp -s round.list "$command.list" || fail "$command, $what: other results: $(diff round.list "$command.list" | head -5)"
  done
done

for command in "${commands[@]}"; do
  counts=""
  for fault in "${faults[@]}"; do counts+=" $fault ${num_disturbed[$command.$fault]:-0}"; done
  echo "$command (${duration_ms[$command]} ms), disturbed:$counts"
done
echo "killed while files were moved: $num_mixtures"
((failures == 0)) && echo "faults: all as expected"
exit $((failures > 0))
