#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# `resight evaluate` from end to end, on two small, noisy sequences: shards merge to the same bytes as one run, finished
# runs are not computed again, a missing run is named, mvr-chd has fewer ghosts and a higher precision than mvr,
# `.changes` scores like events, other names of the objects do no harm, and clustering can be left out. `resight
# changes` reconstructs with and without change detection.
# Usage: evaluate_test.sh PATH_OF_RESIGHT
set -uo pipefail
resight=$1
source "$(dirname "${BASH_SOURCE[0]}")/small_scene.sh"

{
  write_scene 3 -110 -70 false
  remove_tea 1
} >"$work/scene.toml"

"$resight" simulate "$work/scene.toml" --out "$work/data" --format bop --seed 1 >/dev/null 2>&1 || fail "simulate failed"
"$resight" simulate "$work/scene.toml" --out "$work/more" --format bop --seed 2 >/dev/null 2>&1 || fail "simulate failed"
cp -r "$work/more/test/000001" "$work/data/test/000002"
cp "$work/more/test/000001.changes" "$work/data/test/000002.changes"
mv "$work/data/events.json" "$work/data/test/000001.events.json" # That of a set is for its only sequence.
mv "$work/more/events.json" "$work/data/test/000002.events.json"
"$resight" train "$work/data/models" --out "$work/models.resight" >/dev/null 2>&1 || fail "train failed"
mv "$work/data/test/000001/depth" "$work/linked_depth" && ln -s "$work/linked_depth" "$work/data/test/000001/depth"

dataset=$work/data
evaluate() { # evaluate OUT ARGUMENT...
  local out=$1
  shift
  "$resight" evaluate --models "$work/models.resight" --dataset "$dataset" --out "$work/$out" \
    --presets mvr,mvr-chd -k 0,2 "$@" >"$work/$out.log" 2>&1
}

evaluate whole --without-clustering || fail "evaluate failed: $(cat "$work/whole.log")"
for name in results.json times.json tables.md times.md worst.md precision.svg recall.svg f.svg ghosts.svg view_time.svg \
  verification_time.svg verification_times.csv; do
  [[ -s $work/whole/$name ]] || fail "evaluate wrote no $name"
done
pictures=$(grep -o 'worst/.*jpg' "$work/whole/worst.md")
[[ -n $pictures ]] || fail "worst.md shows no pictures"
for picture in $pictures; do
  [[ -s $work/whole/$picture ]] || fail "worst.md shows $picture, which is not there"
done
[[ $(find "$work/whole/runs" -name '*.json' | wc -l) == 16 ]] || fail "expected 16 runs, there are: $(ls "$work/whole/runs")"
grep -q '"true_positives": [1-9]' "$work/whole/results.json" || fail "nothing was recognised"

# A preset that is named twice counts once, and what an evaluation with other options has left goes.
cp -r "$work/whole" "$work/again"
touch "$work/again/bop.md" "$work/again/worst/other.jpg"
"$resight" evaluate --models "$work/models.resight" --dataset "$dataset" --out "$work/again" --without-clustering \
  --presets mvr,mvr-chd,mvr -k 0,2 >"$work/again.log" 2>&1 || fail "evaluate failed: $(cat "$work/again.log")"
cmp -s "$work/whole/tables.md" "$work/again/tables.md" || fail "a preset counts twice"
[[ ! -e $work/again/bop.md && ! -e $work/again/worst/other.jpg ]] || fail "results of an earlier evaluation are left"

# The point of the paper (Section III-B): with change detection, no ghost of the removed object remains, and precision
# rises. Columns of "Recognition over K": preset, K, precision, .., ghosts, ghosts per former place, ghosts by the
# published rule.
ghosts_and_precision() { # ghosts_and_precision PRESET: at K = 2, with clustering
  awk -F ' *[|] *' -v preset="\`$1\`" '$2 == preset && $3 == 2 { print $(NF - 3), $(NF - 1), $4; exit }' "$work/whole/tables.md"
}
read -r static_ghosts static_published static_precision <<<"$(ghosts_and_precision mvr)"
read -r dynamic_ghosts dynamic_published dynamic_precision <<<"$(ghosts_and_precision mvr-chd)"
[[ $static_ghosts -gt 0 && $dynamic_ghosts -eq 0 ]] ||
  fail "mvr has $static_ghosts ghosts, mvr-chd $dynamic_ghosts: expected some, and none"
[[ $static_published -ge $static_ghosts && $dynamic_published -lt $static_published ]] ||
  fail "by the published rule, mvr has $static_published ghosts and mvr-chd $dynamic_published: expected fewer"
awk "BEGIN { exit !($dynamic_precision > $static_precision) }" ||
  fail "precision of mvr-chd, $dynamic_precision, is not above that of mvr, $static_precision"

# Tables II and III: without clustering, each hypothesis is verified. At K = 0 these are the generated ones.
hypotheses=$(awk -F '[:, ]+' '
  /"num_previous_views"/ { k = $3 }
  /"is_clustered"/ { clustered = $3 }
  /"generated"/ { generated = $3 }
  /"merged"/ { merged = $3 }
  /"clustered"/ { print clustered, k, generated, merged, $3 }' "$work/whole/results.json")
[[ $(wc -l <<<"$hypotheses") == 8 ]] || fail "expected the hypotheses of 8 configurations: $hypotheses"
awk '$1 == "false" && ($5 != $4 || $5 == 0) || $1 == "true" && $5 >= $4 || $2 == 0 && $4 != $3 || $2 > 0 && $4 <= $3 {
       print "clustered, K, generated, merged, verified:", $0
       wrong = 1
     }
     END { exit wrong }' <<<"$hypotheses" || fail "clustering is not on, or not off"
# Fig. 7 has a row per view of each run.
[[ $(wc -l <"$work/whole/verification_times.csv") == 49 ]] || fail "expected the times of 16 runs of 3 views"

# Fig. 6: three views after the removal, the static reconstruction still holds the box, the dynamic one does not.
count_points() { sed -n '/^element vertex/{s/.* //p;q}' "$1"; }
for preset in mvr mvr-chd; do
  "$resight" changes --sequence "$work/data/test/000001" --preset $preset -k 2 --out "$work/changes_$preset" \
    >/dev/null 2>&1 || fail "changes --preset $preset failed"
done
last=$(basename "$(find "$work/changes_mvr" -name '*.ply' | sort | tail -n 1)")
static_points=$(count_points "$work/changes_mvr/$last")
dynamic_points=$(count_points "$work/changes_mvr-chd/$last")
[[ $static_points -gt $((dynamic_points + 200)) ]] ||
  fail "the static reconstruction has $static_points points, the dynamic one $dynamic_points: where is the removed box?"
grep -q '"regions": \[\]' "$work/changes_mvr/changes.json" && ! grep -q '"kind"' "$work/changes_mvr/changes.json" ||
  fail "mvr reports changes"
grep -q '"kind": "removed"' "$work/changes_mvr-chd/changes.json" || fail "mvr-chd reports no removal"

for shard in 1/2 2/2; do
  [[ -e $work/parts/results.json ]] && fail "results were written before all parts were there"
  evaluate parts --without-clustering --shard $shard || fail "shard $shard failed: $(cat "$work/parts.log")"
done
for name in results.json tables.md worst.md; do
  cmp -s "$work/whole/$name" "$work/parts/$name" || fail "$name of the parts is not that of the whole"
done

# Finished runs stay as they are; a lost one is named, and made again alone.
before=$(stat -c %Y.%i "$work"/whole/runs/*)
rm "$work/whole/runs/000002.mvr-chd.k2.json"
evaluate whole --without-clustering --merge
[[ $? == 2 ]] || fail "merging without all runs did not fail with status 2"
grep -q '000002.mvr-chd.k2' "$work/whole.log" || fail "the missing run was not named: $(cat "$work/whole.log")"
evaluate whole --without-clustering || fail "the lost run was not made again"
after=$(stat -c %Y.%i "$work"/whole/runs/*)
[[ $(comm -12 <(sort <<<"$before") <(sort <<<"$after") | wc -l) == 15 ]] || fail "finished runs were computed again"
cmp -s "$work/whole/results.json" "$work/parts/results.json" || fail "a second run gave other results"

# Converted to TUW, with the chains of `.changes` instead of the events, the data give the same results. Poses survive
# the conversion to 1e-12, so the last digits of pose errors differ.
for sequence in 000001 000002; do
  "$resight" convert "$work/data/test/$sequence" "$work/tuw/data/test/$sequence" --to tuw >/dev/null 2>"$work/convert.log" ||
    fail "convert failed: $(cat "$work/convert.log")"
  [[ -s $work/tuw/data/test/$sequence/$sequence.changes ]] || fail "convert lost the changes of $sequence"
  rm "$work/tuw/data/test/$sequence/events.json" || fail "convert lost the events of $sequence"
done
dataset=$work/tuw/data evaluate chains --without-clustering || fail "evaluate of TUW failed: $(cat "$work/chains.log")"
without_errors() { grep -vE '"(median|p95)"' "$work/$1/results.json"; }
cmp -s <(without_errors whole) <(without_errors chains) || fail "the chains gave other results than the events"

# A library whose names are not those of the data set finds the objects by their ids.
cp -r "$work/data" "$work/renamed" && mkdir "$work/other" && mv "$work/renamed" "$work/other/data"
sed -i 's/"name": "/&my_/' "$work/other/data/models/models_info.json"
find "$work/other/data" -name '*events.json' -exec sed -i 's/"object": "/&my_/' {} +
find "$work/other/data" -name '*.changes' -delete
dataset=$work/other/data evaluate renamed --without-clustering --bop || fail "evaluate failed: $(cat "$work/renamed.log")"
grep -q 'found by obj_id' "$work/renamed.log" || fail "other names bring no warning: $(cat "$work/renamed.log")"
cmp -s "$work/whole/results.json" "$work/renamed/results.json" || fail "objects with other names gave other results"

# Nor do events in short form, whose places come from the ground truth.
events=$work/other/data/test/000001.events.json
removal=$(tr -d ' \n' <"$events" | sed -nE 's/.*"view":([0-9]+),"kind":"removed","object":"(my_[^"]*)".*/[\1,"removed","\2"]/p')
[[ -n $removal ]] || fail "no removal is in $events"
echo "{\"events\": [$removal]}" >"$events"
dataset=$work/other/data evaluate short --without-clustering || fail "evaluate failed: $(cat "$work/short.log")"
cmp -s <(without_errors whole) <(without_errors short) || fail "events in short form gave other results"

# Results of other data are stale: of another truth, image, change or name of an object, or of another library.
expect_stale() { # expect_stale WHAT
  evaluate whole --without-clustering --merge
  [[ $? == 2 ]] && grep -q 'runs are missing' "$work/whole.log" ||
    fail "results were merged in spite of another $1: $(cat "$work/whole.log")"
}
for file in data/test/000002/scene_gt.json data/test/000001/depth/000001.png data/test/000001.events.json \
  data/models/models_info.json; do
  cp -p "$work/$file" "$work/unaltered" || fail "$file is not there to be altered"
  echo >>"$work/$file"
  expect_stale "$file"
  mv "$work/unaltered" "$work/$file"
done
mkdir "$work/models" && echo '{}' >"$work/models/models_info.json" # A reader looks there, too.
expect_stale "list of names three levels up"
rm -r "$work/models"
mv "$work/models.resight" "$work/unaltered"
cp -r "$work/data/models" "$work/other_models" && sed -i 's/tea_box/box_of_tea/' "$work/other_models/models_info.json"
"$resight" train "$work/other_models" --out "$work/models.resight" >/dev/null 2>&1 || fail "train failed"
expect_stale "library"
mv "$work/unaltered" "$work/models.resight"
# So are those of another program.
cp "$resight" "$work/other_program"
echo >>"$work/other_program"
program=$resight
resight=$work/other_program
expect_stale "program"
resight=$program
evaluate whole --without-clustering --merge || fail "unaltered data are stale: $(cat "$work/whole.log")"

evaluate whole --without-clustering --merge --bop || fail "--bop failed: $(cat "$work/whole.log")"
grep -qE '^[|] `mvr` [|] 0 [|] (0\.[1-9]|1\.0)' "$work/whole/bop.md" || fail "bop.md holds no recall: $(cat "$work/whole/bop.md")"
cmp -s "$work/whole/bop.md" "$work/renamed/bop.md" || fail "objects with other names gave another BOP recall"
# Other data sets call the folders otherwise.
mv "$work/other/data/test" "$work/other/data/test_kinect" && mv "$work/other/data/models" "$work/other/data/models_eval"
dataset=$work/other/data/test_kinect evaluate split --without-clustering --bop || fail "evaluate failed: $(cat "$work/split.log")"
cmp -s "$work/whole/bop.md" "$work/split/bop.md" || fail "other names of folders gave another BOP recall"

((failures == 0)) && echo "evaluate: all as expected"
exit $((failures > 0))
