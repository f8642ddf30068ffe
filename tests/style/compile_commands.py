#!/usr/bin/env python3
"""A compilation database for tools that look at single files.

Files that are compiled in batches (cmake/SunfleckBatches.cmake) get commands of their own, and g++'s precompiled
headers, which are nothing to clang, are left out: without them each file must include what it uses.
Usage: compile_commands.py COMPILE_COMMANDS.json
"""
import json
import pathlib
import re
import sys

root = pathlib.Path(__file__).resolve().parents[2]
entries = []
for entry in json.load(open(sys.argv[1])):
    command = re.sub(r" -Winvalid-pch -include \S+cmake_pch\.hxx ", " ", entry["command"])
    batch = pathlib.Path(entry["file"])
    files = [entry["file"]]
    if batch.parent.name == "batches":
        files = [str(root / name) for name in re.findall(r'^#include "(.*)"$', batch.read_text(), re.M)]
    entries += [dict(entry, file=file, command=command.replace(entry["file"], file)) for file in files]
json.dump(entries, sys.stdout)
