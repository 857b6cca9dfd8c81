#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# What a user gets who mistypes: exit status 2, a line that names the file, and nothing left behind.
# Usage: cli_test.sh PATH_OF_RESIGHT
set -uo pipefail
resight=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0

# expect STATUS PATTERN ARGUMENT...: the exit status, and a pattern that its output must match.
expect() {
  local status=$1 pattern=$2 output actual
  shift 2
  output=$("$resight" "$@" 2>&1)
  actual=$?
  if ((actual != status)) || ! grep -qiE -- "$pattern" <<<"$output"; then
    printf 'resight %s\n  exit status %d (expected %d), output (expected /%s/):\n%s\n' "$*" "$actual" "$status" "$pattern" "$output"
    failures=$((failures + 1))
  fi
}
# expect_one_line ARGUMENT...: bad input is told in one line on stderr.
expect_one_line() {
  local lines
  lines=$("$resight" "$@" 2>&1 >/dev/null | wc -l)
  if ((lines != 1)); then
    printf 'resight %s: %d lines on stderr (expected 1)\n' "$*" "$lines"
    failures=$((failures + 1))
  fi
}

expect 0 '^[0-9]+\.[0-9]+\.[0-9]+' --version
expect 0 'recognize' --help
expect 0 '--sequence' recognize --help
expect 2 'subcommand' # none given
expect 2 'subcommand' nonsense
expect 2 '--out' recognize --models a --sequence b
expect 2 'nowhere' recognize --models "$work/nowhere.resight" --sequence "$work" --out "$work/out"
expect_one_line recognize --models "$work/nowhere.resight" --sequence "$work" --out "$work/out"
echo 'not a model library' >"$work/text.resight"
expect 2 'text\.resight' recognize --models "$work/text.resight" --sequence "$work" --out "$work/out"
expect 2 'nowhere' train "$work/nowhere" --out "$work/models.resight"
expect 2 'nowhere' changes --sequence "$work/nowhere" --out "$work/out"
mkdir "$work/empty"
expect 2 'empty' changes --sequence "$work/empty" --out "$work/out"
expect_one_line changes --sequence "$work/empty" --out "$work/out"
expect 2 'nowhere' convert "$work/nowhere" "$work/out" --to bop
expect 2 'nowhere' evaluate --models "$work/text.resight" --dataset "$work/nowhere" --out "$work/out"
expect 2 'text\.resight|sequence' evaluate --models "$work/text.resight" --dataset "$work/empty" --out "$work/out"
expect 2 'I/N' evaluate --models "$work/text.resight" --dataset "$work/empty" --out "$work/out" --shard 3/2
expect 2 'ranges' evaluate --models "$work/text.resight" --dataset "$work/empty" --out "$work/out" -k 5-2
expect 2 'preset' evaluate --models "$work/text.resight" --dataset "$work/empty" --out "$work/out" --presets best
expect_one_line evaluate --models "$work/text.resight" --dataset "$work/empty" --out "$work/out" --shard x
if [[ -e $work/out || -e $work/models.resight ]]; then
  echo "failed commands left something behind: $(ls "$work")"
  failures=$((failures + 1))
fi

((failures == 0)) && echo "cli: all as expected"
exit $((failures > 0))
