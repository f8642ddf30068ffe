#!/usr/bin/env bash
# A technique can be deleted: copies the project, deletes the technique's folder, its line, its tests and its page, and
# builds and tests what is left. The short size builds and runs the unit tests, and only without the first technique of
# the list, whose place another must take; the long size everything.
# Usage: delete_technique.sh BUILD_FOLDER FOLDER_OF_GI_MODULE
set -euo pipefail
build=$(cd "$1" && pwd) technique=$2
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
size=${SUNFLECK_TEST_SIZE:-short}
fail() { echo "without $technique: $*"; exit 1; }

techniques_of() { sed -n '/^sunfleck_techniques(/,/^)/{s/^ *\([a-z_]*\)$/\1/p}' "$1/gi_module/CMakeLists.txt"; }
names_of() { # in --direct and the like, in the order of the list
    for folder in $(techniques_of "$1"); do sed -n 's/^ *\.name = "\([a-z_]*\)",$/\1/p' "$1/gi_module/$folder/"*_technique.cpp; done
}
name=$(sed -n 's/^ *\.name = "\([a-z_]*\)",$/\1/p' "$root/gi_module/$technique/"*_technique.cpp)
[[ -n $name ]] || fail "gi_module/$technique has no TechniqueEntry with a name"
if [[ $size == short && $technique != $(techniques_of "$root" | head -1) ]]; then
    echo "skipped: the short size deletes only the first technique of the list"
    exit 77
fi

# The copy's build folder lies in it as the original's does: with CCACHE_BASEDIR, what is compiled the same way is found
# in the cache.
copy=$build/without/$technique
rm -rf "$copy"
mkdir -p "$copy"
trap 'rm -rf "$copy"' EXIT
tar -C "$root" --exclude=./build --exclude=./.git --exclude=./shared -cf - . | tar -C "$copy" -xf -
rm -r "$copy/gi_module/$technique" "$copy/tests/techniques/$technique" "$copy/docs/techniques/$name.md"
sed -i "/^sunfleck_techniques(/,/^)/{/^ *$technique\$/d}" "$copy/gi_module/CMakeLists.txt"
[[ $(diff "$root/gi_module/CMakeLists.txt" "$copy/gi_module/CMakeLists.txt" | grep -c '^[<>]') == 1 ]] ||
    fail "the technique is not one line of gi_module/CMakeLists.txt"

cd "$copy"
export CCACHE_BASEDIR=$copy SUNFLECK_TEST_SIZE=short
log=$build/without_$technique.log
build_it() {
    cmake --preset release >"$log" 2>&1 || { tail -30 "$log"; fail "configuring failed"; }
    cmake --build build/release "$@" >>"$log" 2>&1 ||
        { grep -A6 -E 'error|FAILED' "$log" | head -40; fail "building failed"; }
}
# Tests of the technique that are left, and this script in the copy, are no tests of what is left.
count() { ctest --test-dir "$1" -N "${chosen[@]}" | sed -n 's/^Total Tests: //p'; }
run_tests() { ctest --test-dir build/release -j2 --timeout 600 --output-on-failure --no-tests=error "${chosen[@]}"; }
if [[ $size == short ]]; then
    chosen=(-L '^unit_tests$')
    build_it --target unit_tests
else
    chosen=(-E '^(without_|style_|embedding$)')
    build_it
fi
before=$(count "$build") after=$(count build/release)
echo "$after of $before tests are left"
((after * 100 >= before * 85)) || fail "less than 85 % of the tests are left"
run_tests

# What is first in the list now is the default: unit tests hold the settings to the list, this the list to the folders.
if [[ $size == long ]]; then
    first=$(names_of "$copy" | head -1)
    direct=$(build/release/bin/sunfleck info --reference | grep -F "| \`direct\` * |") # whole: a reader that leaves early fails the pipe
    [[ $direct == *"|  | $first |"* ]] || fail "the default technique for direct light is not $first"
    build/release/bin/sunfleck render cornell -o "$copy/picture.png" --size 64x48 --lights 20
fi
