#!/usr/bin/env bash
# The whole of what tests/robust has a share of in every run: by parts and seeds, in pieces, going on where it was stopped.
# Usage: bench.sh BUILD_FOLDER --part N [--seeds A-B] [--frames N]
#   1 host      random sequences of calls of sunfleck/host.h, by seed                                    (1-20000)
#   2 faults    every call of Vulkan's that can fail, by its number, with each code that Vulkan allows   (all)
#   3 memory    failing allocations of the calling thread, by seed                                       (1-1000)
# --frames: of the story that parts 2 and 3 play (60).
# Prints what each piece counted. What is done is noted in BUILD_FOLDER/robust, by part and seeds.
set -euo pipefail
build=$(cd "$1" && pwd); shift
part='' seeds='' first=1 last=''
usage() { sed -n '3,8s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 2; }
while (($#)); do
    case $1 in
    --part) part=${2:-}; shift ;;
    --seeds) seeds=${2:-}; shift ;;
    --frames) [[ ${2:-} =~ ^[1-9][0-9]*$ ]] || usage; export SUNFLECK_FRAMES=$2; shift ;;
    *) usage ;;
    esac
    shift || true
done
case $part in
1) filter=RobustHostCalls.AreRightOrRefused last=20000 piece=100 ;;
2) filter=RobustHostFaults.EveryCallOfVulkanMayFail last=1000000 piece=50 ;;
3) filter=RobustHostFaults.EveryAllocationMayFail last=1000 piece=50 ;;
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
    SUNFLECK_TEST_SIZE=long SUNFLECK_FIRST_SEED=$at SUNFLECK_LAST_SEED=$to MESA_SHADER_CACHE_DIR=$build/shader_cache \
        "$build/bin/robust_tests" --gtest_filter=$filter >"$log" 2>&1 || { tail -30 "$log"; echo "$at to $to: $log"; exit 1; }
    counted=$(grep -E '(tried|cases)' "$log" | tail -1)
    echo "$at to $to: $counted"
    printf '%s' $((at + piece)) >"$noted.new" && mv "$noted.new" "$noted"
    [[ $counted != *' 0 cases'* ]] || break # past the last call
done
