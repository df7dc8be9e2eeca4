#!/usr/bin/env python3
"""Includes go from runner to network to solver; folders within a layer include each other without cycles.

includes.py SOURCE_DIR reads every #include of the three layers and prints violations. It first tests itself on planted
sources with violations.
"""
import re
import sys
import tempfile
from pathlib import Path

LAYERS = ("solver", "network", "runner")  # each may include those before it
INCLUDE = re.compile(r'\s*#\s*include\s*"([^"]+)"')


def includes(root):
    """(file, line number, included file), as paths below `root`, of all includes within the layers."""
    for layer in LAYERS:
        for path in sorted((root / layer).rglob("*.[ch]pp")):
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                found = INCLUDE.match(line)
                if found and found[1].split("/")[0] in LAYERS:
                    yield path.relative_to(root).as_posix(), number, found[1]


def folder(path):
    return path.rpartition("/")[0]


def reachable(edges, start):
    seen, ahead = set(), [start]
    while ahead:
        for target in edges.get(ahead.pop(), ()):
            if target not in seen:
                seen.add(target)
                ahead.append(target)
    return seen


def violations(root):
    found = list(includes(root))
    edges = {}
    for path, _, target in found:
        if folder(path) != folder(target):
            edges.setdefault(folder(path), set()).add(folder(target))
    onward = {start: reachable(edges, start) for start in edges}
    for path, number, target in found:
        here, there = folder(path), folder(target)
        layer, other = here.split("/")[0], there.split("/")[0]
        if LAYERS.index(layer) < LAYERS.index(other):
            yield f"{path}:{number}: {layer}/ must not include {other}/: {target}"
        elif layer == other and here != there and here in onward.get(there, ()):
            yield f"{path}:{number}: closes a circle, since {there}/ needs {here}/ too: {target}"


def check_planted():
    planted = {
        "solver/rod/rod.hpp": '#include "solver/rod/other.hpp"\n#include <vector>\n',
        "solver/step/step.cpp": '#include "solver/rod/rod.hpp"\n#include "network/graph/graph.hpp"\n',
        "network/graph/graph.hpp": '#include "solver/step/step.hpp"\n',
        "runner/job/job.hpp": '#pragma once\n#include "runner/file/file.hpp"\n',
        "runner/file/file.hpp": '#include "runner/mpi/mpi.hpp"\n',
        "runner/mpi/mpi.hpp": '  #  include "runner/job/job.hpp"\n',
    }
    with tempfile.TemporaryDirectory() as folder_name:
        for name, text in planted.items():
            path = Path(folder_name) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        lines = [line.split(": ")[0] for line in violations(Path(folder_name))]
    expected = ["solver/step/step.cpp:2", "runner/file/file.hpp:1", "runner/job/job.hpp:2", "runner/mpi/mpi.hpp:1"]
    assert lines == expected, lines


def main():
    check_planted()
    root = Path(sys.argv[1])
    found = list(includes(root))
    assert {path.split("/")[0] for path, _, _ in found} == set(LAYERS), f"{root} is not the source folder"
    for layer in LAYERS:
        flat = sorted(path.name for path in (root / layer).glob("*.[ch]pp"))
        assert not flat, f"{layer}/ has folders for its sources: {', '.join(flat)}"
    problems = list(violations(root))
    print("\n".join(problems) if problems else f"{len(found)} includes run one way, without circles")
    sys.exit(bool(problems))


if __name__ == "__main__":
    main()
