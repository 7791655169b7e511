#!/usr/bin/env bash
# clang-tidy on the sources of the product: .ci/tidy.sh [FILE...]; configure first (cmake --preset release).
set -euo pipefail
cd "$(dirname "$0")/.."
clang_tidy=$(command -v clang-tidy-14 || command -v clang-tidy) || {
  echo "tidy.sh: install clang-tidy-14" >&2
  exit 1
}
build=${GEOSIS_BUILD_DIR:-build/release}
[ -f "$build/compile_commands.json" ] || { echo "tidy.sh: no $build/compile_commands.json: configure first" >&2; exit 1; }
if [ $# -gt 0 ]; then files=("$@"); else mapfile -t files < <(find engine server -name '*.cpp'); fi
printf '%s\0' "${files[@]}" | xargs -0 -n 1 -P "$(nproc)" "$clang_tidy" -p "$build" --quiet --warnings-as-errors='*'
