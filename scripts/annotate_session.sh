#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Annotates a generated sequence of 20 views, 8 objects and 5 changes by a scripted session, from nothing and from the
# output of the recogniser, and compares the result with the exact truth. Prints clicks, time and errors
# (docs/annotate.md). Usage: annotate_session.sh PATH_OF_RESIGHT FOLDER
set -euo pipefail
resight=$(realpath "$1")
root=$(realpath "$(dirname "${BASH_SOURCE[0]}")/..")
mkdir -p "$2"
cd "$2"
[ -d data ] || "$resight" simulate "$root/tests/annotate_session.toml" --out data --format bop --seed 1
[ -f models.resight ] || "$resight" train data/models --out models.resight
[ -d results ] || "$resight" recognize --models models.resight --sequence data/test/000001 --out results
for start in nothing detections; do
  rm -rf "project_$start"
  node "$root/scripts/annotate_session.mjs" "$resight" models.resight data/test/000001 "project_$start" \
    "$([ "$start" = detections ] && echo results/detections.json || true)"
done
