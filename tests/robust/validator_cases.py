#!/usr/bin/env python3
"""glTF-Validator's own test files, each read and rendered. They are not part of this project: give it a folder with them,
such as `test` of github.com/KhronosGroup/glTF-Validator. Beside each file lies what the validator says of it
(NAME.report.json).

Usage: validator_cases.py BUILD_FOLDER FOLDER [FIRST LAST]     of the files in order of their names; default: all
Prints those valid files that are refused, and with --all every file, with what was said.
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile


def verdict(build, file, folder):
    """What render makes of it: rendered or refused, and its notes."""
    command = [str(build / "bin/sunfleck"), "render", str(file), "-o", str(folder / "p.png"), "--size", "16x9", "--lights",
               "8", "--warmup", "0", "--frames", "1"]
    try:
        run = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
                             timeout=60)
    except subprocess.TimeoutExpired:
        return "hung", ""
    lines = [line for line in run.stdout.splitlines() if "error:" in line or "warning:" in line]
    said = "; ".join(lines)
    left = [name for name in os.listdir(folder) if name != "p.png"]
    if run.returncode == 0 and not left:
        return "rendered", said
    if run.returncode == 1 and "error:" in said and not left and not (folder / "p.png").exists():
        return "refused", said
    return f"wrong: exit {run.returncode}, {left}", run.stdout[-300:]


def main():
    arguments = [a for a in sys.argv[1:] if a != "--all"]
    build, root = pathlib.Path(arguments[0]).resolve(), pathlib.Path(arguments[1]).resolve()
    files = sorted(file for kind in ("*.gltf", "*.glb") for file in root.rglob(kind))
    first, last = (int(a) for a in arguments[2:4]) if len(arguments) > 3 else (1, len(files))
    counts = {}
    for file in files[first - 1:last]:
        report = file.with_name(file.name + ".report.json")
        errors = json.loads(report.read_text())["issues"]["numErrors"] if report.exists() else 0
        kind = "valid" if errors == 0 else "invalid"
        with tempfile.TemporaryDirectory() as folder:
            outcome, said = verdict(build, file, pathlib.Path(folder))
        key = kind, outcome if outcome in ("rendered", "refused") else "wrong"
        if key == ("invalid", "rendered") and said:
            key = "invalid", "rendered, with a note of what was left out"
        counts[key] = counts.get(key, 0) + 1
        if "--all" in sys.argv or key in (("valid", "refused"), (kind, "wrong")):
            print(f"{kind}, {outcome}: {file.relative_to(root)}: {said}", flush=True)
    print(f"{sum(counts.values())} tried:", ", ".join(f"{n} {kind} {what}" for (kind, what), n in sorted(counts.items())))
    return 1 if any(what == "wrong" for _, what in counts) else 0


if __name__ == "__main__":
    sys.exit(main())
