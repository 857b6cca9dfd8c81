#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# `resight view` in a browser: makes small data in which one object moves and one is removed, recognises them, and runs
# web/e2e/view_test.ts. Needs `npm ci` in web/. Usage: viewer_test.sh PATH_OF_RESIGHT PICTURES
set -uo pipefail
resight=$(realpath "$1")
mkdir -p "$2"
pictures=$(realpath "$2")
source "$(dirname "${BASH_SOURCE[0]}")/small_scene.sh"
web=$(realpath "$(dirname "${BASH_SOURCE[0]}")/../web")
cd "$work" || exit 1

{
  write_scene 5 -110 -70 true
  cat <<'CHANGES'
[[change]]
view = 2
kind = "move"
object = "cereal_blue"
on = "table"
x_m = -0.05
y_m = 0.12
yaw_deg = 10
[[change]]
view = 3
kind = "remove"
object = "tea_box"
CHANGES
} >scene.toml
run() { "$resight" "$@" >log 2>&1 || { fail "$1 failed: $(tail -1 log)"; exit 1; }; }
run simulate scene.toml --out data --format bop --seed 1
run train data/models --out models.resight
run recognize --models models.resight --sequence data/test/000001 --out default
run recognize --models models.resight --sequence data/test/000001 --out mvr --preset mvr
run changes --sequence data/test/000001 --out changes

cd "$web" && node build.mjs --tests || { fail "npm ci is missing in web/"; exit 1; }
RESIGHT=$resight RESULTS=$work/default OTHER=$work/mvr MODELS=$work/models.resight SEQUENCE=$work/data/test/000001 \
  CHANGES=$work/changes LIVE=$work/live PICTURES=$pictures timeout 300 node --test build/e2e/view_test.mjs ||
  fail "the browser test failed"
exit $failures
