#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# scripts/results.sh on a tiny data set, into copies of the project's pages: shards and merging, all or nothing, and
# tables that are not edited by hand. Tables of real recordings and of programs in bench/ are given.
# Usage: results_test.sh PATH_OF_RESIGHT
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source tests/small_scene.sh
resight=$1
check_pages() { scripts/page_tables.sh check "$@" >"$work/check.log" 2>&1; }

check_pages README.md docs/results.md || fail "the project's pages: $(cat "$work/check.log")"

pages=$work/pages
commit=$(git rev-parse --short=12 HEAD 2>/dev/null || echo unknown)
parts=$work/out/$commit-version-3 data=$work/out/$commit-version-3
mkdir -p "$pages/docs" "$parts" "$work/build/apps/resight" "$work/build/bench"
cp README.md "$pages/"
cp docs/results.md "$pages/docs/"
{
  write_scene 3 -110 -70 false
  remove_tea 1
} >"$work/scene.toml"
# The programs: resight, but for the benchmark, which is this small scene, and stand-ins for those of bench/.
cat >"$work/build/apps/resight/resight" <<PROGRAM
#!/usr/bin/env bash
resight=$(realpath "$resight")
echo "\$*" >>"$work/calls.txt"
case "\$*" in
  "simulate --preset dynamic-tabletop --seed "*)
    "\$resight" simulate "$work/scene.toml" --seed \$5 --format bop --out "\$9" >&2 && mkdir "\$9/library" &&
      cp -r "\$9/models" "\$9/library" && echo "dynamic-tabletop version 3, seed \$5: tiny" ;;
  "train "*"/library/models "*"/library/recorded --out "*) [[ -d \$3 ]] && "\$resight" train "\$2" --out "\$5" ;;
  "demo --seed 2 "*) printf 'mvr 0.5 0.5 0.500 1\nmvr-chd 0.6 0.5 0.545 0\ndefault 0.9 0.9 0.900 0\n' ;;
  "evaluate "*) exec "\$resight" "\$@" ;;
  *) exit 1 ;;
esac
PROGRAM
cat >"$work/build/bench/bench_model_objects" <<'PROGRAM'
#!/usr/bin/env bash
[[ "$1" == --tabletop && "${*: -2:1}" == --out ]] && mkdir "${*: -1}"
PROGRAM
cat >"$work/build/bench/bench_robustness" <<'PROGRAM'
#!/usr/bin/env bash
[[ -d $1 && -e $2 && $4 == 5 ]] && cat <<'TABLE'
| trouble | preset | precision | recall | F | ghosts | fewest objects per view | event precision | event recall |
|---|---|---|---|---|---|---|---|---|
| none | `mvr` | 0.8 | 0.5 | 0.6 | 24 | 1 | - | - |
| none | `mvr-chd` | 0.9 | 0.6 | 0.7 | 3 | 1 | 0.5 | 0.4 |
| none | `default` | nan | 0.9 | 0.8 | 0 | 1 | 0.7 | 0.6 |
TABLE
PROGRAM
chmod +x "$work"/build/bench/* "$work/build/apps/resight/resight"
cat >"$work/real.md" <<'TABLES'
## Changes before a still camera

| set | method | added P | added R | removed P | removed R | thin added, found | tall added | thin removed | tall removed | unchanged called changed | false pixels on the same class | added regions right | found | removed regions right | found |
|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|
| `desk` | default | 0.907 | 0.946 | 0.934 | 0.941 | 13 of 24 | 134 of 134 | 19 of 28 | 129 of 129 | 0 of 18 | 1 of 3 | 158 of 211 | 144 of 158 | 193 of 225 | 142 of 158 |

## Changes in a static room

| set | called changed | mean per view | largest | views with more than 1 % |
|---|---|---|---|---|
| kitchen | default, novel | 0.07 % | 0.45 % | 0 of 49 |
| kitchen | default, removed | 0.08 % | 0.62 % | 1 of 49 |

## Recognition

| sequence | preset | K | precision | recall | F | right | wrong | missed | centre median |
|---|---|---|---|---|---|---|---|---|---|
| `camera` | mvr | 5 | 0.867 | 0.444 | 0.588 | 52 | 8 | 65 | 3.7 mm |
| `camera` | mvr-chd | 5 | 0.952 | 0.504 | 0.659 | 59 | 3 | 58 | 3.3 mm |
| `camera` | default | 0 | 0.972 | 0.590 | 0.734 | 69 | 2 | 48 | 2.1 mm |
| `camera` | default | 5 | 1.000 | 0.718 | 0.836 | 84 | 0 | 33 | 3.9 mm |
TABLES

results() { # results ARGUMENT...
  scripts/results.sh --no-build --build "$work/build" --out "$work/out" --data "$work/none" --pages "$pages" "$@" \
    >"$work/results.log" 2>&1
}
same_as_project() { cmp -s README.md "$pages/README.md" && cmp -s docs/results.md "$pages/docs/results.md"; }

results --shard 3/2
[[ $? == 2 ]] || fail "a third of two shards was accepted: $(cat "$work/results.log")"
results --shard 1/2 || fail "shard 1/2 failed: $(cat "$work/results.log")"
grep -q 'not finished.*clustering.md.*real.md' "$work/results.log" || fail "shard 1/2 did not name what is missing"
OMP_NUM_THREADS=77 results --shard 1/2 || fail "shard 1/2 failed again: $(cat "$work/results.log")"
OMP_NUM_THREADS=77 results --merge && fail "merging without all parts succeeded"
grep -q '77 cores' "$parts/machines.txt" && fail "a machine that computed nothing is named"
same_as_project || fail "pages were written before all parts were there"
before=$(stat -c %Y.%i "$data"/results/runs/*)
cp "$work/real.md" "$parts/real.md"
results --shard 2/2 || fail "shard 2/2 failed: $(cat "$work/results.log")"
results --merge || fail "merging failed: $(cat "$work/results.log")"
after=$(stat -c %Y.%i "$data"/results/runs/*)
[[ $(comm -12 <(sort <<<"$before") <(sort <<<"$after")) == $(sort <<<"$before") ]] || fail "finished runs were computed again"

written=("$pages/README.md" "$pages/docs/results.md")
check_pages "${written[@]}" || fail "the written pages: $(cat "$work/check.log")"
grep -q "^13 marked tables, .* $commit" "$work/check.log" || fail "expected 13 tables: $(cat "$work/check.log")"
cores=$(nproc)
for line in '^[|] 7 [|] 0.73, 0.65, 0.68 [|] [0-9.]*, [0-9.]*, [0-9.]* [|] [0-9]* [|] [0-9]* [|] 0.84, 0.68, 0.75 [|] [01]\.' \
  '^Change detection removes [0-9]* % .*published rule [0-9]* % (paper: 70 %)' \
  "^Commit $commit; dynamic-tabletop version 3, seed 2; .*, $cores cores" \
  '^[|] precision [|] [-+][0-9.]* ± - [|]' \
  '^[|] `default` [|] 0 [|] [01]\.[0-9]* [|]' \
  '^[|] `mvr-chd` without clustering [|] .* [|] [1-9][0-9]* [|] [|] [0-9.]* ms [|]$' \
  '^[|] `mvr` [|] [0-9.]* ms [|] [0-9.]* ms [|] [|] [|]$' \
  '^[|] `mvr-chd` [|] [0-9.]* ms [|] [0-9.]* ms [|] [0-9.]* ms [|] [0-9.]* % [|]$' \
  '^[|] instances [|] [0-9]' '^[|] K = 5 [|] [0-9.]* [|]' \
  '^[|] none [|] 0.8, 0.5, 0.6 (24) [|] 0.9, 0.6, 0.7 (3) [|] -, 0.9, 0.8 (0) [|] 0.7, 0.6 [|]$' \
  '^[|] `desk` [|] `default` [|] 0.907, 0.946 [|] 0.934, 0.941 [|] 351 of 436 [|] 286 of 316 [|] 32 of 52 [|] 263 of 263' \
  '^[|] `kitchen` [|] `default` [|] 0.07 % [|] 0.08 % [|] 0 of 49; 1 of 49 [|] 0.45 %, 0.62 %' \
  '^[|] `camera` [|] 0.867, 0.444, 0.588 [|] 0.952, 0.504, 0.659 [|] 1.000, 0.718, 0.836 [|]'; do
  grep -q -- "$line" "${written[1]}" || fail "docs/results.md has no line $line"
done
grep -q "^| \`mvr\`, the paper's baseline | 0.5 | 0.5 | 0.500 | 1 |" "${written[0]}" || fail "README.md lacks the demo"
cp -r "$pages" "$work/first"
grep -v '^evaluate' "$work/calls.txt" >"$work/first_calls.txt"
results || fail "a second call failed: $(cat "$work/results.log")"
diff -r "$pages" "$work/first" >&2 || fail "a second call wrote other pages"
grep -v '^evaluate' "$work/calls.txt" | cmp -s - "$work/first_calls.txt" || fail "a second call made the data again"
results --version 2 && fail "version 3 was taken for version 2"
grep -q '^simulate --preset dynamic-tabletop-2 --seed 2' "$work/calls.txt" || fail "version 2 was not simulated"

# Each edit must be noticed.
expect_refused() { # expect_refused WHAT SED_EXPRESSION
  sed "$2" "${written[1]}" >"$work/edited.md"
  cmp -s "${written[1]}" "$work/edited.md" && fail "the edit changed nothing: $1"
  check_pages "${written[0]}" "$work/edited.md" && fail "the check accepts: $1"
}
expect_refused "another number" 's/^| 7 | 0.73/| 7 | 0.72/'
expect_refused "another machine" '/^Commit /s/ cores\.$/ cores or so./'
expect_refused "a row less" '/^| 7 | 0.73/d'
expect_refused "another commit in the marker" '0,/, commit [^,]*,/s//, commit 000000000000,/'
expect_refused "another name" 's/table: paper,/table: papers,/'
expect_refused "a table without its marker" '/^<!-- table: paper,/d'
expect_refused "a marker without its end" '0,/^<!-- end -->$/{//d}'
expect_refused "a table beside the marked ones" '$s/$/\n\n| a | b |\n|---|---|/'
cp "${written[1]}" "$work/edited.md"
printf '| K | `mvr`, paper | `mvr`, ours |\n|---|---|---|\n| 0 | 1 | 1 |\n' |
  scripts/page_tables.sh put "$work/edited.md" paper 000000000000 || fail "a table was not replaced"
check_pages "$work/edited.md" && fail "the check accepts tables of two commits"
grep -q "of commit 000000000000" "$work/check.log" || fail "the other commit is not named: $(cat "$work/check.log")"
scripts/page_tables.sh put "$work/edited.md" other "$commit" <<<'| a | b | c |' 2>/dev/null && fail "a table has no place, and was put"

((failures == 0)) && echo "results: all as expected"
exit $((failures > 0))
