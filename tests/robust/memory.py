#!/usr/bin/env python3
"""Memory while frames go on: resident memory and the bytes that are allocated, over the last half of a long run.

Usage: memory.py BUILD_FOLDER [FRAMES]     default: 20,000 frames of 64x36 pixels, of the demo and of the tool, and of
32x32 of a host
Resident memory may grow by less than 1 MiB in the last half, and allocated bytes, as counted by count_allocations.c, by
none. Both are compared as the least of a tenth of the run with the least of another: what frames in flight hold comes
and goes. (The tool's camera goes round in 200 frames, so that each tenth has all of its views.) Of allocated bytes that
is the least at any moment, not of samples. One tenth's differs from another's by some hundred bytes, in the demo, whose
balls never lie as before, by some kilobytes, so that this bound misses there without growth. Runs of less than 10,000
frames may grow by 64 kB: logs of 4,096 removals and of the times of 4,096 frames fill until their last half.
"""
import mmap
import os
import pathlib
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


def watch(command, counter, environment):
    """(resident, least allocated) of the process, some 20 times a second, and its exit status."""
    process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
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
    """From the middle of the run to its end."""
    tenth = max(1, len(values) // 10)
    return min(values[-tenth:]) - min(values[len(values) // 2:len(values) // 2 + tenth])


def allowed(frames):
    """Growth of allocated bytes, in bytes."""
    return 1024 if frames >= 10000 else 65536


def main():
    build, frames = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2] if len(sys.argv) > 2 else "20000"
    runs = {"demo": ["sunfleck_demo", "--headless", "--size", "64x36", "--pictures", "0", "--frames", frames, "-o", "out"],
            "tool": ["sunfleck", "render", "four_pillars", "--size", "64x36", "--lights", "64", "--frames", frames, "--orbit",
                     "1.8", "-o", "out.png"],
            "host": ["robust_tests", "--gtest_filter=RobustHostMemory.*"]}
    wrong, library = 0, build / "lib/libsunfleck_count_allocations.so"
    if not library.exists():
        sys.exit(f"{library} is missing: build the target sunfleck_count_allocations")
    print("| program | frames | s | resident, MB | grows, kB | allocated, MB | grows, kB |\n|---|---|---|---|---|---|---|")
    for name, (program, *rest) in runs.items():
        with tempfile.TemporaryDirectory() as folder:
            counter = pathlib.Path(folder) / "allocated"
            environment = dict(os.environ, LD_PRELOAD=str(library),
                               SUNFLECK_ALLOCATED=str(counter), SUNFLECK_FRAMES=frames)
            begin = time.time()
            os.chdir(folder)
            samples, status, output = watch([str(build / "bin" / program), *rest], counter, environment)
            pages, allocated = ([s[i] for s in before_end(samples)] for i in range(2))
            right = status == 0 and grown(pages) < 1 << 20 and grown(allocated) < allowed(int(frames))
            wrong += not right
            print(f"| {name} | {frames} | {time.time() - begin:.0f} | {pages[-1] / 1e6:.1f} | {grown(pages) / 1e3:.0f} | "
                  f"{allocated[-1] / 1e6:.1f} | {grown(allocated) / 1e3:.0f} |", flush=True)
            if status != 0:
                print(output[-500:])
    print(f"{len(runs)} tried, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
