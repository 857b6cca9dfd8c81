#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A view of 4000 x 3000 px shows what a view of 320 x 240 px shows, and the memory for it is bounded.
# Usage: large_views_test.sh PATH_OF_RESIGHT
set -uo pipefail
resight=$(realpath "$1")
source "$(dirname "${BASH_SOURCE[0]}")/small_scene.sh"
cd "$work" || exit 1

# The view itself (colours, depth, and the compressed files) takes 110 MB, and its reduced copies of up to 2 megapixels
# several times that: 650 MB in all. At full size, the work takes 4.4 GB and finds one of the two objects.
max_mb=1300

write_scene 1 -90 -90 false >small.toml
sed -e 's/^width = .*/width = 4000/; s/^height = .*/height = 3000/' -e 's/^f\([xy]\) = .*/f\1 = 3281.25/' \
  -e 's/^cx = .*/cx = 1999.5/; s/^cy = .*/cy = 1499.5/' small.toml >large.toml
for size in small large; do
  run simulate $size.toml --out $size --format bop --seed 1
  [[ -e models.resight ]] || run train small/models --out models.resight
  run recognize --models models.resight --sequence $size/test/000001 --out $size/out
  grep -o '"object": "[^"]*"' $size/out/detections.json | sort >$size.objects
done
head -c 24 large/test/000001/rgb/000000.png | tail -c 8 | od -An -tx1 | grep -q '00 00 0f a0 00 00 0b b8' ||
  fail "the large view is not of 4000 x 3000 px"
[[ $(wc -l <small.objects) == 2 ]] || fail "the small view shows two objects: $(cat small.objects)"
cmp -s small.objects large.objects || fail "the large view shows other objects: $(cat large.objects)"
peak_mb=$(($(sed -nE 's/.*"peak_memory_bytes": ([0-9]+).*/\1/p' large/out/summary.json) / 1000000))
((peak_mb > 0 && peak_mb < max_mb)) || fail "the large view takes $peak_mb MB, the limit is $max_mb MB"

((failures == 0)) && echo "large views: all as expected"
exit $((failures > 0))
