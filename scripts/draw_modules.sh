#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Draws docs/images/modules.svg from the declared dependencies of the modules, without those that others imply.
# Needs Debian's package graphviz.
#   draw_modules.sh
#   draw_modules.sh --check [BUILD]   only compares the edges with those of the picture. BUILD: a folder that CMake has
#                                     configured; without it, the script configures one
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
picture=docs/images/modules.svg
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
[[ ${1:-} == --check ]] && picture=$scratch/modules.svg
build=${2:-$scratch}
[[ $build != "$scratch" ]] || cmake -S . -B "$build" -G Ninja -DRESIGHT_BUILD_TESTS=OFF >/dev/null
{
  echo 'digraph modules { rankdir=TB; bgcolor=white; ranksep=0.35; nodesep=0.25'
  echo 'node [shape=box style="rounded,filled" fillcolor="#eef3fa" color="#4a6fa5" fontname="Helvetica" fontsize=12 height=0.3]'
  echo 'edge [color="#7f8c9b" arrowsize=0.6]'
  tail -n +2 "$build/modules.dot"
} | tred | dot -Tsvg -o "$picture"
if [[ ${1:-} == --check ]]; then
  edges() { grep -o '<title>[^<]*&#45;&gt;[^<]*' "$1" | sort; }
  [[ -n $(edges "$picture") ]] || { echo "the modules have no edges"; exit 1; }
  cmp -s <(edges docs/images/modules.svg) <(edges "$picture") || { echo "docs/images/modules.svg is not up to date: run scripts/draw_modules.sh"; exit 1; }
fi
