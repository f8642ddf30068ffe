#!/usr/bin/env python3
"""Large levels: the time to their first picture, memory, and whether an interrupt ends them at once.

Usage: scale.py BUILD_FOLDER [FIRST LAST]     numbers of the rows below; default: all
The first picture has 64x36 pixels and all of its light. Interrupts come at eight moments of that time. A level of more
objects may take no more than n^1.2, and nobody waits longer than 0.3 s for an interrupt (a second for 100,000 objects:
the system takes that long to have gigabytes back).
"""
import math
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import make_level  # noqa: E402

LEVELS = [("1,000 objects", {"objects": 1000}, []), ("10,000 objects", {"objects": 10000}, []),
          ("100,000 objects", {"objects": 100000}, []), ("100,000 triangles", {"triangles": 10**5}, []),
          ("1 million triangles", {"triangles": 10**6}, []), ("10 million triangles", {"triangles": 10**7}, []),
          ("1,000 lights", {"objects": 100, "lights": 1000}, []), ("500 movers", {"objects": 500, "movers": 500}, []),
          ("65,536 samples", {"objects": 100}, ["--lights", "65536"])]
GROWS_FROM = {1: (0, 10), 2: (1, 10), 4: (3, 10), 5: (4, 10)}  # row: (smaller row, times as many)
LATEST, LATEST_OF = 0.3, {2: 1.0}  # s; others by row


def start(tool, level, more):
    return subprocess.Popen([tool, "render", str(level), "-o", str(level.with_suffix(".png")), "--size", "64x36", "--warmup",
                             "0", "--frames", "1", *more], stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


def finish(process):
    """Its exit status, what it printed, and the most memory that it had, in MB."""
    output = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, output, usage.ru_maxrss / 1024


def interrupt(tool, level, more, seconds):
    """How long it goes on after an interrupt that comes after so many seconds; None where it was done by then."""
    process = start(tool, level, more)
    time.sleep(seconds)
    sent = time.time()
    process.send_signal(signal.SIGINT)
    status, output, _ = finish(process)
    if status == 0:
        return None
    assert status == 128 + signal.SIGINT, (status, output[-300:])
    return time.time() - sent


def main():
    tool, wrong, times = str(pathlib.Path(sys.argv[1]) / "bin/sunfleck"), 0, {}
    first, last = (int(a) for a in sys.argv[2:4]) if len(sys.argv) > 3 else (1, len(LEVELS))
    print("| level | to the first picture, s | grows as | MB | an interrupt takes, s |\n|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        warm = pathlib.Path(folder) / "warm.glb"  # compiles the shaders
        make_level.make(warm, objects=10, movers=2)
        finish(start(tool, warm, []))
        for row in range(first - 1, last):
            name, what, more = LEVELS[row]
            level = pathlib.Path(folder) / f"{row}.glb"
            make_level.make(level, **what)
            begin = time.time()
            status, output, megabytes = finish(start(tool, level, more))
            times[row] = time.time() - begin
            if status != 0:
                wrong += 1
                print(f"| {name} | refused: {output.decode(errors='replace')[-200:]} | | | |", flush=True)
                continue
            grows = ""
            if row in GROWS_FROM and GROWS_FROM[row][0] in times:
                before, factor = GROWS_FROM[row]
                power = math.log(times[row] / times[before]) / math.log(factor)
                wrong += power > 1.2
                grows = f"n^{power:.2f}"
            waits = [w for i in range(8) if (w := interrupt(tool, level, more, times[row] * (i + .5) / 8)) is not None]
            wrong += max(waits, default=0) > LATEST_OF.get(row, LATEST)
            print(f"| {name} | {times[row]:.1f} | {grows} | {megabytes:.0f} | {max(waits, default=0):.2f} |", flush=True)
            level.unlink()
    print(f"{last - first + 1} tried, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
