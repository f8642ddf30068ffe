#!/usr/bin/env bash
# The whole of what tests/robust has a share of in every run: by parts and seeds, in pieces, going on where it was stopped.
# Usage: bench.sh BUILD_FOLDER --part N [--seeds A-B] [--frames N] [--files FOLDER]
#   1 host      random sequences of calls of sunfleck/host.h, by seed                                    (1-20000)
#   2 faults    every call of Vulkan's that can fail, by its number, with each code that Vulkan allows   (all)
#   3 memory    failing allocations of the calling thread, and of others, by seed                       (1-1000)
#   4 files     damaged glTF files, and odd numbers in each field of glTF and scene files: import, patches,
#               Embree, a sample of the path tracer, steps of the simulation, by seed                    (1-20000)
#   5 kills     of whatever writes, by seed (kills.py)                                                   (1-300)
#   6 scale     large levels, by the rows of scale.py's table                                            (1-9)
#   7 steady    memory over 20,000 frames (memory.py)                                                    (1)
#   8 validator glTF-Validator's test files in FOLDER, by number (validator_cases.py)                    (all)
# --frames: of the story that parts 2 and 3 play (60), and of part 7 (20000).
# Prints what each piece counted. What is done is noted in BUILD_FOLDER/robust, by part and seeds.
set -euo pipefail
build=$(cd "$1" && pwd); shift
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
part='' seeds='' files='' frames='' first=1 last=''
usage() { sed -n '3,13s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 2; }
while (($#)); do
    case $1 in
    --part) part=${2:-}; shift ;;
    --seeds) seeds=${2:-}; shift ;;
    --frames) [[ ${2:-} =~ ^[1-9][0-9]*$ ]] || usage; frames=$2; export SUNFLECK_FRAMES=$2; shift ;;
    --files) files=${2:-}; shift ;;
    *) usage ;;
    esac
    shift || true
done
tests=$build/bin/robust_tests
[[ -x $tests ]] || tests=$build/bin/sanitizer_tests # of parts 1 to 4
case $part in
1) run=("$tests" "--gtest_filter=RobustHostCalls.AreRightOrRefused") last=20000 piece=100 ;;
2) run=("$tests" "--gtest_filter=RobustHostFaults.EveryCallOfVulkanMayFail:RobustUnknownErrors.*") last=1000000 piece=50 ;;
3) run=("$tests" "--gtest_filter=RobustHostFaults.*Allocation*") last=1000 piece=50 ;;
4) run=("$tests" "--gtest_filter=RobustDamagedFiles.*:RobustSceneNumbers.*") last=20000 piece=500 ;;
5) run=(python3 "$here/kills.py" "$build") last=300 piece=25 ;;
6) run=(python3 "$here/scale.py" "$build") last=9 piece=3 ;;
7) run=(python3 "$here/memory.py" "$build" "${frames:-20000}") last=1 piece=1 ;;
8) [[ -d $files ]] || { echo "part 8 needs --files FOLDER, with glTF-Validator's test files"; exit 2; }
   run=(python3 "$here/validator_cases.py" "$build" "$files")
   last=$(find "$files" -name '*.gltf' -o -name '*.glb' | wc -l) piece=50 ;;
*) usage ;;
esac
if [[ -n $seeds ]]; then
    [[ $seeds =~ ^([0-9]+)-([0-9]+)$ ]] || usage
    first=${BASH_REMATCH[1]} last=${BASH_REMATCH[2]}
fi
mkdir -p "$build/robust"
noted=$build/robust/part-$part-$first-$last-${SUNFLECK_FRAMES:-60}
[[ -s $noted ]] && at=$(<"$noted") || at=$first
((at == first)) || echo "going on from $at"
for (( ; at <= last; at += piece)); do
    to=$((at + piece - 1 < last ? at + piece - 1 : last))
    log=$build/robust/part-$part-$at-$to.log
    seed=(); ((part < 5 || part == 7)) || seed=("$at" "$to")
    SUNFLECK_TEST_SIZE=long SUNFLECK_FIRST_SEED=$at SUNFLECK_LAST_SEED=$to MESA_SHADER_CACHE_DIR=$build/shader_cache \
        "${run[@]}" "${seed[@]}" >"$log" 2>&1 || { tail -30 "$log"; echo "$at to $to: $log"; exit 1; }
    grep -E '^\|' "$log" || true
    counted=$(grep -E '(tried|cases)' "$log" | paste -sd '|')
    echo "$at to $to: $counted"
    printf '%s' $((at + piece)) >"$noted.new" && mv "$noted.new" "$noted"
    [[ $counted != *' 0 cases'* ]] || break # past the last call
done
