#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# On a file system without locks, commands work. What a killed one has left is not removed, because nobody knows whether
# it still lives: one line names it. Usage: no_locks_test.sh PATH_OF_RESIGHT LIBRARY_WITHOUT_LOCKS
set -uo pipefail
resight=$(realpath "$1")
no_locks=$(realpath "$2")
source "$(dirname "${BASH_SOURCE[0]}")/small_scene.sh"
cd "$work" || exit 1

without_locks() { # without_locks STATUS PATTERN COMMAND...: one line on standard error, or none if the pattern is empty
  local status=$1 pattern=$2
  shift 2
  LD_PRELOAD=$no_locks "$resight" "$@" >out.txt 2>err.txt
  local ended=$?
  [[ $ended == "$status" ]] || fail "resight $1 ended with $ended instead of $status: $(tail -n 1 err.txt)"
  grep -vE '^[a-z-]+ [0-9]+/[0-9]+: ' err.txt >said.txt
  if [[ -z $pattern ]]; then
    [[ ! -s said.txt ]]
  else
    [[ $(wc -l <said.txt) == 1 ]] && grep -qE "^resight: .*$pattern" said.txt
  fi || fail "resight $1 says: $(cat said.txt)"
}

write_scene 2 -110 -100 false >scene.toml
without_locks 0 '' simulate scene.toml --out data --format bop
without_locks 0 '' convert data/test/000001 new --to tuw
mkdir filled
without_locks 0 '' changes --sequence data/test/000001 --out filled
mkdir filled/mine
without_locks 0 '' changes --sequence data/test/000001 --out filled
[[ -s filled/changes.json && -d filled/mine ]] || fail "an existing folder was not filled"
find . -name '*.resight-*' | grep -q . && fail "left: $(find . -name '*.resight-*')"

mkdir .again.resight-partial filled/.filled.resight-partial
without_locks 2 '\.again\.resight-partial is in the way; delete it if no other command is running' \
  convert data/test/000001 again --to tuw
without_locks 2 '\.filled\.resight-partial is in the way; delete it' changes --sequence data/test/000001 --out filled
run train data/models --out models.resight
without_locks 2 'annotation\.jsonl: cannot be locked' \
  annotate --models models.resight --sequence data/test/000001 --out project --no-open

((failures == 0)) && echo "no locks: all as expected"
exit $((failures > 0))
