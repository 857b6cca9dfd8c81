#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs each command that uses threads on a small scene, with two threads. Under ThreadSanitizer, a data race ends a
# command with an error. Usage: threads_test.sh PATH_OF_RESIGHT
set -uo pipefail
resight=$(realpath "$1")
source "$(dirname "${BASH_SOURCE[0]}")/small_scene.sh"
cd "$work" || exit 1

run_threaded() { # run_threaded COMMAND ARGUMENT...
  "$resight" "$@" --threads 2 >log 2>&1 || fail "resight $1 failed: $(tail -n 40 log)"
}

{
  write_scene 3 -110 -80 true
  remove_tea 1
} >scene.toml
run_threaded simulate scene.toml --out data --format bop
run_threaded train data/models --out models.resight
for preset in mvr-chd default; do
  run_threaded recognize --models models.resight --sequence data/test/000001 --preset $preset --out $preset
  grep -q cereal_blue $preset/detections.json || fail "$preset did not recognise the cereal box"
done
run_threaded changes --sequence data/test/000001 --out changes
run_threaded evaluate --models models.resight --dataset data --presets default -k 1 --out results
run_threaded track --sequence data/test/000001 --models models.resight --out poses.txt

((failures == 0)) && echo "threads: all as expected"
exit $((failures > 0))
