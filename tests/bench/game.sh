#!/usr/bin/env bash
# What ./run test holds the game to, in its full size: see usage below. Parts that passed at this commit are not run again.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

usage() {
    cat <<TEXT
./run bench game [PART...]    parts: solution, sensors, states, players, checkpoints, window (default: all, in this order)

solution      the solution ends the game; on 1 and 2 threads; by direct light and with white panels it does not
sensors       light sensors in a room of their own against the path tracer, 200 states
states        the level's sensors against the path tracer: 200 random states, 65,536 samples, in 20 parts
players       50 random players of ten minutes each, after whom the solution still ends the game, each a part
checkpoints   200 killed writers, damaged, cut, foreign and newer files, a full disk
window        the game in a window, with real keys; its world by every preset and number of steps a frame

It takes about an hour on two cores. Results are in build/bench-game; an interrupted run goes on where it was.
TEXT
}

for argument in "$@"; do
    case $argument in
    -h | --help) usage; exit 0 ;;
    solution | sensors | states | players | checkpoints | window) ;;
    *) echo "./run bench game: no part '$argument'" >&2; usage >&2; exit 2 ;;
    esac
done
parts=("$@")
((${#parts[@]})) || parts=(solution sensors states players checkpoints window)

folder=build/bench-game/$(git describe --always --dirty 2>/dev/null || echo unknown)
mkdir -p "$folder"
export SUNFLECK_TEST_SIZE=long
failed=0

# part NAME PROGRAM FILTER [K/N]: runs it unless it has passed.
part() {
    local log=$folder/$1.log
    if [[ -f $folder/$1.passed ]]; then echo "$1: passed before"; return; fi
    local began=$SECONDS
    if SUNFLECK_TEST_PART=${4:-0/1} "build/release/bin/$2" --gtest_filter="$3" >"$log" 2>&1; then
        if grep -q '^\[  SKIPPED \]' "$log"; then # as where there is no display to play on
            failed=1
            echo "$1: NOT RUN, see $log"
            return
        fi
        touch "$folder/$1.passed"
        echo "$1: passed in $((SECONDS - began)) s"
    else
        local status=$?
        ((status < 128)) || exit $status
        failed=1
        echo "$1: FAILED after $((SECONDS - began)) s, see $log"
    fi
    grep -E '^(worst|[a-z ]+: [0-9.]+ of its|[0-9]+ (steps|rays))' "$log" | sed 's/^/    /'
}

for name in "${parts[@]}"; do
    case $name in
    solution) part solution game_tests 'Game.The*:Game.Direct*:Game.White*' ;;
    sensors) part sensors game_tests 'LightSensors.*' ;;
    states) for ((i = 0; i < 20; i++)); do part "states-$i" game_tests 'Game.SensorsAgree*' "$i/20"; done ;;
    players) for ((i = 0; i < 50; i++)); do part "players-$i" game_tests 'Game.Aimless*' "$i/50"; done ;;
    checkpoints) part checkpoints game_tests 'GameCheckpoints.*' ;;
    window) part window tool_tests 'GameWindow.*:Heard.*:CommandLine.TheGame*' ;;
    esac
done
passed=$(find "$folder" -name '*.passed' | wc -l)
echo "$passed parts of 74 have passed at this commit"
exit $failed
