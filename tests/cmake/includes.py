#!/usr/bin/env python3
"""Includes go from runner to network to solver, and within a layer to folders named earlier in HOUSE; no two headers
define a type of the same name.

includes.py SOURCE_DIR prints violations. It first tests itself on planted sources with violations.
"""
import re
import sys
import tempfile
from pathlib import Path

HOUSE = [f"{layer}/{folder}" for layer, folders in {
    "solver": "numbers rod linear factor scene cg contact step guess plugin",
    "network": "graph layers encoding processor guess training",
    "runner": "text mpi inputs keys specs sweep job plan terminal dispatch file dataset training measure python command",
}.items() for folder in folders.split()]
LAYERS = tuple(dict.fromkeys(folder.split("/")[0] for folder in HOUSE))
INCLUDE = re.compile(r'\s*#\s*include\s*"([^"]+)"')
TYPE = re.compile(r"(?:class|struct|enum class) (\w+)[^;()]*(?:\{|$)")
WITHIN = re.compile(r"(?:(namespace)|\}  // namespace) (\w+)")


def sources(root):
    """(path below `root`, lines) of all sources of the layers."""
    for layer in LAYERS:
        for path in sorted((root / layer).rglob("*.[ch]pp")):
            yield path.relative_to(root).as_posix(), path.read_text(encoding="utf-8").splitlines()


def folder(path):
    return path.rpartition("/")[0]


def violations(root):
    known = {}
    for path, lines in sources(root):
        if folder(path) not in HOUSE:
            yield f"{path}: {folder(path)}/ is not in HOUSE"
            continue
        within = ""
        for number, line in enumerate(lines, 1):
            if changed := WITHIN.match(line):
                within = changed[2] + "::" if changed[1] else ""
            found = INCLUDE.match(line)
            if found and folder(found[1]) in HOUSE and HOUSE.index(folder(found[1])) > HOUSE.index(folder(path)):
                yield f"{path}:{number}: {folder(path)}/ must not include what comes after it: {found[1]}"
            if path.endswith(".hpp") and (named := TYPE.match(line)):
                first = known.setdefault(within + named[1], path)
                if first != path:
                    yield f"{path}:{number}: {first} has a type {named[1]} too"


def check_planted():
    planted = {
        "solver/rod/rod.hpp": '#include "solver/rod/other.hpp"\n#include <vector>\nnamespace rodsweep {\nstruct Place {\n',
        "solver/step/step.cpp": '#include "solver/rod/rod.hpp"\n#include "network/graph/graph.hpp"\nstruct Place {\n',
        "network/graph/graph.hpp": '#include "solver/step/step.hpp"\nclass Graph;\n',
        "runner/job/job.hpp": '#pragma once\n  #  include "runner/file/file.hpp"\n',
        "runner/file/file.hpp": 'namespace rodsweep {\nclass Place : public Graph {\n',
        "runner/file/other.hpp": 'namespace rodsweep {\nnamespace other {\nclass Place {\n',
        "runner/other/other.hpp": "",
    }
    with tempfile.TemporaryDirectory() as folder_name:
        for name, text in planted.items():
            path = Path(folder_name) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        lines = [line.split(": ")[0] for line in violations(Path(folder_name))]
    expected = ["solver/step/step.cpp:2", "runner/file/file.hpp:2", "runner/job/job.hpp:2", "runner/other/other.hpp"]
    assert lines == expected, lines


def main():
    check_planted()
    root = Path(sys.argv[1])
    found = {folder(path) for path, _ in sources(root)}
    assert set(HOUSE) <= found, f"{root} lacks {set(HOUSE) - found}"
    problems = list(violations(root))
    print("\n".join(problems) if problems else f"the {len(found)} folders include what comes before them")
    sys.exit(bool(problems))


if __name__ == "__main__":
    main()
