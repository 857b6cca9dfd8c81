# SPDX-License-Identifier: Apache-2.0
# Prints columns of a Markdown table as lines of cells, separated by tabs. The table is the first one below the heading
# `title` ("## title"; the whole file if it is empty) that has all `columns`, separated by semicolons. Fails if there is
# none. A column that a table has twice is counted: "name#2" is the second.
#   awk -v title=... -v columns="preset;K;F" -f scripts/table_columns.awk tables.md
function split_row(row, cells,    n, i) {
  sub(/^[|] */, "", row)
  sub(/ *[|] *$/, "", row)
  n = split(row, cells, / *[|] */)
  return n
}
function read_head(    cells, n, i, key) {
  delete column_of
  delete count
  n = split_row($0, cells)
  for (i = 1; i <= n; ++i) {
    key = cells[i]
    if (++count[key] > 1) key = key "#" count[key]
    column_of[key] = i
  }
  for (i = 1; i <= num_wanted; ++i)
    if (!(wanted[i] in column_of)) return 0
  return 1
}
BEGIN {
  num_wanted = split(columns, wanted, ";")
  is_below = title == ""
}
/^#/ && title != "" { is_below = substr($0, index($0, " ") + 1) == title }
!/^[|]/ { in_table = 0; next }
!is_below || is_found && !is_wanted { next }
!in_table { in_table = 1; row = 0; is_wanted = !is_found && read_head(); is_found = is_found || is_wanted; next }
is_wanted && ++row > 1 {
  split_row($0, cells)
  line = cells[column_of[wanted[1]]]
  for (i = 2; i <= num_wanted; ++i) line = line "\t" cells[column_of[wanted[i]]]
  print line
}
END {
  if (!is_found) {
    print FILENAME ": no table below '" title "' has the columns " columns >"/dev/stderr"
    exit 1
  }
}
