#!/usr/bin/env python3
"""Sizes of functions and files, folder by folder, against the project's limits.

Usage: sizes.py [--longest N]
  --longest N  print the N longest functions, too

A function counts from its first line (with its template line) to its closing brace; lambdas and local classes count
into the function that they are in. Exits 1 where a limit is broken.
"""
import argparse
import bisect
import os
import re
import sys

FOLDERS = ["assets", "editor", "engine", "game_demo", "gi_module", "tests", "viewer"]
WITH_SUBFOLDERS = ["engine", "gi_module"]
CODE = (".cpp", ".h")
SHADERS = (".comp", ".vert", ".frag", ".glsl")
MAX_FILE_LINES = 400
MAX_FUNCTION_LINES = 70
MAX_PERCENTILE_LINES = 30
MAX_PARAMETERS = 6
LEAST_FUNCTIONS = 20  # of a folder with a 90th percentile; of fewer it would be just the longest but one
ROOT = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../.."))

# Comments, literals and preprocessor lines, in the order in which a compiler would see them.
NOISE = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"(?P<mark>[^(\s]*)\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"'
    r"|(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])+'|^[ \t]*#(?:[^\n\\]|\\.)*", re.S | re.M)
CONTAINER = re.compile(r"\b(namespace|class|struct|union|enum|extern)\b")
AFTER_PARAMETERS = re.compile(r"\s*(?:(?:const|noexcept|override|final|mutable|try|&&?)\s*)*(?:$|->|:(?!:))")


def blank_noise(text):
    """The text with noise replaced by spaces, so that places stay as they are."""
    def blank(match):
        kept = '""' if match[0][0] in "\"'R" else ""  # a literal stays something
        return kept + re.sub(r"[^\n]", " ", match[0][len(kept):])
    return NOISE.sub(blank, text)


def without_template(header):
    """Removes `template <...>` prefixes, whose `class` and commas mean nothing here."""
    while True:
        match = re.match(r"\s*template\s*<", header)
        if not match:
            return header
        depth, at = 1, match.end()
        while depth and at < len(header):
            depth += {"<": 1, ">": -1}.get(header[at], 0)
            at += 1
        header = header[at:]


def parameter_list(header):
    """(name, parameters, what follows them) of a function's header, or None."""
    for match in re.finditer(r"(operator\s*\(\s*\)|operator\s*[^\s\w(]+|[~\w:]+)\s*\(", header):
        depth, at = 1, match.end()
        while depth and at < len(header):
            depth += {"(": 1, ")": -1}.get(header[at], 0)
            at += 1
        if depth == 0 and AFTER_PARAMETERS.match(header, at):
            return match[1], header[match.end():at - 1], header[at:]
    return None


def count_parameters(parameters):
    if parameters.strip() in ("", "void"):
        return 0
    depth, count = 0, 1
    for c in parameters:
        depth += (c in "(<[{") - (c in ")>]}")
        count += c == "," and depth == 0
    return count


def matching_brace(text, at):
    depth = 0
    for match in re.compile(r"[{}]").finditer(text, at):
        depth += 1 if match[0] == "{" else -1
        if depth == 0:
            return match.start()
    return len(text) - 1


def functions_of(text):
    """Yields (name, lines, parameters, line) of each function with a body."""
    code = blank_noise(text)
    starts = [0] + [match.end() for match in re.finditer("\n", code)]
    begin = at = 0  # of the header; of what is looked at
    while True:
        match = re.compile(r"[{};]").search(code, at)
        if not match:
            return
        at = match.end()
        if match[0] != "{":
            begin = at
            continue
        header = re.sub(r"\b(public|private|protected)\s*:(?!:)", lambda m: " " * len(m[0]), code[begin:match.start()])
        bare = without_template(header)
        found = None if "=" in re.sub(r"operator\s*\S+|\([^()]*\)|[=!<>]=", "", bare) else parameter_list(bare)
        if not found:
            if not CONTAINER.search(bare):  # an initialiser: on to the end of the statement
                at = matching_brace(code, match.start()) + 1
                continue
            begin = at
            continue
        name, parameters, rest = found
        end = matching_brace(code, match.start())
        if re.match(r"[^{]*(?<!:):(?!:)", rest) and re.search(r"[\w>]\s*$", rest):  # member initialiser `x{...}`
            at = end + 1
            continue
        first = bisect.bisect(starts, begin + len(header) - len(header.lstrip()))
        if re.fullmatch(r"TEST(_F|_P)?", name):
            name, parameters = ".".join(part.strip() for part in parameters.split(",")), ""
        if re.search(r"\boverride\b", rest):
            parameters = ""  # its base's, which may be a library's
        yield name, bisect.bisect(starts, end) - first + 1, count_parameters(parameters), first
        begin = at = end + 1


def percentile(values, share):
    values = sorted(values)
    return values[min(len(values) - 1, int(share * len(values)))] if values else 0


class Folder:
    def __init__(self):
        self.functions, self.files = [], []


def read_sources():
    rows = {}
    for top in FOLDERS:
        for folder, folders, names in os.walk(os.path.join(ROOT, top)):
            folders.sort()
            path = os.path.relpath(folder, ROOT)
            parts = path.split(os.sep)
            keys = [top] + (["/".join(parts[:2])] if top in WITH_SUBFOLDERS and len(parts) > 1 else [])
            for name in sorted(names):
                if not name.endswith(CODE + SHADERS):
                    continue
                file = path.replace(os.sep, "/") + "/" + name
                with open(os.path.join(ROOT, file), encoding="utf-8") as stream:
                    text = stream.read()
                functions = list(functions_of(text)) if name.endswith(CODE) else []
                for key in keys:
                    row = rows.setdefault(key, Folder())
                    row.files.append((file, text.count("\n")))
                    row.functions += [(file,) + function for function in functions]
    return rows


def print_table(rows):
    print(f"{'folder':28}{'functions':>10}{'median':>8}{'90 %':>6}{'longest':>9}{'>6 param.':>10}"
          f"{'files':>7}{'median':>8}{'90 %':>6}{'longest':>9}")
    for key in sorted(rows):
        lines = [function[2] for function in rows[key].functions]
        files = [count for _, count in rows[key].files]
        many = sum(function[3] > MAX_PARAMETERS for function in rows[key].functions)
        name = "  " + key.split("/", 1)[1] if "/" in key else key
        print(f"{name:28}{len(lines):10}{percentile(lines, 0.5):8}{percentile(lines, 0.9):6}{max(lines, default=0):9}"
              f"{many:10}{len(files):7}{percentile(files, 0.5):8}{percentile(files, 0.9):6}{max(files, default=0):9}")


def find_offenders(rows):
    """What breaks a limit, and why."""
    offenders = {}
    for key, row in rows.items():
        share = percentile([function[2] for function in row.functions], 0.9)
        if share > MAX_PERCENTILE_LINES and len(row.functions) >= LEAST_FUNCTIONS:
            offenders[key] = f"90th percentile of functions is {share} lines"
        for file, count in row.files:
            if count > MAX_FILE_LINES:
                offenders[file] = f"{count} lines"
        for file, name, lines, parameters, first in row.functions:
            if lines > MAX_FUNCTION_LINES:
                offenders[f"{file}:{name}"] = f"{lines} lines (line {first})"
            elif parameters > MAX_PARAMETERS:
                offenders[f"{file}:{name}"] = f"{parameters} parameters (line {first})"
    return offenders


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--longest", type=int, default=0)
    arguments = parser.parse_args()
    rows = read_sources()
    print_table(rows)
    longest = [f for key, row in rows.items() if "/" not in key for f in row.functions]
    for file, name, lines, _, first in sorted(longest, key=lambda f: -f[2])[:arguments.longest]:
        print(f"{lines:5}  {file}:{first} {name}")
    offenders = find_offenders(rows)
    for place, why in sorted(offenders.items()):
        print(f"too large: {place}: {why}")
    sys.exit(1 if offenders else 0)


if __name__ == "__main__":
    main()
