#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Leave-one-out ablation of preset `default`: switches each feature off alone, and measures what that changes on
# generated, path-traced and real recordings. Writes the tables of docs/ablation.md. What is finished is kept in
# OUT/<commit>/ and not computed again, and neither are rows that the page has for this commit. A call computes on one
# core. Shards may run at the same time, also on several machines that share OUT; the call after the last one writes the
# page. With --merge, nothing is computed, and the page gets the rows that are finished.
#   scripts/ablation.sh [--shard I/N | --merge] [--data DIR=../shared/data] [--out DIR=out/ablation]
#                       [--build DIR=build/ablation] [--no-build] [--page FILE=docs/ablation.md]
# With --no-build, the programs are those in the build folder.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
usage() {
  sed -n '8,10s/^# \{0,1\}//p' "$0" >&2
  exit 2
}
data=../shared/data out=out/ablation build=build/ablation page=docs/ablation.md
source scripts/shards.sh
read_options data out build page -- "$@"
data=$(realpath -m "$data")

# A seed, and three of its nine sequences: each kind of sequence is there at least once.
seeds=("11 1 4 7" "12 2 5 8" "13 3 6 9" "14 1 5 9" "15 2 6 7")
# A data set, its models, and the seeds of all random choices.
recorded_sets=("table-camera table-camera/models 1 2" "table-rendered table-rendered/models 1"
  "table-two-states ycb-meshes 1")
still_sets=(hots-table hots-more/table_8 hots-more/office_5)
static_sets=(seven-scenes-kitchen tum-fr1-xyz apc-bin/scene-0000)
previous_views=5

# What is switched off: settings, separated by semicolons.
switches=(
  'shape.skip_planes = false'
  'shape.max_matches = 0'
  'shape.min_feature_share = 0'
  'hypotheses.min_carried_share = 0'
  'verify.clutter.noise_sigmas = 0'
  'verify.clutter.texture_contrast = "off"'
  'verify.planes.spacing_m = "off"'
  'verify.acceptance.min_shared_texture = 0'
  'verify.acceptance.min_newest_similarity = "off"'
  'verify.acceptance.min_pattern_similarity = "off"'
  'verify.acceptance.require_unary_gain = false'
  'search.max_new_share = "off"'
  'search.place_interval = "off"'
  'poses.correct = false'
  'color_offset.correct = false'
  'depth_bias.correct = false'
  'verify.selection.score_power = 0'
  'detections.weigh_competing_poses = false'
  'verify.appearance.sigma_saturation = 0; verify.appearance.sigma_ab = 0.17'
  'verify.appearance.pattern_radius_m = "off"'
)
# Those that act on the detection of changes.
change_switches=(
  'changes.recolored_sigmas = "off"'
  'changes.min_region_px = 1'
  'changes.test = "points"'
  'poses.correct = false'
  'depth_bias.correct = false'
)

[[ $page == docs/ablation.md ]] && require_commit --page
commit=$(git rev-parse --short=12 HEAD)
source scripts/common.sh
resight=$build/apps/resight/resight
compare=$build/bench/bench_compare_results
if ((can_build)); then
  build_bench "$build" resight_app bench_compare_results bench_real_changes
fi
parts=$(realpath -m "$out/$commit")
mkdir -p "$parts"

# slug SETTINGS: a name for files.
slug() { tr -cs 'a-zA-Z0-9._\n' '-' <<<"$1"; }

# known_row NAME SETTINGS: the row of these settings in the table NAME of the page, if it is of this commit.
known_row() {
  [[ -n $2 ]] && sed -n "/^<!-- table: $1, commit $commit,/,/^<!-- end -->/p" "$page" |
    grep -F "| \`${2//; /\`, \`}\` |"
}

# make_seed SEED NUMBER...: the chosen sequences in seed-SEED/data, their library beside it.
make_seed() {
  local folder=$parts/seed-$1 number
  [[ -e $folder/models.resight ]] && return
  rm -rf "$folder"
  mkdir -p "$folder/data/test"
  step "simulate seed $1" "$resight" simulate --preset dynamic-tabletop --seed "$1" --format bop --out "$folder/all"
  for number in "${@:2}"; do mv "$folder/all/test/00000$number"* "$folder/data/test"; done
  mv "$folder/all/models" "$folder/data"
  rm -rf "$folder/all"
  step "train seed $1" "$resight" train "$folder/data/models" --out "$folder/models.partial.resight"
  mv "$folder/models.partial.resight" "$folder/models.resight"
}
make_data() {
  exec 9>"$parts/lock"
  flock 9
  local set
  for set in "${seeds[@]}"; do make_seed $set; done
  for set in "${recorded_sets[@]}"; do
    read -r _ models _ <<<"$set"
    [[ -e $parts/$(slug "$models").resight ]] ||
      step "train $models" "$resight" train "$data/$models" --out "$parts/$(slug "$models").resight"
  done
  exec 9>&-
}

# evaluate FOLDER LIBRARY DATA SEED SETTINGS: a finished folder has tables.md, or its row is in the page.
evaluate() {
  local folder=$1 done=$1/tables.md config=()
  known_row switches "$5" >/dev/null && done=$page
  take_turn "$done" "${folder#"$parts/"}" || return 0
  mkdir -p "$folder"
  if [[ -n $5 ]]; then
    tr ';' '\n' <<<"$5" >"$folder.toml"
    config=(--config "$folder.toml")
  fi
  step "${folder#"$parts/"}" "$resight" evaluate --models "$2" --dataset "$3" --presets default -k $previous_views \
    --seed "$4" --out "$folder" -j 1 "${config[@]}" || { missing+=("$folder"); failed+=("$folder"); }
}
# evaluate_all SETTINGS: on all sets. Empty: preset default as it is.
evaluate_all() {
  local name set sequences models seed
  name=$(slug "${1:-default}")
  for set in "${seeds[@]}"; do
    read -r seed _ <<<"$set"
    evaluate "$parts/seed-$seed/$name" "$parts/seed-$seed/models.resight" "$parts/seed-$seed/data" 1 "$1"
  done
  for set in "${recorded_sets[@]}"; do
    read -r sequences models _ <<<"$set"
    for seed in ${set#* * }; do
      evaluate "$parts/$(slug "$sequences")-$seed/$name" "$parts/$(slug "$models").resight" "$data/$sequences" "$seed" "$1"
    done
  done
}

# find_changes SETTINGS: bench_real_changes on all still and static sets.
find_changes() {
  local set kind file done config=-
  mkdir -p "$parts/changes"
  for set in "${still_sets[@]}" "${static_sets[@]}"; do
    kind="static $data/$set"
    [[ " ${still_sets[*]} " == *" $set "* ]] && kind="still $data/$set $data/$set/class_png"
    file=$parts/changes/$(slug "$set")-$(slug "${1:-default}").txt
    done=$file
    known_row change-switches "$1" >/dev/null && done=$page
    take_turn "$done" "${file#"$parts/"}" || continue
    if [[ -n $1 ]]; then
      config=${file%.txt}.toml
      tr ';' '\n' <<<"$1" >"$config"
    fi
    step "changes of $set, ${1:-default}" keep_output "$file" "$build/bench/bench_real_changes" $kind default "$config" \
      $previous_views || { missing+=("$file"); failed+=("$file"); }
  done
}
# compare SETTINGS FOLDER...: the row of bench_compare_results, with the feature against without it.
compare() {
  local folder arguments=()
  for folder in "${@:2}"; do arguments+=("$folder/$(slug "${1:-default}")" "$folder/default"); done
  "$compare" "${arguments[@]}" | awk -v title="" -f scripts/table_columns.awk \
    -v columns="right, A and B;wrong, A and B;F;strict F;F of events;CPU, B / A"
}
generated_folders() { for set in "${seeds[@]}"; do echo "$parts/seed-${set%% *}"; done; }
recorded_folders() {
  local set seed
  for set in "${recorded_sets[@]}"; do
    for seed in ${set#* * }; do echo "$parts/$(slug "${set%% *}")-$seed"; done
  done
}

# switch_row SETTINGS: the row of the page, or that of finished runs. Empty: the figures of `default`.
switch_row() {
  local folder generated recorded
  known_row switches "$1" && return
  for folder in $(generated_folders) $(recorded_folders); do
    [[ -e $folder/$(slug "${1:-default}")/tables.md && -e $folder/default/tables.md ]] || return 0
  done
  generated=$(compare "$1" $(generated_folders)) && recorded=$(compare "$1" $(recorded_folders)) || return 1
  printf '%s\t%s\t%s\n' "$1" "$generated" "$recorded" |
    awk -F '\t' '
      function first(pair) { return substr(pair, 1, index(pair, ",") - 1) }
      $1 == "" {
        printf "| (nothing: `default`) | %s, %s | | | | | %s, %s | |\n", first($2), first($3), first($8), first($9)
      }
      $1 != "" {
        gsub(/; /, "`, `", $1)
        printf "| `%s` | %s, %s | %s | %s | %s | %s | %s, %s | %s |\n", $1, first($2), first($3), $4, $5, $6, $7,
               first($8), first($9), $10
      }'
}
write_switches() {
  local settings
  echo "| without | right, wrong | F | strict F | F of events | CPU | recorded: right, wrong | F |"
  echo "|---|---|---|---|---|---|---|---|"
  for settings in "" "${switches[@]}"; do switch_row "$settings"; done
}

# change_row SETTINGS: sums over the still sets, then each static set.
change_row() {
  local set name file still=() static=()
  known_row change-switches "$1" && return
  name=$(slug "${1:-default}")
  for set in "${still_sets[@]}"; do still+=("$parts/changes/$(slug "$set")-$name.txt"); done
  for set in "${static_sets[@]}"; do static+=("$parts/changes/$(slug "$set")-$name.txt"); done
  for file in "${still[@]}" "${static[@]}"; do [[ -e $file ]] || return 0; done
  [[ -n $1 ]] && printf '| `%s` | ' "${1//; /\`, \`}" || printf '| (nothing: `default`) | '
  awk '
    $1 == "counts" && $2 == "default" { for (i = 3; i <= NF; ++i) sum[i] += $i }
    END {
      printf "%.3f, %.3f | %.3f, %.3f | %d of %d | %d of %d | %d of %d |", sum[3] / sum[4], sum[5] / sum[6],
             sum[7] / sum[8], sum[9] / sum[10], sum[11] + sum[15], sum[12] + sum[16], sum[23] + sum[27],
             sum[24] + sum[28], sum[25] + sum[29], sum[26] + sum[30]
    }' "${still[@]}"
  for set in "${static[@]}"; do
    awk -F ' *[|] *' '
      $2 == "default, novel" && !novel { novel = $3 }
      $2 == "default, removed" && !removed { removed = $3 }
      END { printf " %s, %s |", novel, removed }' "$set"
  done
  printf '\n'
}
write_change_switches() {
  local settings set
  printf '| without | added P, R | removed P, R | thin things found | regions right | things found as a region |'
  for set in "${static_sets[@]}"; do printf ' `%s`: novel, removed |' "$set"; done
  printf '\n|---|---|---|---|---|---|---|---|---|\n'
  for settings in "" "${change_switches[@]}"; do change_row "$settings"; done
}

# make_table NAME: a table without rows ends the script.
make_table() {
  local table=$parts/$1.md
  "write_$1" >"$table"
  [[ $(grep -c '^|' "$table") -gt 2 ]] ||
    { echo "ablation.sh: no row of '$1' is finished, so nothing is written" >&2; exit 1; }
  printf '\nCommit %s; K = %d.\n' "$commit" "$previous_views" >>"$table"
}

((merge)) || make_data
for settings in "" "${change_switches[@]}"; do find_changes "$settings"; done
for settings in "" "${switches[@]}"; do evaluate_all "$settings"; done
((merge)) || exit_unless_finished
# The page changes only if both tables are there.
for name in switches change_switches; do make_table $name; done
for name in switches change_switches; do
  scripts/page_tables.sh put "$page" "${name//_/-}" "$commit" <"$parts/$name.md"
done
