#!/usr/bin/env bash
# How smooth the game is in its window, from outside: see usage below. Parts that are there at this commit are not run again.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

before_commit=6fcfc29 # the game is whole there, and nothing of its smoothness is begun
seconds=${SUNFLECK_BENCH_SECONDS:-40}
samples=${SUNFLECK_BENCH_SAMPLES:-128}
rooms=(porch corner "red wall" shutters blocks colours tower "lamp room")

usage() {
    cat <<TEXT
./run bench smoothness [PART...]    parts: pacing, latency, target, passes, pictures, report (default: all, in this order)

pacing     time between presents while the solution is played by keys, room by room ($seconds s each), of this tree and of
           commit $before_commit by turns: before, after, after, before
latency    from an X event to the first changed pixel, looking and walking, in the one room where nothing moves by itself
target     time between presents with frame_milliseconds = 100, 66 and 50, after five seconds in the room, and with the
           least settings (10), which show what can be held: of a shorter time, the game is to say that it is out of reach
passes     what each pass and stage of a frame takes, without a window, over the solution at 8 steps a frame, of this tree
           and of commit $before_commit by turns as above
pictures   FLIP against the path tracer, of both, in a view of each room: once the picture is settled, and while the person
           and the lantern turn. The level is that of commit $before_commit with a fixed exposure, as the path tracer's
           is; at half of the displayed size, and $samples samples per pixel (SUNFLECK_BENCH_SAMPLES)
report     tables of what is there, beside the targets; exit status 1 where one is missed

Preset software at 1280x720, on a display of its own. It takes about an hour and a half on two cores, which should do nothing
else: passes 15 minutes, pictures 20 at first and 5 when their references are there. For trials, SUNFLECK_BENCH_SECONDS=N is
the time in a room, and SUNFLECK_BENCH_ROOMS=N leaves pictures at the first N rooms.
Results are in build/bench-smoothness; an interrupted run goes on where it was.
TEXT
}

for argument in "$@"; do
    case $argument in
    -h | --help) usage; exit 0 ;;
    pacing | latency | target | passes | pictures | report) ;;
    *) echo "./run bench smoothness: no part '$argument'" >&2; usage >&2; exit 2 ;;
    esac
done
parts=("$@")
((${#parts[@]})) || parts=(pacing latency target passes pictures report)

base=build/bench-smoothness
folder=$base/$(git describe --always --dirty 2>/dev/null || echo unknown)
mkdir -p "$folder"
bench=build/release/bin/smoothness_bench
sunfleck=build/release/bin/sunfleck
failed=0

# key_of FOLDER: of the level among these scenes, so that nothing that was made for another level is used.
key_of() { cat "$1/lantern_game.scene.json" "$1/lantern_game.glb" | sha256sum | cut -c1-12; }

# The demo of a side: before or after.
demo_of() {
    [[ $1 != before ]] || printf '%s/before/' "$base"
    echo build/release/bin/sunfleck_demo
}

# The program of the commit before, built beside the results. All that is changed of it is that its statistics have the
# times of each frame, as this tree's have with --each-frame.
build_before() {
    local patch=$PWD/tests/bench/smoothness/before.patch
    [[ -d $base/before ]] || git worktree add --detach "$base/before" $before_commit >/dev/null || return 1
    (
        cd "$base/before" || exit 1
        if ! git apply --reverse --check "$patch" 2>/dev/null; then
            git apply "$patch" || exit 1
            rm -f build/release/bin/sunfleck_demo # of before the patch
        fi
        [[ ! -x build/release/bin/sunfleck_demo ]] || exit 0
        export CCACHE_BASEDIR=$PWD
        cmake --preset release >/dev/null && cmake --build build/release --target sunfleck_demo >build.log 2>&1
    )
}
need_before() {
    build_before || { echo "commit $before_commit does not build: see $base/before/build.log" >&2; exit 1; }
}

# measure WHAT SIDE NAME ROOM COUNT [ARGUMENT...]: one run, unless it is there.
measure() {
    local what=$1 side=$2 name=$3 room=$4 count=$5 demo
    demo=$(demo_of "$side")
    local output=$folder/$side-$name-${room// /_}.json
    shift 5
    if [[ -f $output ]]; then echo "$side $name, $room: there"; return; fi
    if "$bench" "$what" "$demo" "$checkpoints" "$room" "$count" "$output" --preset software --size 1280x720 "$@"; then
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

# headless SIDE FOLDER ARGUMENT...: plays without a window; statistics and pictures are in the folder then.
headless() {
    local side=$1 output=$2 more=()
    shift 2
    [[ $side == before ]] || more=(--each-frame)
    rm -rf "$output"
    "$(demo_of "$side")" --headless --preset software --size 1280x720 -o "$output" "${more[@]}" "$@" >"$output.log" 2>&1 &&
        rm "$output.log" && return
    local status=$?
    ((status < 128)) || exit $status
    failed=1
    echo "$side: NOT MEASURED, see $output.log"
    return 1
}

passes() {
    local solution=$base/solution-$key frames=() run side output
    [[ -z ${SUNFLECK_BENCH_SECONDS:-} ]] || frames=(--frames $((seconds * ${#rooms[@]} * 60 / 8)))
    if [[ ! -f $solution.walk ]]; then
        "$(demo_of after)" --headless --simulate --scene lantern_game --record "$solution.part" -o "$solution" \
            >/dev/null || exit 1
        mv "$solution.part" "$solution.walk"
    fi
    for run in before-1 after-1 after-2 before-2; do
        side=${run%-*}
        output=$folder/$side-passes${run#*-}.json
        if [[ -f $output ]]; then echo "$side passes: there"; continue; fi
        headless "$side" "$output.run" --scene lantern_game --input "$solution.walk" --steps-per-frame 8 --pictures 0 \
            "${frames[@]}" || continue
        mv "$output.run/stats.json" "$output"
        rm -rf "$output.run"
        echo "$side passes: measured"
    done
}

# draw SIDE FOLDER: the pictures of all views, in one run.
draw() {
    local side=$1 to=$2 exposure hash room moment frame more=() last
    { read -r exposure && read -r hash; } <"$views/world.txt"
    last=$(tail -n 1 <<<"$wanted" | cut -f3)
    [[ $side == before ]] || more=(--ev100 "$exposure") # the commit before knows no other than the scene's
    headless "$side" "$to.run" --scene "$level/lantern_game.scene.json" --input "$views/views.walk" --steps-per-frame 10 \
        --frames $((last + 1)) --pictures $((last / 20 + 1)) "${more[@]}" || return 1
    if [[ -z ${SUNFLECK_BENCH_ROOMS:-} ]] && ! grep -q "\"world_hash\": \"$hash\"" "$to.run/stats.json"; then
        echo "$side: the same input led to another world than in $views, which is out of date: remove it"
        failed=1
        return 1
    fi
    mkdir -p "$to"
    while IFS=$'\t' read -r room moment frame _; do
        "$bench" halve "$to.run/frame_$(printf %05d "$frame").png" "$to/$room-$moment.png" || exit 1
    done <<<"$wanted"
    rm -rf "$to.run"
}

# trace SCENE CAMERA SEED: prints the name of the path tracer's picture, which is traced unless it is there.
trace() {
    local picture="$views/${1%.scene.json}-$samples-$3.png"
    [[ -f $picture ]] || "$sunfleck" reference "$views/$1" -o "$picture" --camera "$2" --size 640x360 --spp "$samples" \
        --seed "$3" --antialiasing --caustics off --motion off >&2 || return
    echo "$picture"
}

# compare NAME ROOM MOMENT PICTURE REFERENCE
compare() {
    local result output=$folder/$1-picture-${2// /_}-$3.json
    if [[ -f $output ]]; then echo "$1 picture, $2, $3: there"; return; fi
    result=$("$sunfleck" compare "$4" "$5" --json) || exit 1
    echo "{\"measured\": \"picture\", \"room\": \"$2\", \"moment\": \"$3\", \"spp\": $samples, ${result#\{}" >"$output"
    echo "$1 picture, $2, $3: measured"
}

# Both play one input in one level, so that their views are of one world, and one reference serves both.
pictures() {
    local level=$base/before/build/release/scenes views wanted side room moment camera scene reference second to
    views=$base/views-$(key_of "$level")
    [[ -f $views/views.txt ]] || "$bench" views "$level/lantern_game.scene.json" "$views" || exit 1
    wanted=$(head -n $((2 * ${SUNFLECK_BENCH_ROOMS:-${#rooms[@]}})) "$views/views.txt")
    for side in before after; do
        to=$folder/pictures
        [[ $side != before ]] || to=$views/before
        while IFS=$'\t' read -r room moment _; do
            [[ -f $to/$room-$moment.png ]] || { draw "$side" "$to" || return; break; }
        done <<<"$wanted"
        while IFS=$'\t' read -r room moment _ camera scene; do
            reference=$(trace "$scene" "$camera" 1) || exit $?
            compare "$side" "$room" "$moment" "$to/$room-$moment.png" "$reference"
        done <<<"$wanted"
    done
    IFS=$'\t' read -r room _ _ camera scene <<<"$wanted"
    reference=$(trace "$scene" "$camera" 1) && second=$(trace "$scene" "$camera" 2) || exit $?
    compare reference "$room" noise "$second" "$reference"
}

key=$(key_of build/release/scenes) || exit 1
checkpoints=$base/rooms-$key
if [[ ! -d $checkpoints ]]; then
    rm -rf "$checkpoints.part"
    "$bench" rooms "$checkpoints.part" && mv "$checkpoints.part" "$checkpoints" || exit 1
fi
for part in "${parts[@]}"; do
    case $part in
    pacing)
        need_before
        for room in "${rooms[@]}"; do
            for run in before-1 after-1 after-2 before-2; do
                measure pacing "${run%-*}" "pacing${run#*-}" "$room" "$seconds"
            done
        done ;;
    latency) measure latency after latency corner 80 ;; # elsewhere something moves, or the light does
    target)
        for room in corner shutters tower; do
            for target in 10 100 66 50; do
                side=target$target
                ((target > 10)) || side=least
                measure pacing $side pacing "$room" "$seconds" --settings "$(realpath "$(settings_for $target)")"
            done
        done ;;
    passes) need_before; passes ;;
    pictures) need_before; pictures ;;
    report) "$bench" report "$folder" || failed=1 ;;
    esac
done
exit $failed
