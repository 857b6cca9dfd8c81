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

write_changing_scene >scene.toml
run simulate scene.toml --out data --format bop --seed 1
run train data/models --out models.resight
run recognize --models models.resight --sequence data/test/000001 --out default --trace
run recognize --models models.resight --sequence data/test/000001 --out mvr --preset mvr
printf '[verify.acceptance]\nmin_visible_share = 0.95\n' >strict.toml # nothing is seen that well
run recognize --models models.resight --sequence data/test/000001 --out strict --config strict.toml --trace
run changes --sequence data/test/000001 --out changes

cd "$web" && node build.mjs --tests || { fail "npm ci is missing in web/"; exit 1; }
RESIGHT=$resight RESULTS=$work/default OTHER=$work/mvr STRICT=$work/strict MODELS=$work/models.resight SEQUENCE=$work/data/test/000001 \
  CHANGES=$work/changes LIVE=$work/live PICTURES=$pictures timeout 300 node --test build/e2e/view_test.mjs ||
  fail "the browser test failed"
exit $failures
