#!/usr/bin/env bash
# Checks that clang-format 14 would change nothing; with --fix it changes it.
set -euo pipefail
cd "$(dirname "$0")/.."
clang_format=$(command -v clang-format-14 || command -v clang-format) || {
  echo "format.sh: install clang-format-14" >&2
  exit 1
}
mode=(--dry-run --Werror)
[ "${1:-}" != --fix ] || mode=(-i)
find engine server tests bench -name '*.h' -print0 -o -name '*.cpp' -print0 | xargs -0 -r "$clang_format" "${mode[@]}"
