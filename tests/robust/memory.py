#!/usr/bin/env python3
"""Memory while frames go on: resident memory and the bytes that are allocated, over the last half of a long run.

Usage: memory.py BUILD_FOLDER [FRAMES]     default: 20,000 frames of 64x36 pixels, of the demo and of the tool, and of
32x32 of a host
       memory.py BUILD_FOLDER share        1,500 frames of demo and tool in a small scene: part of every test run
Resident memory may grow by less than 1 MiB in the last half: the least of the run's last tenth is compared with the
least of the first tenth of that half, since what frames in flight hold comes and goes.
Allocated bytes, as counted by count_allocations.c, may grow by none. The demo's balls never lie as before, so that the
least of one twentieth of the last half differs from the next one's by some kilobytes without any growth; through these
twenty leasts (of any moment, not of samples) goes a line, whose rise over the half is shown with its 95 % interval.
Wrong is a rise of more than a byte in a hundred frames that the interval bears out, and an interval of more than two
bytes a frame to either side, which could not tell. The tool's camera goes round in 200 frames, so that each twentieth
has all of its views; its frames are those of the warm-up, of which it keeps no times (it thins out those of the others,
which go up and down by megabytes). In runs of less than 10,000 frames 64 kB more are let through: logs of 4,096
removals and of the times of 4,096 frames fill until their last half; and resident memory may grow by 8 MiB, 27 kB a
frame, since what the allocator keeps for reuse goes on growing for some thousand frames (1.5 MB were seen in the last 300
of 600). Before anything is run, the measure itself is
tried on made-up series.
"""
import concurrent.futures
import mmap
import os
import pathlib
import random
import struct
import subprocess
import sys
import tempfile
import time


def resident(pid):
    with open(f"/proc/{pid}/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def least_allocated(counter):
    """Since the last call; counts from what there is now on."""
    with open(counter, "r+b") as file, mmap.mmap(file.fileno(), 16) as shared:
        now, least = struct.unpack("=qq", shared[:])
        shared[8:] = struct.pack("=q", now)
        return min(now, least)


def watch(command, counter, environment, folder):
    """(resident, least allocated) of the process, some 20 times a second, and its exit status."""
    process = subprocess.Popen(command, env=environment, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    samples = []
    while process.poll() is None:
        try:
            samples.append((resident(process.pid), least_allocated(counter)))
        except (OSError, IndexError, ValueError):
            pass
        time.sleep(.05)
    return samples, process.returncode, process.stderr.read().decode(errors="replace")


def before_end(values):
    """Without the last fiftieth, and at least a second: a program that ends gives its memory back."""
    return values[:-max(20, len(values) // 50)] or values[:1]


def grown(values):
    """From the middle of the run to its end, by the leasts of a tenth of the run."""
    tenth = max(1, len(values) // 10)
    return min(values[-tenth:]) - min(values[len(values) // 2:len(values) // 2 + tenth])


TWENTIETHS = 20
STUDENT = 2.101  # 95 % of Student's distribution with 18 degrees of freedom


def leasts(values):
    """Of each twentieth of the last half."""
    half = values[len(values) // 2:]
    return [min(half[i * len(half) // TWENTIETHS:(i + 1) * len(half) // TWENTIETHS], default=half[-1])
            for i in range(TWENTIETHS)]


def rise(least):
    """Over the half, by a line through the leasts; and half the width of its 95 % interval."""
    places = [i / (TWENTIETHS - 1) - 0.5 for i in range(TWENTIETHS)]
    mean, spread = sum(least) / TWENTIETHS, sum(x * x for x in places)
    slope = sum(x * y for x, y in zip(places, least)) / spread
    rest = sum((y - mean - slope * x) ** 2 for x, y in zip(places, least))
    return slope, STUDENT * (rest / (TWENTIETHS - 2) / spread) ** 0.5


def problem_of_allocated(least, frames):
    """What is wrong with the rise, or nothing."""
    slope, half_width = rise(least)
    let_through = frames / 2 / 100 + (0 if frames >= 10000 else 65536)
    if slope - half_width > let_through:
        return "grows"
    return "can't tell" if half_width > 2 * frames / 2 + let_through else ""


def check_the_measure():
    """Three bytes a frame are found where the leasts differ as the demo's do, and none where nothing grows."""
    numbers, frames = random.Random(7), 20000

    def found(bytes_a_frame, spread):
        return problem_of_allocated([5e8 + bytes_a_frame * frames / 2 * i / TWENTIETHS + numbers.uniform(0, spread)
                                     for i in range(TWENTIETHS)], frames)

    for bytes_a_frame, spread, wanted in ((0, 20e3, ""), (3, 20e3, "grows"), (-3, 20e3, ""), (0.1, 0, "grows"),
                                          (0, 100e3, "can't tell")):
        results = [found(bytes_a_frame, spread) for _ in range(40)]
        assert results.count(wanted) >= 35, (bytes_a_frame, spread, results)
    frames = SHARE_FRAMES
    for bytes_a_frame, spread, wanted in ((0, 20e3, ""), (500, 20e3, "grows")):
        results = [found(bytes_a_frame, spread) for _ in range(40)]
        assert results.count(wanted) >= 35, (bytes_a_frame, spread, results)


SHARE_FRAMES = 1500
RESIDENT = 8 << 20, 1 << 20  # bytes: of short and of long runs


def run(build, library, frames, name, command):
    """A row of the table, and what is wrong with it."""
    with tempfile.TemporaryDirectory() as folder:
        counter = pathlib.Path(folder) / "allocated"
        environment = dict(os.environ, LD_PRELOAD=str(library), SUNFLECK_ALLOCATED=str(counter), SUNFLECK_FRAMES=frames)
        begin = time.time()
        samples, status, output = watch([str(build / "bin" / command[0]), *command[1:]], counter, environment, folder)
    pages, allocated = ([s[i] for s in before_end(samples)] for i in range(2))
    least = leasts(allocated)
    slope, half_width = rise(least)
    problems = [text for text, is_so in (
        (f"exit status {status}", status != 0), ("resident grows", grown(pages) >= RESIDENT[int(frames) >= 10000]),
        (f"allocated {problem_of_allocated(least, int(frames))}", problem_of_allocated(least, int(frames)))) if is_so]
    row = (f"| {name} | {frames} | {time.time() - begin:.0f} | {pages[-1] / 1e6:.1f} | {grown(pages) / 1e3:.0f} | "
           f"{allocated[-1] / 1e6:.1f} | {slope / 1e3:.1f} +- {half_width / 1e3:.1f} |"
           + "".join(f" {problem}" for problem in problems))
    return (row if status == 0 else f"{row}\n{output[-500:]}"), len(problems)


def main():
    build, frames = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2] if len(sys.argv) > 2 else "20000"
    is_share = frames == "share"
    if is_share:
        frames = str(SHARE_FRAMES)
    lights = "8" if is_share else "64"
    runs = {"demo": ["sunfleck_demo", "--headless", "--size", "64x36", "--pictures", "0", "--frames", frames, "-o", "out"],
            "tool": ["sunfleck", "render", "four_pillars", "--size", "64x36", "--lights", lights, "--warmup", frames,
                     "--frames", "1", "--orbit", "1.8", "-o", "out.png"],
            "host": ["robust_tests", "--gtest_filter=RobustHostMemory.*"]}
    if is_share:
        del runs["host"]
        runs["demo"] += ["--scene", "four_pillars"]
    wrong, library = 0, build / "lib/libsunfleck_count_allocations.so"
    if not library.exists():
        sys.exit(f"{library} is missing: build the target sunfleck_count_allocations")
    check_the_measure()
    print("| program | frames | s | resident, MB | grows, kB | allocated, MB | rises, kB |\n|---|---|---|---|---|---|---|")
    with concurrent.futures.ThreadPoolExecutor(2 if is_share else 1) as threads:
        for row, problems in threads.map(lambda one: run(build, library, frames, *one), runs.items()):
            print(row, flush=True)
            wrong += problems
    print(f"{len(runs)} tried, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
