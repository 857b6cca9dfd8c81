#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Goes from a clean clone to a report: installs packages, builds, and runs `resight demo` into out/demo, which is
# created anew. Arguments are passed to `resight demo`, e.g. --seed 2.
set -euo pipefail
if [[ " $* " == *" --out"* ]]; then
  echo "demo.sh: the report goes to out/demo; use \`resight demo --out\` for another folder" >&2
  exit 2
fi
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/setup.sh
source scripts/common.sh

step "configure" cmake --preset release -B build/demo -DRESIGHT_BUILD_TESTS=OFF -DRESIGHT_BUILD_EXAMPLES=OFF
step "build the program" cmake --build build/demo --target resight_app -j "$num_jobs"
rm -rf out/demo
build/demo/apps/resight/resight demo --out out/demo "$@"
echo "open out/demo/report.html in a browser"
