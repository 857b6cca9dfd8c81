# SPDX-License-Identifier: Apache-2.0
# For scripts that keep what is finished, and whose parts several calls can compute, also at the same time. Sourced from
# the root of the source tree, before common.sh.

shard="" merge=0 can_build=1
missing=() failed=()  # parts that are not finished, and those whose command failed
num_parts=0

# read_options NAME... -- ARGUMENT...: sets the variable NAME for each option --NAME VALUE of the script, and those above
# for --shard I/N, --merge and --no-build. Calls usage() if an argument is wrong.
read_options() {
  local names=" shard "
  while [[ $1 != -- ]]; do
    names+="$1 "
    shift
  done
  shift
  while (($# > 0)); do
    case "$1" in
      --merge) merge=1; shift; continue ;;
      --no-build) can_build=0; shift; continue ;;
    esac
    [[ $# -gt 1 && $1 == --?* && $names == *" ${1#--} "* ]] || usage
    printf -v "${1#--}" %s "$2"
    shift 2
  done
  [[ $shard == "" || $shard =~ ^[1-9][0-9]*/[1-9][0-9]*$ && ${shard%/*} -le ${shard#*/} && $merge == 0 ]] || usage
  shard_number=${shard%/*} num_shards=${shard#*/}
  log_dir=build/logs/$(basename "$0" .sh)-${shard/\//-of-}
}

# take_turn FILE [NAME]: whether this call makes FILE. It does not if FILE exists, or if it is the turn of another shard.
# Called for all files in the same order, so that no two shards make the same file.
take_turn() {
  num_parts=$((num_parts + 1))
  [[ ! -e $1 ]] || return 1
  ((!merge)) && { [[ -z $shard ]] || ((num_parts % num_shards + 1 == shard_number)); } && return
  missing+=("${2:-$1}")
  return 1
}

# exit_unless_finished: ends the script if parts are missing, with 0 if only other shards have parts to compute.
exit_unless_finished() {
  ((${#missing[@]} > 0)) || return 0
  echo "not finished, so nothing is written: ${missing[*]}"
  [[ -n $shard ]] && ((${#failed[@]} == 0)) || exit 1
  exit 0
}

# require_commit OPTION PATH...: tables name a commit, so the programs must be those of a commit. Names the option for
# another page.
require_commit() {
  [[ -z $(git status --porcelain -- CMakeLists.txt cmake src apps bench "${@:2}") ]] && return
  echo "$(basename "$0"): there are uncommitted changes; commit them, or write elsewhere with $1" >&2
  exit 2
}
