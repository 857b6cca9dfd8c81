#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Measured tables of pages. The line before such a table holds its name, the commit, and a checksum of the table, so that
# an edit by hand shows.
#   scripts/page_tables.sh put PAGE NAME COMMIT <TABLE  writes the table, and the lines below it, in place of the one of
#                                                       this name; at first, in place of the unmarked table whose first
#                                                       three columns have the same titles
#   scripts/page_tables.sh check PAGE...                fails if a marked table was edited, if a page has marked tables
#                                                       and others, or if commits differ
set -euo pipefail
usage() {
  sed -n '5,9s/^# \{0,1\}//p' "$0" >&2
  exit 2
}

# checksum NAME COMMIT <BLOCK
checksum() { { echo "$1 $2"; cat; } | sha256sum | cut -c1-16; }

put_table() { # put_table PAGE NAME COMMIT <BLOCK
  local page=$1 block
  block=$(mktemp)
  cat >"$block"
  if ! awk -v name="$2" -v commit="$3" -v sum="$(checksum "$2" "$3" <"$block")" -v block="$block" '
    function first_columns(row, cells) { split(row, cells, / *[|] */); return cells[2] "|" cells[3] "|" cells[4] }
    function write_block() {
      print "<!-- table: " name ", commit " commit ", checksum " sum " -->"
      while ((getline line <block) > 0) print line
      close(block)
      print "<!-- end -->"
      ++num_put
    }
    BEGIN { getline head <block; close(block) }
    FNR == NR { is_marked = is_marked || index($0, "<!-- table: " name ", ") == 1; next }
    index($0, "<!-- table: ") == 1 { in_marked = 1 }
    index($0, "<!-- table: " name ", ") == 1 { write_block(); skip = 1 }
    in_marked { if (!skip) print; if ($0 == "<!-- end -->") in_marked = skip = 0; next }
    skip && /^[|]/ { next }
    { skip = 0 }
    /^[|]/ && !was_table && !is_marked && first_columns($0) == first_columns(head) {
      write_block()
      skip = was_table = 1
      next
    }
    { was_table = /^[|]/; print }
    END { exit num_put != 1 }' "$page" "$page" >"$page.partial"; then
    echo "$page: has no place, or several, for the table '$2'" >&2
    rm -f "$block" "$page.partial"
    return 1
  fi
  rm "$block"
  cat "$page.partial" >"$page"
  rm "$page.partial"
}

# list_tables PAGE: a line "NAME COMMIT CHECKSUM FIRST LAST" per marked table, with the numbers of the lines of its
# block, and "unmarked LINE" per other table.
list_tables() {
  awk '
    /^<!-- table: / {
      print_open()
      open = NR
      name = $3; commit = $5; sum = $7
      sub(/,$/, "", name); sub(/,$/, "", commit)
    }
    /^<!-- end -->$/ { print open ? name " " commit " " sum " " open + 1 " " NR - 1 : "end " NR; open = 0 }
    /^[|]/ && !was_table && !open { print "unmarked " NR }
    { was_table = /^[|]/ }
    function print_open() { if (open) print "open " open }
    END { print_open() }' "$1"
}

check_pages() {
  local page name commit sum first last known_commit="" first_page="" failures=0 checked=0 num_marked
  wrong() { echo "$1" >&2; failures=$((failures + 1)); }
  for page in "$@"; do
    num_marked=$(list_tables "$page" | awk 'NF == 5' | wc -l)
    while read -r name commit sum first last; do
      if [[ -z $last ]]; then
        [[ $name == unmarked && $num_marked == 0 ]] ||
          wrong "$page:$commit: $name: a marked table begins and ends, and a page has either marked tables or others"
        continue
      fi
      checked=$((checked + 1))
      [[ $(sed -n "${first},${last}p" "$page" | checksum "$name" "$commit") == "$sum" ]] ||
        wrong "$page: table '$name' was edited by hand; run scripts/results.sh instead"
      [[ -n $known_commit ]] || { known_commit=$commit; first_page=$page; }
      [[ $commit == "$known_commit" ]] ||
        wrong "$page: table '$name' is of commit $commit, but one of $first_page is of $known_commit"
    done < <(list_tables "$page")
  done
  ((failures == 0)) && echo "$checked marked tables, all as measured${known_commit:+ at commit $known_commit}"
  return $((failures > 0))
}

case "${1:-}" in
  put) (($# == 4)) || usage; put_table "$2" "$3" "$4" ;;
  check) (($# > 1)) || usage; shift; check_pages "$@" ;;
  *) usage ;;
esac
