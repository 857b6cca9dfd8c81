#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Measures the presets on real and path-traced recordings, and writes the tables into OUT/real.md. Each part is kept in
# OUT/<commit>/, so that an interrupted run continues where it stopped. Absent sets are left out.
#   scripts/real_results.sh [DATA_DIR=../shared/data] [OUT=out/real] [BUILD_DIR=build/real]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
(($# <= 3)) || { sed -n '3,5s/^# \{0,1\}//p' "$0" >&2; exit 2; }
data=${1:-../shared/data}
out=${2:-out/real}
build=${3:-build/real}
presets=(mvr mvr-chd default)
change_presets=(mvr-chd default)  # mvr finds no changes
previous_views=5
still_sets=(hots-table hots-more/table_8 hots-more/office_5)
static_sets=(seven-scenes-kitchen tum-fr1-xyz apc-bin/scene-0000)
tracking_sets=(seven-scenes-kitchen tum-fr1-xyz apc-bin/scene-0000)
# Sequence, models and the values of K.
recognition_sets=(
  "table-camera/test/000001 table-camera/models 0 5"
  "table-camera/test/000002 table-camera/models 0 5"
  "table-two-states ycb-meshes 5"
  "table-rendered/test/000001 table-rendered/models 5"
)

source scripts/common.sh
build_bench "$build" resight_app bench_real_changes bench_losses
resight=$build/apps/resight/resight

# Uncommitted changes have a name of their own.
commit=$(git describe --always --dirty --abbrev=12)
[[ $commit == *-dirty ]] && commit+=-$(git diff HEAD | sha1sum | cut -c1-8)
parts=$out/$commit
mkdir -p "$parts"
sets=()
absent=()
failed=()

contains() { [[ " ${*:2} " == *" $1 "* ]]; }
has_set() {
  if [[ -e $data/$1 ]]; then
    contains "$1" "${sets[@]}" || sets+=("$1")
    return 0
  fi
  contains "$1" "${absent[@]}" || { echo "left out: $data/$1 is absent"; absent+=("$1"); }
  return 1
}
# part NAME COMMAND...: keeps the output of the command in NAME.txt.
part() {
  local name=$1
  shift
  [[ -e $parts/$name.txt ]] && return
  step "$name" keep_output "$parts/$name.txt" "$@" || failed+=("$name")
}
file_name() { echo "${1//\//-}"; }

measure_changes() {
  local set preset
  for set in "${still_sets[@]}"; do
    has_set "$set" || continue
    for preset in "${change_presets[@]}"; do
      part "changes-$(file_name "$set")-$preset" "$build/bench/bench_real_changes" still "$data/$set" \
        "$data/$set/class_png" "$preset" - $previous_views --pictures "$parts/pictures/$(file_name "$set")-$preset"
    done
  done
  for set in "${static_sets[@]}"; do
    has_set "$set" || continue
    for preset in "${change_presets[@]}"; do
      part "static-$(file_name "$set")-$preset" "$build/bench/bench_real_changes" static "$data/$set" "$preset" - \
        $previous_views
    done
  done
}

measure_recognition() {
  local sequence models values library preset k
  for set in "${recognition_sets[@]}"; do
    read -r sequence models values <<<"$set"
    has_set "$sequence" || continue
    has_set "$models" || continue
    library=$parts/$(file_name "$models").resight
    [[ -e $library ]] || step "train $models" "$resight" train "$data/$models" --out "$library" ||
      { failed+=("$models"); continue; }
    for preset in "${presets[@]}"; do
      for k in $values; do
        part "losses-$(file_name "$sequence")-$preset-$k" "$build/bench/bench_losses" "$data/$sequence" "$library" \
          "$preset" - "$k"
      done
    done
  done
}

measure_tracking() {
  local set
  for set in "${tracking_sets[@]}"; do
    has_set "$set" || continue
    part "track-$(file_name "$set")" "$resight" track --sequence "$data/$set" \
      --out "$parts/track-$(file_name "$set").poses"
  done
}

# A row per set and method, then the sums over the sets. Reads the lines "counts" of bench_real_changes.
write_still_rows() {
  local set preset file
  for set in "${still_sets[@]}"; do
    for preset in "${change_presets[@]}"; do
      file=$parts/changes-$(file_name "$set")-$preset.txt
      [[ ! -e $file ]] || sed -n "s#^counts #$set #p" "$file"
    done
  done | awk '
    function cell(num, total, i) {
      if (i < 4) return total > 0 ? sprintf(" %.3f |", num / total) : " - |"
      return sprintf(" %d of %d |", num, total)
    }
    ($1, $2) in seen { next }  # The plain method is in the part of each preset.
    {
      seen[$1, $2] = 1
      if (!($2 in known)) { known[$2] = 1; methods[++num_methods] = $2 }
      printf "| `%s` | %s |", $1, $2
      for (i = 0; i < (NF - 2) / 2; ++i) {
        printf "%s", cell($(2 * i + 3), $(2 * i + 4), i)
        num[$2, i] += $(2 * i + 3)
        total[$2, i] += $(2 * i + 4)
      }
      num_cells = i
      print ""
    }
    END {
      for (m = 1; m <= num_methods; ++m) {
        printf "| all | %s |", methods[m]
        for (i = 0; i < num_cells; ++i) printf "%s", cell(num[methods[m], i], total[methods[m], i], i)
        print ""
      }
    }'
}

# write_static_rows TITLE: the rows of the table with this title, of all presets.
write_static_rows() {
  local set preset file first_row=1
  for set in "${static_sets[@]}"; do
    for preset in "${change_presets[@]}"; do
      file=$parts/static-$(file_name "$set")-$preset.txt
      [[ -e $file ]] || continue
      sed -n "/^| $1 |/,/^\$/p" "$file" | sed '/^$/d' | tail -n "+$first_row" |
        awk -v set="$set" '/^[|]---/ { print "|---" $0; next } { print "| " (/^[|] called/ ? "set" : set) " " $0 }'
      first_row=3  # Once with the head of the table.
    done
  done
}

write_recognition_rows() {
  local set sequence models values preset k file
  for set in "${recognition_sets[@]}"; do
    read -r sequence models values <<<"$set"
    for preset in "${presets[@]}"; do
      for k in $values; do
        file=$parts/losses-$(file_name "$sequence")-$preset-$k.txt
        [[ -e $file ]] || continue
        awk -v set="$sequence" -v preset="$preset" -v k="$k" '
          /^median centre error/ { centre = $4 " " $5 }
          /^P / { printf "| `%s` | %s | %s | %s | %s | %s | %s | %s | %s | %s |\n",
                  set, preset, k, $2, $4, $6, $8, $10, $12, centre }' "$file"
      done
    done
  done
}

write_tracking_rows() {
  local set file
  for set in "${tracking_sets[@]}"; do
    file=$parts/track-$(file_name "$set").txt
    [[ -e $file ]] || continue
    awk -v set="$set" '
      / views joined,/ { joined = $1 " of " $3 }
      /^compared with given poses/ { error = $6 " mm | " $9 " mm | " $12 " deg" }
      END { printf "| `%s` | %s | %s |\n", set, joined, error == "" ? " | | " : error }' "$file"
  done
}

write_report() {
  cat <<END
# Real recordings

Commit $commit, K = $previous_views unless stated. Sets: ${sets[*]}.
END
  ((${#absent[@]} == 0)) || echo "Absent: ${absent[*]}."
  ((${#failed[@]} == 0)) || echo "Failed: ${failed[*]}."
  cat <<END

## Changes before a still camera

By pixel, by object and by region against class masks (\`bench_real_changes still\`). \`plain\`: depth difference of
12 mm between neighbouring views. Thin: 5 to 20 mm high. "False pixels on the same class": false pixels where an object
of the same class was before, moved across itself or exchanged. Pictures of all misses and false reports are in
\`$parts/pictures\`.

| set | method | added P | added R | removed P | removed R | thin added, found | tall added | thin removed | tall removed | unchanged called changed | false pixels on the same class | added regions right | found | removed regions right | found |
|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|
END
  write_still_rows
  cat <<END

## Changes in a static room

The camera moves, so that all reported changes are false (\`bench_real_changes static\`). Shares of pixels with depth.

END
  write_static_rows "called changed"
  echo
  write_static_rows "called changed, by range"
  cat <<END

## Recognition

| sequence | preset | K | precision | recall | F | right | wrong | missed | centre median |
|---|---|---|---|---|---|---|---|---|---|
END
  write_recognition_rows
  cat <<END

## Camera poses from the views alone

| set | views joined | ATE rms | ATE largest | rotation mean |
|---|---|---|---|---|
END
  write_tracking_rows
}

measure_changes
measure_recognition
measure_tracking
write_report >"$out/real.md.partial"
mv "$out/real.md.partial" "$out/real.md"
cat "$out/real.md"
((${#failed[@]} == 0)) || { echo "failed: ${failed[*]}" >&2; exit 1; }
