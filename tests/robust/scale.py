#!/usr/bin/env python3
"""Large levels: the time to their first picture, memory, and whether an interrupt ends them at once.

Usage: scale.py BUILD_FOLDER [FIRST LAST]     numbers of the rows below; default: all
       scale.py BUILD_FOLDER share            1,000 objects against 2,000, and one interrupt: part of every test run
The first picture has 64x36 pixels and all of its light. Interrupts come at eight moments of that time; for two of the
levels, the path tracer and the demo are interrupted, too. A level of more
objects may take no more than n^1.2, 10,000 objects no more than 12 s (a tenth of what they took before they were counted
on), and nobody waits longer than 0.3 s for an interrupt. Memory: what a level takes beyond a level of 10 objects grows by
no more than n^1.2, either, and no level takes more than --memory promises by default: three quarters of what is free.
The share counts seconds of processors, which other work on the machine lengthens little, and lets an interrupt take 2 s.
How memory grows it can't tell: what 1,000 objects take, some 30 MB, is less than by how much runs of the same level differ.
"""
import math
import multiprocessing
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
POWER = 1.2
LATEST = 0.3  # s
INTERRUPTED_ALSO = {1, 4}  # rows: the path tracer and the demo, too
LONGEST_OF = {1: 12.0}  # s, by row
UNCOUNTED = 64  # MB: pieces under 64 MiB are let through until they add up to as much (engine/core/memory_limit.h)


def make_in_a_process_of_its_own(level, **what):
    """What it takes would count as memory of the programs that are started afterwards (wait4's ru_maxrss)."""
    process = multiprocessing.Process(target=make_level.make, args=(level,), kwargs=what)
    process.start()
    process.join()
    assert process.exitcode == 0, process.exitcode


def start(tool, level, more):
    return subprocess.Popen([tool, "render", str(level), "-o", str(level.with_suffix(".png")), "--size", "64x36", "--warmup",
                             "0", "--frames", "1", *more], stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


def start_endless(folder, program, level):
    """The path tracer or the demo, which go on until somebody ends them."""
    out, size = str(level.with_suffix("")), ["--size", "64x36"]
    command = {"reference": ["sunfleck", "reference", str(level), "-o", out + ".exr", "--spp", "1000000"],
               "demo": ["sunfleck_demo", "--headless", "--scene", str(level), "-o", out, "--frames", "1000000"]}[program]
    return subprocess.Popen([str(folder / command[0]), *command[1:], *size], stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT)


def finish(process):
    """Its exit status, what it printed, the most memory that it had, in MB, and the seconds of processors that it took."""
    output = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, output, usage.ru_maxrss / 1024, usage.ru_utime + usage.ru_stime


def interrupt(process, seconds):
    """How long it goes on after an interrupt that comes after so many seconds; None where it was done by then."""
    time.sleep(seconds)
    sent = time.time()
    os.kill(process.pid, signal.SIGINT)  # send_signal would take the status of one that is done, and finish finds none
    status, output, *_ = finish(process)
    if status == 0:
        return None
    assert status == 128 + signal.SIGINT, (status, output[-300:])
    return time.time() - sent


def free_megabytes():
    with open("/proc/meminfo") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("MemAvailable")) / 1024


def grown(row, values, fixed=0.0):
    """How what a row takes beyond a fixed part grows from a smaller level on: the power of n; None without such a row.
    A tenth of the fixed part is taken for its own spread."""
    before, factor = GROWS_FROM.get(row, (None, None))
    if before not in values:
        return None
    return math.log(max(values[row] - 0.9 * fixed, 1e-9) / max(values[before] - 0.9 * fixed, 1e-9)) / math.log(factor)


SHARE = 1000, 2000  # objects
LATEST_BESIDE_OTHERS = 2.0  # s


def share(tool):
    """Exit status of the share."""
    took, problems = [], []
    with tempfile.TemporaryDirectory() as folder:
        for objects in (10, 10, *SHARE):  # the first compiles the shaders
            level = pathlib.Path(folder) / f"{objects}.glb"
            make_level.make(level, objects=objects)
            began, free = time.time(), free_megabytes()
            status, output, memory, seconds = finish(start(tool, level, ["--lights", "64"]))
            lasted = time.time() - began
            assert status == 0, output[-300:]
            took.append((seconds, memory, 0.75 * free))
        waited = interrupt(start(tool, level, ["--lights", "64"]), lasted / 2)
    _, (_, fixed, _), *large = took
    for objects, (seconds, memory, most) in zip(SHARE, large):
        print(f"{objects} objects: {seconds:.1f} s of processors, {memory:.0f} MB")
        if memory > most + fixed + UNCOUNTED:
            problems.append(f"{objects} objects take more memory than --memory promises, {most:.0f} MB")
    power = math.log(large[1][0] / large[0][0]) / math.log(SHARE[1] / SHARE[0])
    if power > POWER:
        problems.append(f"time grows as n^{power:.2f}")
    if waited is None or waited > LATEST_BESIDE_OTHERS:
        problems.append(f"an interrupt after {lasted / 2:.1f} s took {waited} s")
    print(f"time grows as n^{power:.2f}; {waited or 0:.2f} s to an interrupt")
    print("\n".join(problems))
    return 1 if problems else 0


def main():
    folder_of_programs = pathlib.Path(sys.argv[1]) / "bin"
    tool, wrong, times, memory = str(folder_of_programs / "sunfleck"), 0, {}, {}
    if sys.argv[2:] == ["share"]:
        return share(tool)
    first, last = (int(a) for a in sys.argv[2:4]) if len(sys.argv) > 3 else (1, len(LEVELS))
    print("| level | to the first picture, s | grows as | MB | grows as | an interrupt takes, s |\n|---|---|---|---|---|---|",
          flush=True)
    with tempfile.TemporaryDirectory() as folder:
        warm = pathlib.Path(folder) / "warm.glb"  # compiles the shaders
        make_level.make(warm, objects=10, movers=2)
        finish(start(tool, warm, []))
        fixed = finish(start(tool, warm, []))[2]
        for row in range(first - 1, last):
            name, what, more = LEVELS[row]
            level = pathlib.Path(folder) / f"{row}.glb"
            make_in_a_process_of_its_own(level, **what)
            begin, most = time.time(), 0.75 * free_megabytes() + fixed + UNCOUNTED
            status, output, memory[row], _ = finish(start(tool, level, more))
            times[row] = time.time() - begin
            if status != 0:
                wrong += 1
                del times[row], memory[row]
                print(f"| {name} | refused: {output.decode(errors='replace')[-200:]} | | | | |", flush=True)
                continue
            powers = grown(row, times), grown(row, memory, fixed)
            problems = [part for part, is_so in (("time", (powers[0] or 0) > POWER or times[row] > LONGEST_OF.get(row, 1e9)),
                                                 ("memory", (powers[1] or 0) > POWER or memory[row] > most)) if is_so]
            moments = [times[row] * (i + .5) / 8 for i in range(8)]
            waits = [interrupt(start(tool, level, more), moment) for moment in moments]
            if row in INTERRUPTED_ALSO:
                waits += [interrupt(start_endless(folder_of_programs, program, level), moment)
                          for program in ("reference", "demo") for moment in moments[::2]]
            waits = [wait for wait in waits if wait is not None]
            if max(waits, default=0) > LATEST:
                problems.append("interrupt")
            wrong += len(problems)
            shown = ["" if power is None else f"n^{power:.2f}" for power in powers]
            print(f"| {name} | {times[row]:.1f} | {shown[0]} | {memory[row]:.0f} | {shown[1]} | {max(waits, default=0):.2f} |"
                  + "".join(f" too much: {problem}" for problem in problems), flush=True)
            level.unlink()
    print(f"{last - first + 1} tried, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
