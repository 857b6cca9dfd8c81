# SPDX-License-Identifier: Apache-2.0
# The tables of README.md and docs/results.md, from what scripts/results.sh keeps in $parts. Sourced by it. The first
# three titles of each table are those of the pages (page_tables.sh).

# columns FILE TITLE COLUMNS: cells by name (table_columns.awk).
columns() { awk -v title="$2" -v columns="$3" -f scripts/table_columns.awk "$parts/$1"; }

# Paper, Table I: K, then precision, recall, F of MVR and of MVR-CHD.
readonly paper_table_1='0 0.93, 0.50, 0.65|0.93, 0.50, 0.65
1 0.89, 0.66, 0.76|0.90, 0.66, 0.77
2 0.86, 0.67, 0.76|0.89, 0.68, 0.77
3 0.82, 0.68, 0.74|0.87, 0.68, 0.76
4 0.78, 0.67, 0.72|0.84, 0.68, 0.75
5 0.76, 0.67, 0.71|0.84, 0.67, 0.75
6 0.74, 0.65, 0.69|0.84, 0.67, 0.75
7 0.73, 0.65, 0.68|0.84, 0.68, 0.75'

# Two counts of ghosts: ours, and that of the paper's tool, which the paper's 70 % refer to.
table_paper() {
  columns paper.md "Recognition over K" "preset;K;precision;recall;F;ghosts;by the published rule" |
    awk -F '\t' -v paper="$paper_table_1" '
    function fewer(rule, k, a, b) {
      a = ghosts["mvr", k, rule]; b = ghosts["mvr-chd", k, rule]
      if (k == 0 || a == 0) return ""
      sum[rule] += 1 - b / a; ++num[rule]
      return sprintf("%.0f %%", 100 * (1 - b / a))
    }
    function mean(rule) { return num[rule] ? sprintf("%.0f %%", 100 * sum[rule] / num[rule]) : "-" }
    BEGIN {
      num_rows = split(paper, rows, "\n")
      print "| K | `mvr`, paper | `mvr`, ours | ghosts | by the published rule | `mvr-chd`, paper | `mvr-chd`, ours | " \
            "ghosts | by the published rule | fewer | fewer by the published rule |"
      print "|---|---|---|---|---|---|---|---|---|---|---|"
    }
    {
      gsub(/`/, "", $1)
      score[$1, $2] = $3 ", " $4 ", " $5
      ghosts[$1, $2, "ours"] = $6
      ghosts[$1, $2, "published"] = $7
    }
    END {
      for (i = 1; i <= num_rows; ++i) {
        k = rows[i] + 0
        split(substr(rows[i], 3), of, "|")
        printf "| %d | %s | %s | %d | %d | %s | %s | %d | %d | %s | %s |\n", k, of[1], score["mvr", k],
               ghosts["mvr", k, "ours"], ghosts["mvr", k, "published"], of[2], score["mvr-chd", k],
               ghosts["mvr-chd", k, "ours"], ghosts["mvr-chd", k, "published"], fewer("ours", k), fewer("published", k)
      }
      printf "\nChange detection removes %s of the ghosts on average over K = 1 to 7, by the published rule %s " \
             "(paper: 70 %%).\n", mean("ours"), mean("published")
    }'
}

table_differences() {
  columns paper.md "Differences between presets" "presets;K;precision;recall;F;ghosts per former place" |
    awk -F '\t' '
    BEGIN {
      print "| `mvr-chd` - `mvr`, mean of the sequences ± standard error | K = 1 | K = 3 | K = 5 | K = 7 |"
      print "|---|---|---|---|---|"
      split("precision,recall,F,ghosts per place left", names, ",")
    }
    $1 == "`mvr-chd` - `mvr`" { for (i = 1; i <= 4; ++i) cell[i, $2] = $(i + 2) }
    END {
      for (i = 1; i <= 4; ++i)
        printf "| %s | %s | %s | %s | %s |\n", names[i], cell[i, 1], cell[i, 3], cell[i, 5], cell[i, 7]
    }'
}

table_presets() {
  echo "| preset | K | precision | recall | F | strict F | centre median | rotation median | ghosts | by the published rule |"
  echo "|---|---|---|---|---|---|---|---|---|---|"
  local titles="preset;K;precision;recall;F;strict F;centre median;rotation median;ghosts;by the published rule"
  { columns default.md "Recognition over K" "$titles" | awk -F '\t' '$2 == 0'
    columns clustering.md "Recognition over K" "$titles"
  } | awk -F '\t' '!/without/ {
    for (i = 1; i <= NF; ++i) printf "| %s%s", $i, i < NF ? " " : " |\n" }'
}

table_losses() {
  awk '/^## / { is_here = $0 == "## Where missed objects were lost" } is_here && /^[|]/ && !/without/' "$parts/clustering.md"
}

table_visibility() {
  columns default.md '`default`, K = 5: objects and visibility' "visible share;instances;recall" | awk -F '\t' '
    { head = head " | " $1; rule = rule "---|"; instances = instances " | " $2; recall = recall " | " $3 }
    END {
      print "| visible share of the object" head " |\n|---|" rule
      print "| instances" instances " |\n| recall of `default`, K = 5" recall " |"
    }'
}

table_changes() {
  echo "| changes at K = 5: precision / recall | removed points | novel points | events | departures | arrivals | mean delay |"
  echo "|---|---|---|---|---|---|---|"
  columns clustering.md "Changes" "preset;removed precision;removed recall;novel precision;novel recall;event precision;\
event recall;departure precision;departure recall;arrival precision;arrival recall;mean delay (views)" |
    awk -F '\t' '!/without/ {
      printf "| %s | %s / %s | %s / %s | %s / %s | %s / %s | %s / %s | %s views |\n", $1, $2, $3, $4, $5, $6, $7, $8, $9,
             $10, $11, $12 }'
}

table_scores() {
  awk '/^## / { is_here = $0 == "## Scores" }
    is_here && /^[|] preset / { sub(/preset [|] K/, "`default`") ; print; next }
    is_here && /^[|]---/ { sub(/^[|]---/, ""); print; next }
    is_here && /^[|] `default` / { sub(/`default` [|]/, "K ="); print }' "$parts/default.md"
}

table_degraded() {
  columns degraded.md "" "trouble;preset;precision;recall;F;ghosts;event precision;event recall" | awk -F '\t' '
    BEGIN { print "| degradation | `mvr` | `mvr-chd` | `default` | events of `default` |\n|---|---|---|---|---|" }
    { gsub(/nan/, "-"); row = row (NR % 3 == 1 ? "| " $1 : "") " | " $3 ", " $4 ", " $5 " (" $6 ")" }
    NR % 3 == 0 { print row " | " $7 ", " $8 " |"; row = "" }'
}

# Tables II and III, and the time per view of Section IV-B with the paper's numbers.
table_clustering() {
  { columns clustering.md "Clustering (Tables II and III)" "preset;precision without;recall without;F without;precision;\
recall;F;hypotheses without;with;kept" | sed 's/^/score\t/'
    columns clustering_times.md "Time of clustering (Table III)" \
      "preset;clustering;verification without;verification with;share saved" | sed 's/^/time\t/'
  } | awk -F '\t' '
    BEGIN {
      print "| K = 5 | precision, recall, F | hypotheses | clustering, CPU per view | verification, CPU per view |"
      print "|---|---|---|---|---|"
    }
    $1 == "score" { score[$2] = $0; next }
    {
      split(score[$2], s, FS)
      printf "| %s without clustering | %s, %s, %s | %s | | %s ms |\n", $2, s[3], s[4], s[5], s[9], $4
      printf "| %s | %s, %s, %s | %s (%s) | %s ms | %s ms (%s saved) |\n", $2, s[6], s[7], s[8], s[10], s[11], $3, $5, $6
    }
    END {
      print "| paper | 0.71, 0.68, 0.69 without; 0.72, 0.69, 0.70 with | 66 % | 216 ms | 3.6 s saved (15.7 %) |"
    }'
  # Change detection is what these stages take beyond those of `mvr`, which only reconstructs.
  printf '\n| time per view, K = 5 | wall | CPU | change detection, CPU | its share |\n|---|---|---|---|---|\n'
  columns clustering_times.md "Time per view (Section IV-B)" "preset;wall ms per view;CPU ms per view;\
changes and reconstruction, CPU ms;presence, CPU ms" | awk -F '\t' '
    /without/ { next }
    $1 == "`mvr`" { reconstruction = $4 + $5; printf "| %s | %s ms | %s ms | | |\n", $1, $2, $3; next }
    { printf "| %s | %s ms | %s ms | %.1f ms | %.1f %% |\n", $1, $2, $3, $4 + $5 - reconstruction,
             100 * ($4 + $5 - reconstruction) / $3 }
    END { print "| paper | `mvr` 28.6 s, `mvr-chd` 29.8 s | | 1.2 s | 4 % |" }'
}

table_real_changes() {
  columns real.md "Changes before a still camera" "set;method;added P;added R;removed P;removed R;added regions right;\
removed regions right;found;found#2;thin added, found;thin removed;tall added;tall removed" | awk -F '\t' '
    function both(a, b, x, y) { split(a, x, " of "); split(b, y, " of "); return x[1] + y[1] " of " x[2] + y[2] }
    BEGIN {
      print "| set | method | added P, R | removed P, R | regions right | things found as a region | " \
            "thin things found (5 to 20 mm) | taller ones |\n|---|---|---|---|---|---|---|---|"
    }
    $1 != "all" {
      printf "| %s | `%s` | %s, %s | %s, %s | %s | %s | %s | %s |\n", $1, $2, $3, $4, $5, $6, both($7, $8), both($9, $10),
             both($11, $12), both($13, $14) }'
}

table_static() {
  columns real.md "Changes in a static room" "set;called changed;mean per view;largest;views with more than 1 %" |
    awk -F '\t' '
    BEGIN {
      print "| set | method | novel | removed | views with more than 1 % | largest share of a view |"
      print "|---|---|---|---|---|---|"
    }
    {
      split($2, what, ", ")  # preset, then novel or removed
      key = "`" $1 "` | `" what[1] "`"
      if (!(key in mean)) keys[++num_keys] = key
      mean[key] = mean[key] " | " $3
      views[key] = views[key] (views[key] ? "; " : "") $5
      largest[key] = largest[key] (largest[key] ? ", " : "") $4
    }
    END { for (i = 1; i <= num_keys; ++i) print "| " keys[i] mean[keys[i]] " | " views[keys[i]] " | " largest[keys[i]] " |" }'
}

table_recognition() {
  columns real.md "Recognition" "sequence;preset;K;precision;recall;F" | awk -F '\t' '
    BEGIN { print "| set | `mvr` | `mvr-chd` | `default` |\n|---|---|---|---|" }
    $3 == 5 { if (!($1 in seen)) { seen[$1]; sets[++num_sets] = $1 } cell[$1, $2] = $4 ", " $5 ", " $6 }
    END {
      for (i = 1; i <= num_sets; ++i)
        printf "| %s | %s | %s | %s |\n", sets[i], cell[sets[i], "mvr"], cell[sets[i], "mvr-chd"], cell[sets[i], "default"]
    }'
}

table_demo() {
  echo "| simulated desk, 12 views, 11 objects, 5 changes | precision | recall | F | ghosts |"
  echo "|---|---|---|---|---|"
  awk 'BEGIN { what["mvr"] = ", the paper\x27s baseline"; what["mvr-chd"] = ", the paper\x27s system"; what["default"] = "" }
    $1 in what { printf "| `%s`%s | %s | %s | %s | %s |\n", $1, what[$1], $2, $3, $4, $5 }' "$parts/demo.txt"
}
