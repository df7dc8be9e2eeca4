#!/usr/bin/python3
"""Are the numbers of a text still those of its tables?

    analysis/results/check.py README.md
    analysis/results/check.py --update README.md

Behind a number a comment may say where it is from, which no reader sees:

    pod leaves .10<!--= spatial_bending; CG ratio; Bending rod; pod 10; 1e-2 -->

the table (a .txt beside the text), how its section begins, how its block begins, the row, and the column, or `2` for the
second number of a cell such as "0.10 [0.09, 0.11]" after a last semicolon. A section of `*` is any. The number has to be
the cell's, rounded as the text has it. Those that part are printed, and the exit code is 1; --update puts the tables'
numbers in their place, as many digits as before, for somebody to read the sentences around them again: what is bold, and
what is said to be less, no script knows.
"""

import os
import re
import sys
from dataclasses import dataclass

SOURCE = re.compile(r"<!--= (.*?) -->", re.S)
NUMBER = re.compile(r"[−-]?(?:\d[\d,]*\.?\d*|\.\d+)(?:e[+−-]?\d+)?")


class NotFound(Exception):
    """With what was looked for."""


@dataclass(frozen=True)
class Cell:
    text: str
    end: int    # column of the line behind it


def cells_of(line):
    return [Cell(found.group(), found.end()) for found in re.finditer(r"\S+(?: \S+)*", line)]


def find_cell(lines, section, block, row, column):
    """The text of a cell. Columns are to the right: that of a header's cell ends where the row's does."""
    start = _first(lines, 0, section, f"a section {section!r}") if section != "*" else 0
    start = _first(lines, start, block, f"a block {block!r}")
    header = start if any(cell.text == column for cell in cells_of(lines[start])) else start + 1
    ends = [cell.end for cell in cells_of(lines[header]) if cell.text == column]
    if not ends:
        raise NotFound(f"a column {column!r}")
    for line in lines[header + 1:]:
        if not line.strip():
            break
        cells = cells_of(line)
        if cells[0].text == row:
            found = [cell.text for cell in cells[1:] if cell.end == ends[0]]
            if found:
                return found[0]
    raise NotFound(f"a row {row!r}")


def _first(lines, start, words, what):
    for k in range(start, len(lines)):
        if lines[k].lstrip().startswith(words):
            return k
    raise NotFound(what)


def number_of(text):
    return float(text.replace("−", "-").replace(",", ""))


def half_unit(text):
    """Half of one in the last digit."""
    mantissa, _, exponent = text.lower().partition("e")
    digits = len(mantissa.partition(".")[2])
    return 0.5 * 10.0 ** (int(exponent.replace("−", "-") or 0) - digits)


def as_said(number, said):
    """A table's number with the digits and in the style of another."""
    mantissa, exponent, _ = said.lower().partition("e")
    digits, value = len(mantissa.partition(".")[2]), number_of(number)
    if exponent:
        text = re.sub(r"e([+-])0*(\d)", lambda e: "e" + e.group(1).replace("+", "") + e.group(2), f"{value:.{digits}e}")
    else:
        text = f"{value:,.{digits}f}" if "," in said else f"{value:.{digits}f}"
    if mantissa.lstrip("-−").startswith("."):
        text = re.sub(r"^(-?)0\.", r"\1.", text)
    return text.replace("-", "−") if "−" in said else text


def check(path, update=False):
    """One line for every number that is not its table's, and that number put in its place on request."""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    tables, wrong, mended, done = {}, [], [], 0
    for marker in SOURCE.finditer(text):
        place = f"{path}:{text.count(chr(10), 0, marker.start()) + 1}"
        name, section, block, row, column, *rest = [part.strip() for part in marker.group(1).split(";")]
        before = re.search(rf"({NUMBER.pattern})[*_]*$", text[:marker.start()])
        if not before:
            wrong.append(f"{place}: no number before {marker.group()}")
            continue
        if name not in tables:
            with open(os.path.join(os.path.dirname(path), f"{name}.txt"), encoding="utf-8") as file:
                tables[name] = file.read().splitlines()
        try:
            cell = find_cell(tables[name], section, block, row, column)
            found = NUMBER.findall(cell)[int(rest[0]) - 1 if rest else 0]
        except NotFound as missing:
            wrong.append(f"{place}: {name}.txt has not {missing} of {marker.group(1)!r}")
            continue
        said = before.group(1)
        if abs(number_of(said) - number_of(found)) > 1.001 * half_unit(said) + 1e-12:
            wrong.append(f"{place}: {said}, but {found} in {name}.txt: {marker.group(1)}")
            mended += [text[done:before.start(1)], as_said(found, said)]
            done = before.end(1)
    if update and mended:
        with open(path, "w", encoding="utf-8") as file:
            file.write("".join([*mended, text[done:]]))
    return wrong


if __name__ == "__main__":
    wants_update = "--update" in sys.argv[1:]
    parted = [line for path in sys.argv[1:] if path != "--update" for line in check(path, wants_update)]
    print("\n".join(parted) or "all numbers are those of their tables")
    sys.exit(1 if parted else 0)
