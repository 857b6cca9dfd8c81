#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# `resight annotate`: makes small data in which one object moves and one is removed, annotates them in a browser
# (web/e2e/annotate_test.ts), and lets `resight evaluate` read the export. Needs `npm ci` in web/.
# Usage: annotate_test.sh PATH_OF_RESIGHT PICTURES
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
sequence=$work/data/test/000001

cd "$web" && node build.mjs --tests || { fail "npm ci is missing in web/"; exit 1; }
RESIGHT=$resight MODELS=$work/models.resight SEQUENCE=$sequence PROJECT=$work/project \
  PICTURES=$pictures timeout 300 node --test build/e2e/annotate_test.mjs || fail "the browser test failed"

# The proposed regions are kept until a file of the sequence changes.
cd "$work" || exit 1
restart() {
  rm -f start.txt
  # Without --foreground, timeout sends the signal twice, and the second one interrupts the export.
  timeout --foreground 60 "$resight" annotate --models models.resight --sequence "$sequence" --out project --no-open \
    >start.txt &
  local pid=$!
  for _ in $(seq 300); do [ -s start.txt ] && break; sleep 0.1; done
  kill -INT $pid
  wait $pid || fail "annotate did not start again"
}
touch -d '2 days ago' project/proposals.json
restart
[ -n "$(find project/proposals.json -mtime +1)" ] || fail "the regions were found again without a reason"
touch "$(ls "$sequence"/rgb/* | sed -n 2p)"
restart
[ -z "$(find project/proposals.json -mtime +1)" ] || fail "a changed image did not lead to other regions"

export=project/export/bop/000001
for file in scene_gt.json scene_gt_info.json events.json mask/000000_000000.png mask_visib/000000_000000.png; do
  [ -s "$export/$file" ] || fail "the export lacks $file"
done
[ -s project/export/tuw/000001.changes ] || fail "the export lacks the chains of TUW"
run evaluate --models models.resight --dataset "$export" --out scores --presets mvr -k 1
node -e '
  const { configurations } = JSON.parse(require("fs").readFileSync("scores/results.json"));
  const { true_positives, recall } = configurations[0].score_1cm_10deg;
  process.exit(true_positives >= 5 && recall > 0.8 ? 0 : 1)' || fail "the evaluation did not read the annotated truth"
exit $failures
