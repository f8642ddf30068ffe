#!/usr/bin/env bash
# clang-tidy with .clang-tidy. A file takes some five seconds, so the short size looks at a few that include nearly all
# headers, and at what the last commit changed; the long size at all of gi_module and engine/gpu.
# Usage: tidy.sh BUILD_FOLDER
set -euo pipefail
build=$(cd "$1" && pwd)
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
tidy=$(command -v clang-tidy-14 || command -v clang-tidy) || { echo "skipped: clang-tidy is not installed"; exit 77; }
[[ -f $build/compile_commands.json ]] || { echo "skipped: $build has no compile_commands.json"; exit 77; }
if [[ ${SUNFLECK_TEST_SIZE:-short} == long ]]; then
    mapfile -t files < <(find gi_module engine/gpu -name '*.cpp' | sort)
else
    files=(gi_module/system.cpp engine/gpu/memory.cpp)
    if changed=$(git diff --name-only --diff-filter=d HEAD~1 -- '*.cpp' 2>/dev/null); then
        mapfile -t -O "${#files[@]}" files < <(grep -v '^tests/embedding\|^tests/fuzz' <<<"$changed" | head -4)
    fi
fi
mapfile -t files < <(printf '%s\n' "${files[@]}" | sort -u | grep .)
commands=$(mktemp -d)
trap 'rm -rf "$commands"' EXIT
python3 tests/style/compile_commands.py "$build/compile_commands.json" >"$commands/compile_commands.json"
printf '%s\0' "${files[@]}" |
    xargs -0 -P2 -n1 "$tidy" -p "$commands" --quiet --extra-arg=-Wno-unknown-warning-option 2>/dev/null
echo "${#files[@]} files"
