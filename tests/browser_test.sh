#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# `resight view` opens a browser, which inherits none of its sockets and files. A script plays xdg-open.
# Usage: browser_test.sh PATH_OF_RESIGHT
set -uo pipefail
resight=$(realpath "$1")
source "$(dirname "${BASH_SOURCE[0]}")/small_scene.sh"
cd "$work" || exit 1

write_scene 1 -90 -90 false >scene.toml
run simulate scene.toml --out data --format bop --seed 1

mkdir bin
printf '#!/bin/sh\nreadlink /proc/$$/fd/* >"%s/found"; mv "%s/found" "%s/inherited"\n' "$work" "$work" "$work" >bin/xdg-open
chmod +x bin/xdg-open
PATH=$work/bin:$PATH DISPLAY=:0 timeout 60 "$resight" view data/test/000001 >log 2>&1 &
program=$!
for _ in $(seq 300); do
  [ -e inherited ] || ! kill -0 $program 2>/dev/null && break
  sleep 0.1
done
kill -TERM $program # a shell lets its jobs ignore SIGINT
wait $program
[ -s inherited ] || fail "no browser was opened: $(cat log)"
grep -E 'socket:|anon_inode:|/data/' inherited && fail "the browser inherits these of the program"

[ $failures = 0 ] && echo "all as it should be"
exit $failures
