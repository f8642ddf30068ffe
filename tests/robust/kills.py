#!/usr/bin/env python3
"""Kills programs that write, at random moments, and looks at what they leave: old or new, never broken.

Usage: kills.py BUILD_FOLDER FIRST LAST     seeds; each is one kill, of what its number chooses
       kills.py BUILD_FOLDER share          one of each, as a part of every test run: with a long pass of 2 s, and however
                                            much work is lost, since the machine may have other work. The kinds:
  reference     of many passes, saved every 0.2 s: goes on to the same bits, and loses at most two intervals
  long pass     of one pass of about a minute, killed again and again and gone on with, by this run and the next; the
                picture is compared when it is done, at the latest after seed 300
  recording     of the demo, without a window: what was written plays
  scenes        the built-in scenes being saved over older ones: each that was there is there, and loads
  cache         of precomputed transfer, empty or from before: the next run takes or makes it, and draws the same picture
  settings      of the demo, which were changed in its window: the old ones or the new
  editor        its settings, likewise
Settings need Xvfb and xdotool; without them their seeds are left out, and it says so. What takes long to make is kept
in BUILD_FOLDER/robust/kills.
"""
import collections
import hashlib
import json
import math
import os
import pathlib
import random
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time

BUILD = pathlib.Path(sys.argv[1]).resolve()
TOOL, DEMO, EDITOR, SCENES = (str(BUILD / "bin" / name) for name in
                              ("sunfleck", "sunfleck_demo", "sunfleck_editor", "generate_scenes"))
INTERVAL = 0.2     # s, between saved states
SHARE = sys.argv[2:] == ["share"]
SLACK = math.inf if SHARE else 0.5    # s, of a machine with other work
LONG_PASS = 2 if SHARE else float(os.environ.get("SUNFLECK_LONG_PASS", 60))   # s, about
LAST_SEED = 7 if SHARE else 300


def bits(path):
    return hashlib.sha256(pathlib.Path(path).read_bytes()).hexdigest()


def wait_until(condition, seconds):
    end = time.time() + seconds
    while not condition():
        if time.time() > end:
            return False
        time.sleep(0.01)
    return True


def read_json(path):
    """None: it is not there, or broken."""
    try:
        return json.loads(pathlib.Path(path).read_text())
    except (OSError, ValueError):
        return None


def newest_state(folder):
    """When it was written; 0: there is none."""
    times = [0.0]
    for name in ("r.exr.state", "r.exr.state2"):
        try:
            times.append((folder / name).stat().st_mtime)
        except OSError:
            pass
    return max(times)


class Display:
    """A display of its own. None of it without Xvfb and xdotool."""
    def __init__(self):
        self.process = None
        if not shutil.which("Xvfb") or not shutil.which("xdotool"):
            return
        read, write = os.pipe()
        self.process = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1280x800x24", "-noreset",
                                         "-nolisten", "tcp"], pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        os.environ["DISPLAY"] = ":" + os.read(read, 16).decode().strip()

    def key(self, title, *keys):
        for one in keys:
            subprocess.run(["sh", "-c", f"W=$(xdotool search --onlyvisible --name '{title}' | tail -1); "
                            f"xdotool windowfocus $W key --delay 60 {one}"], stderr=subprocess.DEVNULL, check=False)

    def end(self):
        if self.process:
            self.process.terminate()
            self.process.wait()


def long_scene(path):
    """A box whose walls absorb a thousandth: paths of a thousand bounces."""
    data = (BUILD / "scenes/furnace.glb").read_bytes()
    size = struct.unpack("<I", data[12:16])[0]
    file = json.loads(data[20:20 + size])
    file["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = [.999, .999, .999, 1]
    text = json.dumps(file).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + size:]
    path.write_bytes(b"glTF" + struct.pack("<IIII", 2, 20 + len(text) + len(rest), len(text), 0x4e4f534a) + text + rest)


class Trials:
    def __init__(self, folder, display):
        self.folder, self.display, self.wholes = folder, display, {}
        self.counts = collections.defaultdict(lambda: dict.fromkeys(("tried", "killed", "finished first", "wrong"), 0))
        self.lost = collections.defaultdict(float)   # s of work that a kill took at most, by kind
        self.kept = folder / "kept" if SHARE else BUILD / "robust" / "kills"
        self.kept.mkdir(parents=True, exist_ok=True)

    def run(self, command, **options):
        return subprocess.run(command, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              check=False, **options)

    def start(self, command, **options):
        return subprocess.Popen(command, cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                **options)

    def kill(self, command, seconds, ready=None):
        """After so many seconds, from the moment on that the file `ready` is there. False: it had ended by then."""
        process = self.start(command)
        if ready:
            wait_until(lambda: (self.folder / ready).exists() or process.poll() is not None, 120)
        try:
            process.wait(seconds)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
        return process.wait() == -signal.SIGKILL

    def end(self, kind, right, killed, what):
        counts = self.counts[kind]
        counts["tried"] += 1
        counts["wrong" if not right else "killed" if killed else "finished first"] += 1
        if not right:
            print(f"WRONG, {kind}: {what}", flush=True)

    # The path tracer

    def whole_reference(self, folder, command):
        """Bits of the picture without a kill, how long it takes, when its first sample is traced, and the longest
        interval between states: saving takes 2 % of the time at most, so that those of large pictures are longer."""
        begin = time.time()
        process = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        saved = []
        while process.poll() is None:
            newest = newest_state(folder)
            if newest and (not saved or newest > saved[-1]):
                saved.append(newest)
            time.sleep(0.005)
        assert process.wait() == 0, command
        seconds = time.time() - begin
        loading = max(saved[0] - begin - INTERVAL, 0.0) if saved else seconds / 2
        interval = max([b - a for a, b in zip(saved, saved[1:])] + [INTERVAL])
        result = bits(folder / "r.exr"), seconds, loading, interval
        (folder / "r.exr").unlink()
        return result

    def kill_reference(self, folder, command, seconds, loading):
        """Whether it was killed, and how many seconds of samples are lost then."""
        begin = time.time()
        process = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            process.wait(seconds)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
        at = time.time()
        if process.wait() != -signal.SIGKILL:
            return False, 0.0
        newest = newest_state(folder)
        return True, max(at - (newest if newest >= begin else begin + loading), 0.0)

    def reference(self, rng, kind):
        command = [TOOL, "reference", "cornell", "--save-interval", str(INTERVAL), "-o", "r.exr", "--size", "96x72",
                   "--spp", "300"]
        if kind not in self.wholes:
            self.wholes[kind] = self.whole_reference(self.folder, command)
        expected, seconds, loading, interval = self.wholes[kind]
        killed, lost = self.kill_reference(self.folder, command, rng.random() * seconds, loading)
        states = list(self.folder.glob("r.exr.state*"))
        result = self.run(command)
        goes_on = "going on from" in result.stdout
        right = result.returncode == 0 and bits(self.folder / "r.exr") == expected and goes_on == bool(states)
        self.lost[kind] = max(self.lost[kind], lost)
        self.end(kind, right and lost <= 2 * interval + SLACK, killed, f"{lost:.2f} s lost: {result.stdout[-500:]}")

    def long_command(self, folder):
        """Its size is chosen, once for each build, so that the pass takes as long as it should."""
        known = read_json(folder / "pass.json")
        command = [TOOL, "reference", "long.glb", "--unlimited", "--spp", "1", "--save-interval", str(INTERVAL), "-o",
                   "r.exr", "--camera", "0.3,-0.2,0.4,0,0,0,60", "--size"]
        if known is None:
            folder.mkdir(exist_ok=True)
            long_scene(folder / "long.glb")
            _, seconds, loading, _ = self.whole_reference(folder, command + ["320x240"])
            scale = (LONG_PASS / max(seconds - loading, 0.1)) ** 0.5
            size = f"{max(int(320 * scale), 8)}x{max(int(240 * scale), 6)}"
            known = [size, *self.whole_reference(folder, command + [size])]
            (folder / "pass.json").write_text(json.dumps(known))
            print(f"long pass: {size}, {known[2]:.0f} s, a state every {known[4]:.1f} s", flush=True)
        return command + [known[0]], known[1], known[3], known[4]

    def long_pass(self, rng, kind):
        folder = self.kept / f"long-{LONG_PASS:g}-{bits(TOOL)[:16]}"
        command, expected, loading, interval = self.long_command(folder)
        killed, lost = self.kill_reference(folder, command, loading + 2.5 * interval * rng.random(), loading)
        right = killed or bits(folder / "r.exr") == expected
        if not killed:
            (folder / "r.exr").unlink()
        self.lost[kind] = max(self.lost[kind], lost)
        self.end(kind, right and lost <= 2 * interval + SLACK, killed, f"{lost:.2f} s lost, or other bits")

    def finish_long_pass(self):
        folder = self.kept / f"long-{LONG_PASS:g}-{bits(TOOL)[:16]}"
        if not list(folder.glob("r.exr.state*")):
            return
        command, expected, _, _ = self.long_command(folder)
        result = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                check=False)
        right = result.returncode == 0 and "going on from" in result.stdout and bits(folder / "r.exr") == expected
        (folder / "r.exr").unlink(missing_ok=True)
        print("long pass: the same bits in the end" if right else f"WRONG, long pass: {result.stdout[-500:]}")
        self.counts["long pass"]["wrong"] += not right

    # Other files

    def recording(self, rng, kind):
        record, options = "walk.rec", ["--headless", "--scene", "cornell", "--size", "16x16", "--pictures", "0"]
        killed = self.kill([DEMO, *options, "--frames", "100000", "--record", record, "-o", "out"], 3 * rng.random(),
                           record)
        result = self.run([DEMO, *options, "--input", record, "--frames", "2", "-o", "out"])
        empty = "no steps" in result.stdout or "empty" in result.stdout
        self.end(kind, killed and (result.returncode == 0 or empty), True, result.stdout[-500:])
        (self.folder / record).unlink()

    def scenes(self, rng, kind):
        scenes = self.folder / "scenes"
        if kind not in self.wholes:
            begin = time.time()
            assert self.run([SCENES, "scenes"]).returncode == 0
            self.wholes[kind] = time.time() - begin, sorted(name.name for name in scenes.glob("*.scene.json"))
        seconds, names = self.wholes[kind]
        killed = self.kill([SCENES, "scenes"], rng.random() * seconds)
        bad = [name for name in names if self.run([TOOL, "info", f"scenes/{name}"]).returncode != 0]
        self.end(kind, not bad, killed, f"gone or broken: {bad}")

    def cache(self, rng, kind):
        cache = self.folder / "cache"
        command = [TOOL, "render", "gap_room", "--movers", "prt", "--size", "32x18", "--lights", "16", "--warmup", "0",
                   "-o", "p.png"]
        if kind not in self.wholes:
            begin = time.time()
            assert self.run(command).returncode == 0
            self.wholes[kind] = bits(self.folder / "p.png"), time.time() - begin
        expected, seconds = self.wholes[kind]
        if rng.random() < .5:
            shutil.rmtree(cache, ignore_errors=True)
        elif rng.random() < .5:   # what is there cannot be used, and is made again
            for file in cache.rglob("*"):
                if file.is_file():
                    os.truncate(file, file.stat().st_size // 2)
        killed = self.kill(command, rng.random() * seconds)
        for file in cache.rglob("*.tmp"):
            assert file.name.startswith("."), file
        again, last = self.run(command), self.run(command)
        right = again.returncode == last.returncode == 0 and bits(self.folder / "p.png") == expected
        self.end(kind, right and "damaged" not in last.stdout, killed, again.stdout[-300:] + last.stdout[-300:])

    # Settings: the program is asked to end, and killed while it does

    def kill_at_end(self, process, rng):
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(0.12 * rng.random())
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
        return process.wait() == -signal.SIGKILL

    def settings(self, rng, kind):
        file, state = self.folder / "demo.json", self.folder / "state.json"
        state.unlink(missing_ok=True)
        if rng.random() < .3:
            file.unlink(missing_ok=True)
        before = read_json(file)
        process = self.start([DEMO, "--scene", "cornell", "--size", "96x54", "--preset", "software", "--settings", file.name,
                              "--state", state.name])
        shows = lambda screen: wait_until(lambda: (read_json(state) or {}).get("screen") == screen, 4)
        came = wait_until(lambda: (read_json(state) or {}).get("screen") == "title", 60)
        for _ in range(10):
            self.display.key("Lantern House", "Return")
            if shows("playing"):
                break
        self.display.key("Lantern House", "t")   # shows frame times, a setting
        time.sleep(1.0)
        killed = self.kill_at_end(process, rng)
        after = read_json(file)
        old = after == before if before else not file.exists()
        new = bool(after) and after["show_times"] != (before or {"show_times": False})["show_times"]
        self.end(kind, came and (old or new) and (killed or new), killed, f"{came}, {before} then {after}")

    def editor(self, rng, kind):
        file = self.folder / "editor.json"
        if rng.random() < .3:
            file.unlink(missing_ok=True)
        before = read_json(file)
        size = f"{800 + int(rng.random() * 200)}x600"
        widgets = self.folder / "widgets.json"
        widgets.unlink(missing_ok=True)
        process = self.start([EDITOR, "--size", size, "--settings", file.name, "--widgets", widgets.name])
        came = wait_until(widgets.exists, 60)
        killed = self.kill_at_end(process, rng)
        after = read_json(file)
        old = after == before if before else not file.exists()
        new = bool(after) and f"{after['width']}x{after['height']}" == size
        self.end(kind, came and (old or new) and (killed or new), killed, f"{came}, {before} then {after}")


def main():
    first, last = (1, LAST_SEED) if SHARE else (int(sys.argv[2]), int(sys.argv[3]))
    display = Display()
    with tempfile.TemporaryDirectory() as folder:
        os.environ.update(XDG_CONFIG_HOME=folder, XDG_DATA_HOME=folder, XDG_CACHE_HOME=folder + "/cache",
                          ALSOFT_DRIVERS="null")
        trials = Trials(pathlib.Path(folder), display)
        kinds = [("reference", trials.reference), ("long pass", trials.long_pass), ("recording", trials.recording),
                 ("scenes", trials.scenes), ("cache", trials.cache), ("settings", trials.settings),
                 ("editor", trials.editor)]
        left_out = 0
        try:
            for seed in range(first, last + 1):
                name, trial = kinds[seed % len(kinds)]
                if trial in (trials.settings, trials.editor) and display.process is None:
                    left_out += 1
                    continue
                trial(random.Random(seed), name)
            if last >= LAST_SEED:
                trials.finish_long_pass()
        finally:
            display.end()
        sums = collections.Counter()
        for name, counts in trials.counts.items():
            sums.update(counts)
            print(f"| {name} | " + " | ".join(str(count) for count in counts.values()) + " |")
        if left_out:
            print(f"{left_out} of settings were left out: Xvfb or xdotool is not installed")
        print(f"{sums['tried']} tried, {sums['killed']} killed, {sums['finished first']} finished first, "
              f"{sums['wrong']} wrong", *(f"; a kill took {most:.2f} s of {name} at most" for name, most in trials.lost.items()),
              sep="", flush=True)
        return 1 if sums["wrong"] else 0


if __name__ == "__main__":
    sys.exit(main())
