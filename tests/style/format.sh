#!/usr/bin/env bash
# All C++ of the project is formatted by clang-format 14 (Debian 12's) with .clang-format. Mends with --fix.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
format=$(command -v clang-format-14 || command -v clang-format) || { echo "skipped: clang-format is not installed"; exit 77; }
"$format" --version | grep -q ' 14\.' || { echo "skipped: needs clang-format 14, other versions format otherwise"; exit 77; }
mapfile -d '' files < <(find assets editor engine game_demo gi_module tests viewer -name '*.cpp' -print0 -o -name '*.h' -print0)
if [[ ${1:-} == --fix ]]; then exec "$format" -i "${files[@]}"; fi
"$format" --dry-run -Werror "${files[@]}" || { echo "mend by: tests/style/format.sh --fix"; exit 1; }
echo "${#files[@]} files"
