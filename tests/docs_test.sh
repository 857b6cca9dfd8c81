#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The documents name what exists: tests and files of docs/paper-to-code.md, links to documents and their headings,
# options of settings files, each line of C++ of the README in examples/, and in docs/options.md the options of the
# program.
# Usage: docs_test.sh SOURCE_DIR [PROGRAM]
set -uo pipefail
cd "$1"
failures=0
checked=0
missing() {
  echo "$1"
  failures=$((failures + 1))
}

while read -r name; do  # `Suite.Case` or `Suite.*`
  suite=${name%%.*} case=${name#*.}
  [[ $case == '*' ]] && case='[A-Za-z0-9_]+'
  checked=$((checked + 1))
  grep -rqE "TEST(_F|_P)?\($suite, $case\)" src tests || missing "docs/paper-to-code.md names a test that is not there: $name"
done < <(grep -v 'named as' docs/paper-to-code.md | grep -oE '`[A-Z][A-Za-z]+\.([A-Z][A-Za-z0-9]+|\*)`' | tr -d '`' | sort -u)

while read -r path; do  # `module/file` or `module/file_test.cpp`, below src/resight
  checked=$((checked + 1))
  compgen -G "src/resight/$path" >/dev/null || compgen -G "src/resight/$path.?pp" >/dev/null || compgen -G "$path" >/dev/null ||
    missing "docs/paper-to-code.md names a file that is not there: $path"
done < <(grep -oE '`[a-z_]+/[a-z0-9_./*]+`' docs/paper-to-code.md | tr -d '`' | grep -v '^src/resight/$' | sort -u)

anchors() {  # anchors FILE: the names that links give its headings
  awk '/^```/ { code = !code; next } !code && sub(/^#+ /, "")' "$1" | tr 'A-Z ' 'a-z-' | tr -cd 'a-z0-9_\n-' |
    awk '{ print $0 (count[$0] ? "-" count[$0] : ""); ++count[$0] }'
}
for document in README.md CONTRIBUTING.md docs/*.md; do
  while read -r link; do
    checked=$((checked + 1))
    file=$(dirname "$document")/${link%%#*}
    [[ $link != '#'* ]] || file=$document
    if [[ ! -e $file ]]; then
      missing "$document links to a file that is not there: $link"
    elif [[ $link == *'#'* ]]; then
      anchors "$file" | grep -xF -- "${link#*#}" >/dev/null || missing "$document links to a heading that is not there: $link"
    fi
  done < <(awk '/^```/ { code = !code; next } !code' "$document" | tr '\n' ' ' | grep -oE '\]\([^)]+\)' | sed 's/^](//; s/)$//' | grep -v '^http')
done

# Sections of today, and former ones.
sections=$(sed -nE 's/^## `\[([a-z_]+).*/\1/p' docs/options.md | sort -u | paste -sd '|')'|attention|match|removal|cluster|sift|shot'
while read -r key; do  # options of settings files
  checked=$((checked + 1)); p=${key//./\\.}; p=${p//\*/[a-z_0-9.]*}
  grep -qE "^(\| \`$p\`|## \`\[$p\]\`)" docs/options.md || missing "a document names an option that is not there: $key"
done < <(grep -hoE "\`($sections)\\.[a-z_.*0-9]+" README.md CONTRIBUTING.md docs/*.md \
  <(awk '/^## \[[0-9]/ { exit } /^### / { removed = /Removed/ } !removed' CHANGELOG.md) |  # options of today
  tr -d '`' | grep -vE '\.(json|csv|png|ply|cpp|hpp|toml)$|^poses\.txt' | sort -u)

while read -r line; do
  [[ -z $line ]] && continue
  checked=$((checked + 1))
  grep -rqF -- "$line" examples || missing "README.md: no example holds this line: $line"
done < <(awk '/^```cpp/ { on = 1; next } /^```/ { on = 0 } on' README.md | sed 's/^ *//')

if [[ -n ${2:-} ]]; then
  "$2" options | diff -q - docs/options.md >/dev/null || missing "docs/options.md differs from what 'resight options' prints: write it anew"
fi

((checked > 40)) || missing "only $checked names were checked"
((failures == 0)) && echo "docs: all $checked names exist"
exit $((failures > 0))
