#!/usr/bin/env bash
# How smooth the game is in its window, from outside: see usage below. Parts that are there at this commit are not run again.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

before_commit=6fcfc29 # the game is whole there, and nothing of its smoothness is begun
seconds=${SUNFLECK_BENCH_SECONDS:-40}
rooms=(porch corner "red wall" shutters blocks colours tower "lamp room")

usage() {
    cat <<TEXT
./run bench smoothness [PART...]    parts: pacing, latency, target, report (default: all, in this order)

pacing     time between presents while the solution is played by keys, room by room ($seconds s each), of this tree and of
           commit $before_commit by turns: before, after, after, before
latency    from an X event to the first changed pixel, looking and walking, in two rooms
target     time between presents with frame_milliseconds = 100, 66 and 50
report     tables of what is there, beside the targets; exit status 1 where one is missed

Preset software at 1280x720, on a display of its own. It takes about an hour on two cores, which should do nothing else.
Results are in build/bench-smoothness; an interrupted run goes on where it was.
TEXT
}

for argument in "$@"; do
    case $argument in
    -h | --help) usage; exit 0 ;;
    pacing | latency | target | report) ;;
    *) echo "./run bench smoothness: no part '$argument'" >&2; usage >&2; exit 2 ;;
    esac
done
parts=("$@")
((${#parts[@]})) || parts=(pacing latency target report)

base=build/bench-smoothness
folder=$base/$(git describe --always --dirty 2>/dev/null || echo unknown)
mkdir -p "$folder"
bench=build/release/bin/smoothness_bench
failed=0

# The program of the commit before, built beside the results.
build_before() {
    [[ -x $base/before/build/release/bin/sunfleck_demo ]] && return
    [[ -d $base/before ]] || git worktree add --detach "$base/before" $before_commit >/dev/null || return 1
    (cd "$base/before" && export CCACHE_BASEDIR=$PWD && cmake --preset release >/dev/null &&
        cmake --build build/release --target sunfleck_demo >build.log 2>&1)
}

# measure WHAT SIDE NAME ROOM COUNT [ARGUMENT...]: one run, unless it is there.
measure() {
    local what=$1 side=$2 name=$3 room=$4 count=$5 demo=build/release/bin/sunfleck_demo
    local output=$folder/$side-$name-${room// /_}.json
    shift 5
    [[ $side != before ]] || demo=$base/before/build/release/bin/sunfleck_demo
    if [[ -f $output ]]; then echo "$side $name, $room: there"; return; fi
    if "$bench" "$what" "$demo" "$base/rooms" "$room" "$count" "$output" --preset software --size 1280x720 "$@"; then
        echo "$side $name, $room: measured"
        rm -rf "$output.run"
    else
        local status=$?
        ((status < 128)) || exit $status
        failed=1
    fi
}

# Settings that hold a target; without one, the program chooses none.
settings_for() {
    mkdir -p "$folder/settings"
    echo "{\"preset\": \"software\", \"frame_milliseconds\": $1}" >"$folder/settings/$1.json"
    echo "$folder/settings/$1.json"
}

[[ -d $base/rooms ]] || "$bench" rooms "$base/rooms" || exit 1
for part in "${parts[@]}"; do
    case $part in
    pacing)
        build_before || { echo "commit $before_commit does not build: see $base/before/build.log" >&2; exit 1; }
        for room in "${rooms[@]}"; do
            for run in before-1 after-1 after-2 before-2; do
                measure pacing "${run%-*}" "pacing${run#*-}" "$room" "$seconds"
            done
        done ;;
    latency) for room in corner tower; do measure latency after latency "$room" 40; done ;;
    target)
        for target in 100 66 50; do
            for room in corner shutters tower; do
                measure pacing "target$target" pacing "$room" "$seconds" --settings "$(realpath "$(settings_for $target)")"
            done
        done ;;
    report) "$bench" report "$folder" || failed=1 ;;
    esac
done
exit $failed
