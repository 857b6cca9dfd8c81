#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Each command that writes is disturbed: killed or interrupted at a random moment, by a limit on the size of files, by a
# read-only folder, by a full disk. Called again, it must end with the bytes of a run that was not disturbed (times
# excepted), and nothing else may be left. From leftovers like those of an earlier fault, it is not called again: mostly,
# nothing is left. "Again": the folder holds results of a run before. The moments follow from a fixed seed
# (RESIGHT_FAULT_SEED gives another one), and from the speed of the machine. Fails also if fewer than half of the runs
# were disturbed.
# Usage: faults_test.sh PATH_OF_RESIGHT [ROUNDS per command, a tenth for slow ones] [COMMAND...]
set -uo pipefail
resight=$(realpath "$1")
rounds=${2:-1}
chosen=("${@:3}")
source "$(dirname "${BASH_SOURCE[0]}")/small_scene.sh"
cd "$work" || exit 1
RANDOM=${RESIGHT_FAULT_SEED:-1}

# Commands run in a folder of their own beside the data.
declare -A arguments=(
  [simulate]="../scene.toml --out out --format bop"
  [convert]="../data/test/000001 out --to tuw"
  [convert_models]="../meshes out --to bop"
  [convert_rendered]="../meshes out --to tuw"
  [train]="../meshes --out out.resight"
  [recognize]="--models ../models.resight --sequence ../data/test/000001 --out out --trace"
  [recognize_follow]="--models ../models.resight --sequence ../data/test/000001 --out out --follow --keep-late --max-views 3"
  [changes]="--sequence ../data/test/000001 --out out"
  [track]="--sequence ../data/test/000001 --out out.txt --fused out.ply --write-sequence posed"
  [check]="../data/test/000001 --depth-scale 0.005 --out out"
  [annotate]="--models ../models.resight --sequence ../data/test/000001 --out out --no-open"
  [demo]="--out out"
  [evaluate]="--models ../models.resight --dataset ../data --presets mvr -k 0,1 --out out --bop"
  [evaluate_shard]="--models ../models.resight --dataset ../two --presets mvr -k 0 --out out --shard 1/2"
  [evaluate_last_shard]="--models ../models.resight --dataset ../two --presets mvr -k 0 --out out --shard 2/2"
  [model]="--sequence ../side --every 4 --out out"
)
arguments[recognize_again]=${arguments[recognize]}
arguments[changes_again]=${arguments[changes]}
arguments[check_again]=${arguments[check]}
# What is called in the folder before.
declare -A earlier=([recognize_again]=recognize [changes_again]=changes [check_again]=check
  [evaluate_last_shard]=evaluate_shard)
declare -A success=([check]=1 [check_again]=1) # the status if there are findings
commands=(simulate convert convert_models train recognize recognize_again recognize_follow changes changes_again track
  check check_again annotate evaluate evaluate_shard evaluate_last_shard)
slow=(convert_rendered model demo)
((rounds >= 5)) && commands+=("${slow[@]}")
((${#chosen[@]} > 0)) && commands=("${chosen[@]}")
faults=(kill interrupt file_limit read_only full_disk)
# The fault of the first round; of other commands it follows from their place. `evaluate` once left half of its tables.
declare -A first_fault=([evaluate]=4)

write_scene 3 -110 -90 false >scene.toml
run simulate scene.toml --out data --format bop --seed 1
run train data/models --out models.resight
mkdir meshes && cp data/models/obj_000002.ply meshes
if [[ " ${commands[*]} " == *" model "* ]]; then
  run simulate --preset turntable-recording --out recording
  run convert recording/side_1 side --to bop # of which views can be left out
fi

if [[ " ${commands[*]} " == *" evaluate_"* ]]; then
  mkdir -p two/test && cp -r data/models two && cp -r data/test/000001 two/test && cp -r data/test/000001 two/test/000002
fi

# Runs `annotate` and interrupts it as soon as it tells its address; then it writes its export.
cat >until_address <<'SCRIPT'
#!/usr/bin/env bash
(while kill -0 $$ && ! grep -q '^http' ../log; do sleep 0.02; done; kill -INT $$) >/dev/null 2>&1 &
exec "$@"
SCRIPT
chmod +x until_address

can_mount=true
unshare -m mount -t tmpfs none "$work" 2>/dev/null || can_mount=false
$can_mount || echo "without the right to mount: no full disk, and no read-only folder for root"

program() { # program COMMAND: with its arguments, "convert_models" being a "convert"
  local starter=""
  [[ $1 == annotate ]] && starter="../until_address "
  echo "$starter$resight ${1%%_*} ${arguments[$1]}"
}

run_in() { # run_in FOLDER COMMAND: fails if the command does
  (cd "$1" && $(program "$2") >../log 2>&1)
  (($? == ${success[$2]:-0}))
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

count_kb() { # count_kb FOLDER: of its files
  find "$1" -type f -printf '%k\n' | awk '{ sum += $1 } END { print sum + 0 }'
}

random() { # random FROM TO: into `picked`, because a substitution of commands would start its own series
  picked=$(($1 + (RANDOM * 32768 + RANDOM) % ($2 - $1 + 1)))
}

disturb() { # disturb COMMAND FAULT: in the folder `round`; returns the status of the command
  local call ms size
  call=$(program "$1")
  rm -f log
  random 20 $((duration_ms[$1] * 11 / 10))
  ms=$picked
  what="$2"
  case $2 in
    kill | interrupt)
      what="$2 after $ms ms"
      local signal=KILL
      [[ $2 == interrupt ]] && signal=INT
      (cd round && timeout --preserve-status -s $signal "$((ms / 1000)).$(printf %03d $((ms % 1000)))" $call >../log 2>&1) 2>/dev/null
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
      random 1 $((total_kb[$1] - 4)) # less than what it writes, as a page has 4 kB
      size=$picked
      what="$2 of $size kB"
      # What is there before is copied to a disk of which so much is free, and what is left to one with space.
      size=$((size + $(count_kb round)))
      unshare -m bash -c "mkdir -p full && mount -t tmpfs -o size=${size}k none full && cp -a round/. full
                          (cd full && $call >../log 2>&1); status=\$?
                          mkdir kept && cp -a full/. kept; exit \$status"
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

check_finished_views() { # check_finished_views COMMAND: views that are kept are those of a run that was not disturbed
  local kept=round/out/finished_views.jsonl
  [[ $1 == recognize* && -e $kept ]] || return
  num_kept=$((num_kept + 1))
  cmp -s -n "$(stat -c %s $kept)" $kept "$1.views" || fail "$1, $what: the finished views are others"
}

stopped() { # stopped COMMAND FAULT: what follows views ends with those so far, and that is no error
  [[ $1 == *_follow && $2 == interrupt ]] && ! cmp -s round.list "$1.list"
}

check_after_fault() { # check_after_fault COMMAND FAULT STATUS: of what the first run has left
  check_finished_views "$1"
  if [[ $2 == kill ]]; then
    (($3 == 128 + 9)) || fail "$1, $what: ended with status $3"
    check_mixture "$1"
    return
  fi
  local left
  left=$(find round -name '*.resight-*')
  [[ -z $left ]] || fail "$1, $what: left $left"
  if [[ $2 == interrupt ]]; then
    [[ $1 == *_follow ]] && { (($3 == 0)) || grep -q '^resight: no view has come' log; } && return
    (($3 == 128 + 2)) || fail "$1, $what: ended with status $3: $(tail -1 log)"
    return
  fi
  (($3 < 120)) || fail "$1, $what: ended with status $3"
  grep -q '^resight: ' log || fail "$1, $what: no line says why: $(tail -1 log)"
}

declare -A duration_ms largest_kb total_kb num_tried num_disturbed
declare -A continued # commands with what was left, from which they were called again
num_mixtures=0
num_kept=0
for command in "${commands[@]}"; do
  mkdir "$command"
  if [[ -n ${earlier[$command]:-} ]]; then
    run_in "$command" "${earlier[$command]}" || { fail "${earlier[$command]} failed: $(tail -1 log)"; exit 1; }
    cp -a "$command" "$command.before"
  fi
  begin=$(date +%s%N)
  run_in "$command" "$command" || { fail "$command failed: $(tail -1 log)"; exit 1; }
  duration_ms[$command]=$((($(date +%s%N) - begin) / 1000000))
  largest_kb[$command]=$(($(find "$command" -type f -printf '%s\n' | sort -n | tail -1) / 1024 + 1))
  total_kb[$command]=$(count_kb "$command")
  list "$command" >"$command.list"
  if [[ $command == recognize* ]]; then # the views as it keeps them while it works
    mkdir streamed && (cd streamed && $(program "$command") --stream) >"$command.views" 2>log && rm -r streamed ||
      { fail "$command --stream failed: $(tail -1 log)"; exit 1; }
  fi
done

total_tried=0
total_disturbed=0
report() { # report COMMAND: a line with how often each fault disturbed it
  local fault counts="" tried=${num_tried[$1]:-0} disturbed=0
  for fault in "${faults[@]}"; do
    counts+=" $fault ${num_disturbed[$1.$fault]:-0}"
    disturbed=$((disturbed + ${num_disturbed[$1.$fault]:-0}))
  done
  echo "$1 (${duration_ms[$1]} ms), disturbed:$counts"
  ((tried < 5 || disturbed > 0)) || fail "$1: none of $tried runs was disturbed"
  total_tried=$((total_tried + tried))
  total_disturbed=$((total_disturbed + disturbed))
}

for ((i = 0; i < ${#commands[@]}; ++i)); do
  command=${commands[i]}
  num_rounds=$rounds
  [[ " ${slow[*]} " == *" $command "* ]] && num_rounds=$((rounds < 50 ? 5 : rounds / 10))
  for ((round = 0; round < num_rounds; ++round)); do
    fault=${faults[(${first_fault[$command]:-i} + round) % ${#faults[@]}]}
    rm -rf round && mkdir round
    [[ -d $command.before ]] && cp -a "$command.before/." round
    what=""
    disturb "$command" "$fault"
    status=$?
    # A run may have ended before it was disturbed, or just then.
    if ((status == 0)) && [[ -z $(ls -A round) ]]; then continue; fi # not tested here
    num_tried[$command]=$((${num_tried[$command]:-0} + 1))
    list round >round.list
    if ((status != ${success[$command]:-0})) || stopped "$command" "$fault"; then
      check_after_fault "$command" "$fault" "$status"
      num_disturbed[$command.$fault]=$((${num_disturbed[$command.$fault]:-0} + 1))
      cmp -s round.list "$command.list" && continue
      left=$(md5sum <round.list)
      [[ -n ${continued[$command.$left]:-} ]] && continue # mostly nothing is left
      continued[$command.$left]=yes
      run_in round "$command" || { fail "$command, $what: then refused: $(tail -1 log)"; continue; }
      list round >round.list
    fi
    cmp -s round.list "$command.list" || fail "$command, $what: other results: $(diff round.list "$command.list" | head -5)"
  done
  report "$command"
done
echo "killed while files were moved: $num_mixtures; finished views were kept: $num_kept"
((total_disturbed > 0 && 2 * total_disturbed >= total_tried)) ||
  fail "only $total_disturbed of $total_tried runs were disturbed: this tests too little"
((failures == 0)) && echo "faults: all as expected"
exit $((failures > 0))
