#!/usr/bin/env bash
# How steady the demo is, for whoever starts it without a GPU: see usage below.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

usage() {
    cat <<TEXT
./run bench steady [PART...]    parts: start, walk, window, random (default: all, in this order)

start    seconds until the window shows a first picture, and until it shows all of the light; medians of five
walk     frames over the median of the 30 before them: the recorded walk through the house, without a window
window   the same with presents, in a window: for a minute everything is used that the keys use
random   twenty minutes of random keys, clicks and sizes with validation; SUNFLECK_SEED=N for another sequence

Preset software at 1280x720 (random: 320x180). The exit status is 1 where a target is missed. Logs are in
build/bench-steady. SUNFLECK_BENCH_SECONDS=N shortens window, SUNFLECK_EVENTS=N random.

Example: ./run bench steady start walk
TEXT
}

for argument in "$@"; do
    case $argument in
    -h | --help) usage; exit 0 ;;
    start | walk | window | random) ;;
    *) echo "./run bench steady: no part '$argument'" >&2; usage >&2; exit 2 ;;
    esac
done
parts=("$@")
((${#parts[@]})) || parts=(start walk window random)

folder=$PWD/build/bench-steady
demo=$PWD/build/release/bin/sunfleck_demo
mkdir -p "$folder"
failed=0

# judge WHAT VALUE TARGET: both are numbers; the value is to be at most the target.
judge() {
    if awk -v value="$2" -v target="$3" 'BEGIN { exit !(value <= target) }'; then
        echo "$1: $2, at most $3: met"
    else
        failed=1
        echo "$1: $2, at most $3: MISSED"
    fi
}
median() { sort -n | awk '{ all[NR] = $1 } END { print all[int((NR + 1) / 2)] }'; }
# seconds_of WHAT LOG: as the demo says by --hitches.
seconds_of() { sed -n "s/.*$1 after \([0-9.]*\) s.*/\1/p" "$2" | head -1; }

# with_display SCRIPT: its `start_demo LOG` leaves the window's number in $W and the process in $P, with all of the light.
with_display() {
    local helpers='
export XDG_CONFIG_HOME=$(mktemp -d); trap "rm -rf $XDG_CONFIG_HOME" EXIT
openbox 2>/dev/null & sleep 1
start_demo() {
    "$demo" --hitches --preset software > "$1" 2>&1 & P=$!
    for i in $(seq 1200); do
        grep -q "all of the light after" "$1" && break
        kill -0 $P 2>/dev/null || return 1
        sleep 0.1
    done
    W=$(xdotool search --name "Lantern House$" | tail -1)
}
end_demo() { kill -TERM $P 2>/dev/null; wait $P; }
'
    demo=$demo folder=$folder timeout 1800 \
        xvfb-run -a -s '-screen 0 1400x900x24 -noreset' bash -c "$helpers$1" >"$folder/display.log" 2>&1
}

# judge_hitches NAME LOG: frames above twice the median are listed with what they were spent on.
judge_hitches() {
    local summary
    summary=$(grep -o '[0-9]* frames: 99 % below.*' "$2" | tail -1)
    [[ -n $summary ]] || { failed=1; echo "$1: NOT RUN, see $2"; return; }
    echo "$1: $summary"
    grep -o 'frame [0-9]* took.*' "$2" | sed 's/^/    /'
    judge "$1, 99 % of the frames" "$(sed 's/.*99 % below \([0-9.]*\).*/\1/' <<<"$summary")" 2
    judge "$1, the longest" "$(sed 's/.*longest \([0-9.]*\).*/\1/' <<<"$summary")" 4
}

measure_start() {
    rm -f "$folder"/start_*.log
    with_display 'for i in 1 2 3 4 5; do start_demo "$folder/start_$i.log"; end_demo; done'
    local first all
    first=$(for log in "$folder"/start_*.log; do seconds_of 'first picture' "$log"; done | median)
    all=$(for log in "$folder"/start_*.log; do seconds_of 'all of the light' "$log"; done | median)
    [[ -n $first && -n $all ]] || { failed=1; echo "start: NOT RUN, see $folder"; return; }
    echo "start: a first picture after $first s, all of the light after $all s (medians of five)"
    judge 'start, share of the first picture' "$(awk -v a="$first" -v b="$all" 'BEGIN { printf "%.2f", a / b }')" 0.25
}

measure_walk() {
    "$demo" --headless --preset software --hitches --pictures 1 -o "$folder/walk" >"$folder/walk.log" 2>&1
    judge_hitches walk "$folder/walk.log"
}

# Doors, the lantern, bounced light, turning and walking: each key again and again, with pauses of a hand.
measure_window() {
    rm -f "$folder/window.log"
    seconds=${SUNFLECK_BENCH_SECONDS:-60} with_display '
start_demo "$folder/window.log" || exit 1
xdotool windowfocus $W; sleep 1; xdotool key Return; sleep 1
end=$((SECONDS + ${seconds:-60}))
RANDOM=1 # the same turns each time
while ((SECONDS < end)); do
    for keys in "w e" "d l" "w q" "a l" "w e" "s t" "d q" "w t"; do
        set -- $keys
        xdotool keydown $1; sleep 0.6; xdotool key $2; sleep 0.6; xdotool keyup $1
        xdotool mousemove_relative -- $((RANDOM % 200 - 100)) $((RANDOM % 40 - 20)); sleep 0.3
    done
done
end_demo'
    judge_hitches window "$folder/window.log"
}

for name in "${parts[@]}"; do
    case $name in
    start) measure_start ;;
    walk) measure_walk ;;
    window) measure_window ;;
    random)
        SUNFLECK_EVENTS=${SUNFLECK_EVENTS:-4800} build/release/bin/tool_tests --gtest_filter='SteadyWindow.*' || failed=1
        ;;
    esac
done
exit $failed
