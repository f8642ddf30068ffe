#!/usr/bin/env python3
"""Kills programs that write, at random moments, and looks at what they leave: old or new, never broken.

Usage: kills.py BUILD_FOLDER FIRST LAST     seeds; each is one kill, of what its number chooses:
  reference     of many passes, saved every 0.2 s: goes on to the same bits, and loses at most two intervals
  long pass     of one pass, likewise
  recording     of the demo, without a window: what was written plays
  scenes        the built-in scenes being saved: each that is there loads
  cache         of precomputed transfer: the next run takes or makes it, and draws the same picture
"""
import hashlib
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

BUILD = pathlib.Path(sys.argv[1]).resolve()
TOOL, DEMO, SCENES = (str(BUILD / "bin" / name) for name in ("sunfleck", "sunfleck_demo", "generate_scenes"))
INTERVAL = 0.2  # s, between saved states


def bits(path):
    return hashlib.sha256(pathlib.Path(path).read_bytes()).hexdigest()


class Trials:
    def __init__(self, folder):
        self.folder, self.wholes = folder, {}
        self.counts = {"tried": 0, "old": 0, "new": 0, "wrong": 0}
        self.oldest = 0.0  # s, between the last state and the kill

    def run(self, command, **options):
        return subprocess.run(command, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              **options)

    def kill(self, command, seconds, ready=None):
        """After so many seconds, from the moment on that the file `ready` is there. False: it had ended by then."""
        process = subprocess.Popen(command, cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while ready and not (self.folder / ready).exists() and process.poll() is None:
            time.sleep(0.005)
        try:
            process.wait(seconds)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
        return process.wait() == -signal.SIGKILL

    def whole(self, name, command, output):
        """Bits of what the command makes without a kill, and how long it takes."""
        if name not in self.wholes:
            begin = time.time()
            result = self.run(command)
            assert result.returncode == 0, result.stdout
            self.wholes[name] = bits(self.folder / output), time.time() - begin
            (self.folder / output).unlink()
        return self.wholes[name]

    def end(self, right, is_new, what):
        self.counts["tried"] += 1
        self.counts["wrong" if not right else "new" if is_new else "old"] += 1
        if not right:
            print("WRONG:", what, flush=True)

    def reference(self, rng, options):
        command = [TOOL, "reference", "cornell", "--save-interval", str(INTERVAL), "-o", "r.exr"] + options
        expected, seconds = self.whole("reference" + options[-1], command, "r.exr")
        for state in self.folder.glob("r.exr*"):
            state.unlink()
        killed = self.kill(command, rng.random() * seconds)
        states = list(self.folder.glob("r.exr.state*"))
        if killed and states:
            self.oldest = max(self.oldest, time.time() - max(s.stat().st_mtime for s in states))
        result = self.run(command)
        goes_on = "going on from" in result.stdout
        right = result.returncode == 0 and bits(self.folder / "r.exr") == expected and goes_on == (killed and bool(states))
        self.end(right, not killed, f"{options}: {result.stdout[-500:]}")

    def recording(self, rng):
        record, options = "walk.rec", ["--headless", "--scene", "cornell", "--size", "16x16", "--pictures", "0"]
        killed = self.kill([DEMO, *options, "--frames", "100000", "--record", record, "-o", "out"], 3 * rng.random(), record)
        result = self.run([DEMO, *options, "--input", record, "--frames", "2", "-o", "out"])
        empty = "no steps" in result.stdout or "empty" in result.stdout
        self.end(killed and (result.returncode == 0 or empty), True, result.stdout[-500:])
        (self.folder / record).unlink()

    def scenes(self, rng):
        if "scenes" not in self.wholes:
            begin = time.time()
            assert self.run([SCENES, "scenes"]).returncode == 0
            self.wholes["scenes"] = time.time() - begin
        killed = self.kill([SCENES, "scenes"], rng.random() * self.wholes["scenes"])
        bad = [name.name for name in sorted((self.folder / "scenes").glob("*.scene.json"))
               if self.run([TOOL, "info", str(name)]).returncode != 0]
        self.end(not bad, not killed, bad)

    def cache(self, rng):
        environment = dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"))
        command = [TOOL, "render", "gap_room", "--movers", "prt", "--size", "32x18", "--lights", "16", "--warmup", "0",
                   "-o", "p.png"]
        os.environ.update(environment)
        shutil.rmtree(self.folder / "cache", ignore_errors=True)
        expected, seconds = self.whole("cache", command, "p.png")
        if rng.random() < .5:
            shutil.rmtree(self.folder / "cache", ignore_errors=True)
        killed = self.kill(command, rng.random() * seconds)
        result = self.run(command)
        self.end(result.returncode == 0 and bits(self.folder / "p.png") == expected and "damaged" not in result.stdout,
                 not killed, result.stdout[-500:])


def main():
    first, last = int(sys.argv[2]), int(sys.argv[3])
    with tempfile.TemporaryDirectory() as folder:
        trials = Trials(pathlib.Path(folder))
        many = ["--size", "96x72", "--spp", "300"]
        kinds = [("reference", lambda rng: trials.reference(rng, many)),
                 ("long pass", lambda rng: trials.reference(rng, ["--unlimited", "--size", "960x720", "--spp", "1"])),
                 ("recording", trials.recording), ("scenes", trials.scenes), ("cache", trials.cache)]
        for seed in range(first, last + 1):
            name, trial = kinds[seed % len(kinds)]
            trial(random.Random(seed))
        counts = trials.counts
        print(f"{counts['tried']} tried, {counts['old']} killed, {counts['new']} finished first, {counts['wrong']} wrong; "
              f"the oldest state was {trials.oldest:.2f} s old", flush=True)
        return 1 if counts["wrong"] or trials.oldest > 2 * INTERVAL + 0.5 else 0


if __name__ == "__main__":
    sys.exit(main())
