#!/usr/bin/python3
"""Are the numbers of a text still those of its tables?

    analysis/results/check.py README.md
    analysis/results/check.py --update README.md

Behind a number a comment may say where it is from, which no reader sees:

    pod leaves .10<!--= spatial_bending; CG ratio; Bending rod; pod 10; 1e-2 -->

the table (a .txt beside the text), how its section begins, how its block begins, the row, and the column, or `2` for the
second number of a cell such as "0.10 [0.09, 0.11]" after a last semicolon. A section of `*` is any. Of a whole table the
comment stands in the line before, with what differs in braces, and rows and columns may say what they are called there:

    <!--== learned_rods; CG ratio, first; {row}; {column} -->
    | 1e-2, 1e-3 | pod 10<!--@ pod 10; 1e-2, 1e-3 --> | large, 1e-2<!--@ copingnet rods-large; 1e-2 --> |
    |---|---|---|
    | bending rods<!--@ Bending rod --> | .07 **.19** | .02 |

A | in a comment within a table is \\|, since a cell ends at any other. A cell has as many numbers as columns are named
last, any of them with its interval behind it, [0.09, 0.11], or none; what is in `backticks` is no number. A column that
is called `-` is not looked at. The number has to be the cell's, rounded as the text has it. Those that part are printed,
and the exit code is 1; --update puts the tables' numbers in their place, as many digits as before, for somebody to read
the sentences around them again: what is bold, and what is said to be less, no script knows.
"""

import os
import re
import sys
from dataclasses import dataclass

NUMBER = re.compile(r"[−-]?(?:\d[\d,]*\.?\d*|\.\d+)(?:e[+−-]?\d+)?")
SOURCE = re.compile(r"<!--= (.*?) -->", re.S)
TABLE = re.compile(r"^<!--== (.*?) -->\n((?:\|.*\n)+)", re.M)
NAMED = re.compile(r"<!--@ (.*?) -->")
BAR = re.compile(r"(?<!\\)\|")
WITH_INTERVAL = re.compile(rf"({NUMBER.pattern})[*_]*(?:\s*\[({NUMBER.pattern}), ({NUMBER.pattern})\])?")


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
    above = start  # blocks may share a header above them
    while above > 0 and lines[above - 1].strip():
        above -= 1
    for header in (start, *range(start + 1, min(start + 2, len(lines))), *range(above, start)):
        ends = [cell.end for cell in cells_of(lines[header]) if cell.text == column]
        if ends:
            break
    else:
        raise NotFound(f"a column {column!r}")
    for line in lines[max(start, header) + 1:]:
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


@dataclass(frozen=True)
class Said:
    """A number of the text and where it is from; without a number, what is wrong."""
    begin: int
    end: int
    source: str


def said_alone(text):
    """Numbers with a comment behind them."""
    for marker in SOURCE.finditer(text):
        before = re.search(rf"({NUMBER.pattern})[*_]*$", text[:marker.start()])
        if before:
            yield Said(*before.span(1), marker.group(1).replace("\\|", "|"))
        else:
            yield Said(marker.start(), marker.start(), f"no number before {marker.group()}")


def said_in_tables(text):
    """Numbers of tables with a comment before them."""
    for table in TABLE.finditer(text):
        template, begin, names = table.group(1), table.start(2), None
        for number, line in enumerate(table.group(2).splitlines()):
            cells, at = [], begin + 1
            for cell in BAR.split(line[1:].rstrip().removesuffix("|")):
                cells.append((cell, at))
                at += len(cell) + 1
            begin += len(line) + 1
            if number == 0:
                names = [called(cell) for cell, _ in cells]
            if number < 2:
                continue
            row = called(cells[0][0])
            for column, (cell, at) in zip(names[1:], cells[1:]):
                if column == "-":
                    continue
                *where, columns = template.replace("{column}", column).replace("{row}", row).split(";")
                words = re.sub(r"`[^`]*`", lambda quoted: " " * len(quoted.group()), cell)
                numbers, parts = list(WITH_INTERVAL.finditer(words)), columns.split(",")
                if numbers and len(numbers) != len(parts):
                    yield Said(at, at, f"{len(numbers)} numbers for {len(parts)} columns in {cell.strip()!r}")
                    continue
                for found, part in zip(numbers, parts):
                    for which, end in (group for group in ((1, ""), (2, "; 2"), (3, "; 3")) if found.group(group[0])):
                        yield Said(at + found.start(which), at + found.end(which), ";".join([*where, part]) + end)


def called(cell):
    """What a row or column is called in its table."""
    named = NAMED.search(cell)
    return named.group(1).replace("\\|", "|") if named else re.sub(r"[*`_]", "", cell).strip()


def check(path, update=False):
    """One line for every number that is not its table's, and that number put in its place on request."""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    tables, wrong, mended, done = {}, [], [], 0
    for one in sorted([*said_alone(text), *said_in_tables(text)], key=lambda one: one.begin):
        place = f"{path}:{text.count(chr(10), 0, one.begin) + 1}"
        if one.begin == one.end:
            wrong.append(f"{place}: {one.source}")
            continue
        name, section, block, row, column, *rest = [part.strip() for part in one.source.split(";")]
        if name not in tables:
            with open(os.path.join(os.path.dirname(path), f"{name}.txt"), encoding="utf-8") as file:
                tables[name] = file.read().splitlines()
        try:
            cell = find_cell(tables[name], section, block, row, column)
            found = NUMBER.findall(cell)[int(rest[0]) - 1 if rest else 0]
        except NotFound as missing:
            wrong.append(f"{place}: {name}.txt has not {missing} of {one.source!r}")
            continue
        said = text[one.begin:one.end]
        if abs(number_of(said) - number_of(found)) > 1.001 * half_unit(said) + 1e-12:
            wrong.append(f"{place}: {said}, but {found} in {name}.txt: {one.source}")
            mended += [text[done:one.begin], as_said(found, said)]
            done = one.end
    if update and mended:
        with open(path, "w", encoding="utf-8") as file:
            file.write("".join([*mended, text[done:]]))
    return wrong


if __name__ == "__main__":
    wants_update = "--update" in sys.argv[1:]
    parted = [line for path in sys.argv[1:] if path != "--update" for line in check(path, wants_update)]
    print("\n".join(parted) or "all numbers are those of their tables")
    sys.exit(1 if parted else 0)
