#!/usr/bin/python3
"""Writes the pages with measured numbers: PAGE.md from the Jinja template PAGE.md.j2 beside it.

    docs/tools/pages.py            write all pages
    docs/tools/pages.py --check    name the pages that are not current; exit code 1 if there are any

Tables are the .txt files of analysis/results. A template takes a number from one:

    subspace leaves {{ cell("spatial_bending; CG ratio; Bending rod; subspace 10; 1e-2", ".00") }}

The address has the table's name, the beginnings of its section and of its block, the row and the column. `; 2` at the
end selects the second number of a cell such as "0.10 [0.09, 0.11]". The section `*` matches any. The second argument
is the style: the number gets its digits after the point, and commas, an exponent or a zero before the point if it has
them.

Whole tables pass through a filter. {row} and {column} in its address are the texts of the table's first column and
line. A text in @<<...>> replaces the visible text there, and is not shown:

    {% filter table("learned_rods; CG ratio, first; {row}; {column}") %}
    | 1e-2, 1e-3 | subspace 10@<<subspace 10; 1e-2, 1e-3>> |
    |---|---|
    | bending rods@<<Bending rod>> | .00 **.00** |
    {% endfilter %}

{% filter wrapped %} ... {% endfilter %} breaks the lines of a paragraph or item anew.

{{ score.times("10 %", "1 %") }} and the other functions of `score` are those of scores.py. {{ cheapest("net_gusts",
{"8 × 8": "Net, scene.rows = 8:"}) }} is a table of the fastest combinations, with a row for each of these blocks.

The numbers in the cells are styles. A cell has one number per column in its address, each with or without its
interval, [.00, .00]. Text in `backticks` and columns called `-` do not change. In tables, a | in an address is \\|.
"""

import itertools
import os
import re
import sys
import textwrap
from decimal import ROUND_HALF_UP, Decimal
from pathlib import Path

import jinja2
import links
import scores

ROOT = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
TABLES = os.path.join(ROOT, "analysis", "results")
sys.path.insert(0, TABLES)
import origins  # noqa: E402
NUMBER = re.compile(r"[−-]?(?:\d[\d,]*\.?\d*|\.\d+)(?:e[+−-]?\d+)?")
NAMED = re.compile(r"@<<(.*?)>>")
BAR = re.compile(r"(?<!\\)\|")
DISTRUSTED = "not to be trusted"    # in a line below times of which too many were interrupted
WITH_INTERVAL = re.compile(rf"({NUMBER.pattern})[*_]*(?:\s*\[({NUMBER.pattern}), ({NUMBER.pattern})\])?")


class NotFound(Exception):
    """The message names the table and what it lacks."""


class Tables:
    """The tables of a folder, each read once. Those that are older than their job or models are not quoted."""

    def __init__(self, folder):
        self.folder, self.lines = folder, {}
        self.older = origins.older(origins.read(os.path.join(folder, "origins.txt")))

    def cell(self, address, style):
        """The number at an address, in a style."""
        name, section, block, row, column, *rest = [part.strip() for part in address.split(";")]
        lines = self._lines(name)
        try:
            text = find_cell(lines, section, block, row, column)
        except NotFound as missing:
            raise NotFound(f"{name}.txt has no {missing} of {address!r}") from None
        numbers, place = NUMBER.findall(text), int(rest[0]) - 1 if rest else 0
        if place >= len(numbers):
            raise NotFound(f"{name}.txt has no number {place + 1} in {text!r} of {address!r}")
        return styled(numbers[place], style)

    def _lines(self, name):
        if name not in self.lines:
            path = os.path.join(self.folder, f"{name}.txt")
            if not os.path.exists(path):
                raise NotFound(f"there is no table {path}")
            for study, why in self.older.items():
                if study == name:
                    raise NotFound(f"{name}.txt is not quoted: {why}; run the study and draw it again")
            with open(path, encoding="utf-8") as file:
                self.lines[name] = file.read().splitlines()
        return self.lines[name]

    def cheapest(self, name, blocks):
        """A Markdown table of the fastest combinations of each kind in a table of combinations: times in µs."""
        lines = self._lines(name)
        kinds = ("direct", "from zero", "classical guess", "learned guess")
        factors = [(kinds[2], "over from zero"), (kinds[3], "over from zero"), (kinds[3], "over classical guess")]
        rows = [["", "joints", *kinds, "classical over zero", "learned over zero", "learned over classical"]]
        for text, block in blocks.items():
            try:
                inside = lines[_first(lines, 0, block, f"block {block!r}"):]
            except NotFound as missing:
                raise NotFound(f"{name}.txt has no {missing}") from None
            joints = re.search(r": (\d+) joints", inside[0]).group(1)
            found = itertools.takewhile(str.strip, inside[_first(inside, 0, "the cheapest", f"cheapest in {name}.txt") + 1:])
            settings = {cells[0].group(): cells[1].group() for cells in map(_cells, found)}
            times = {kind: find_cell(inside, "*", "the cheapest", kind, "µs") for kind in kinds}
            rows.append([text, f"{int(joints):,}", *(_time(times[kind]) + _ways(settings[kind]) for kind in kinds),
                         *(find_cell(inside, "*", "the cheapest", kind, over) for kind, over in factors)])
        return scores.markdown(rows)

    def table(self, text, address):
        """A Markdown table with the numbers of its address."""
        names, lines = None, []
        for number, line in enumerate(text.strip("\n").splitlines()):
            cells = BAR.split(line[1:].rstrip().removesuffix("|"))
            if number == 0:
                names = [called(cell) for cell in cells]
            elif number > 1:
                row = called(cells[0])
                cells[1:] = [cell if name == "-" else self._filled(cell, address, row, name)
                             for name, cell in zip(names[1:], cells[1:])]
            lines.append("|" + "|".join(NAMED.sub("", cell) for cell in cells) + "|")
        return "\n".join(lines) + "\n"

    def _filled(self, cell, address, row, column):
        *where, columns = address.replace("{column}", column).replace("{row}", row).split(";")
        words = re.sub(r"`[^`]*`", lambda quoted: " " * len(quoted.group()), cell)
        numbers, parts = list(WITH_INTERVAL.finditer(words)), columns.split(",")
        if numbers and len(numbers) != len(parts):
            raise NotFound(f"{len(numbers)} numbers for {len(parts)} columns in {cell.strip()!r} ({row!r}, {column!r})")
        pieces, done = [], 0
        for found, part in zip(numbers, parts):
            for which, end in (group for group in ((1, ""), (2, "; 2"), (3, "; 3")) if found.group(group[0])):
                pieces += [cell[done:found.start(which)], self.cell(";".join([*where, part]) + end, found.group(which))]
                done = found.end(which)
        return "".join([*pieces, cell[done:]])


def find_cell(lines, section, block, row, column):
    """The text of a cell. Columns are right-aligned: a header's cell ends where the row's does. Times of a block that says
    "not to be trusted" are not found."""
    start = _first(lines, 0, section, f"section {section!r}") if section != "*" else 0
    start = _first(lines, start, block, f"block {block!r}")
    above = start    # blocks may share a header above them
    while above > 0 and lines[above - 1].strip():
        above -= 1
    for header in (start, *range(start + 1, min(start + 2, len(lines))), *range(above, start)):
        ends = [cell.end() for cell in _cells(lines[header]) if cell.group() == column]
        if ends:
            break
    else:
        raise NotFound(f"column {column!r}")
    for line in lines[max(start, header) + 1:]:
        if not line.strip():
            break
        first, *others = _cells(line)
        if first.group() == row:
            found = [cell.group() for cell in others if cell.end() == ends[0]]
            if found:
                if any(DISTRUSTED in line for line in itertools.takewhile(str.strip, lines[max(start, header) + 1:])):
                    raise NotFound(f"times to be trusted in block {block!r}")
                return found[0]
    raise NotFound(f"row {row!r}")


def _time(cell):
    """"931 [912, 958] (4 of 5)" as "931 (4 of 5)"."""
    return re.sub(r" \[.*?\]", "", cell)


def _ways(setting):
    """"block icc lag 5 from copingnet lattices" as " `block_icc` lag 5, `lattices`"; the direct solve needs no words."""
    preconditioner, _, guess = setting.partition(" from ")
    name, settings = re.fullmatch(r"(.+?)((?: (?:levels|lag) \d+)*)", preconditioner).groups()
    start = "" if guess == "zero" else f", `{guess.removeprefix('copingnet ')}`"
    return f" `{name.replace(' ', '_')}`{settings}{start}" if guess else ""


def _cells(line):
    return list(re.finditer(r"\S+(?: \S+)*", line))


def _first(lines, start, words, what):
    """The first line that begins with `words`; if it is in a table that has a row of exactly this name, that row."""
    for k in range(start, len(lines)):
        if lines[k].lstrip().startswith(words):
            table = itertools.takewhile(lambda row: lines[row].strip(), range(k, len(lines)))
            return next((row for row in table if _cells(lines[row])[0].group() == words), k)
    raise NotFound(what)


def called(cell):
    """The name of a row or column for its address."""
    named = NAMED.search(cell)
    return named.group(1).replace("\\|", "|") if named else re.sub(r"[*`_]", "", cell).strip()


def styled(number, style):
    """A number in the style of another, with at most the digits that it has."""
    mantissa, exponent, _ = style.lower().partition("e")
    digits, value = len(mantissa.partition(".")[2]), Decimal(number.replace("−", "-").replace(",", ""))
    if exponent:
        text = re.sub(r"e([+-])0*(\d)", lambda e: "e" + e.group(1).replace("+", "") + e.group(2), f"{value:.{digits}e}")
    else:
        digits = min(digits, max(0, -value.as_tuple().exponent))
        rounded = value.quantize(Decimal(1).scaleb(-digits), ROUND_HALF_UP)
        text = f"{rounded:,}" if "," in style else f"{rounded}"
    if mantissa.lstrip("-−").startswith("."):
        text = re.sub(r"^(-?)0\.", r"\1.", text)
    return text.replace("-", "−") if "−" in style else text


def wrapped(text):
    """The lines of a paragraph or item, 120 wide; links stay whole."""
    words = links.LINK_TEXT.sub(lambda link: link.group().replace(" ", "\0"), " ".join(text.split()))
    lines = textwrap.fill(words, 120, break_long_words=False, break_on_hyphens=False,
                          subsequent_indent="  " if words.startswith("- ") else "")
    return lines.replace("\0", " ") + "\n"


def rendered(template, folder=TABLES, root=ROOT):
    """The text of a page. `root` has the score's scenes."""
    tables = Tables(folder)
    environment = jinja2.Environment(keep_trailing_newline=True, trim_blocks=True, undefined=jinja2.StrictUndefined)
    environment.filters.update(table=tables.table, wrapped=wrapped)
    with open(template, encoding="utf-8") as file:
        return environment.from_string(file.read()).render(
            cell=tables.cell, cheapest=tables.cheapest, score=scores.Scores(root))


def templates(root=ROOT):
    return sorted(os.path.join(folder, name) for folder, _, names in os.walk(root) for name in names
                  if name.endswith(".md.j2") and "build" not in os.path.relpath(folder, root))


def main():
    check, stale = sys.argv[1:] == ["--check"], []
    if sys.argv[1:] and not check:
        sys.exit("usage: docs/tools/pages.py [--check]")
    for template in templates():
        page = Path(template.removesuffix(".j2"))
        text = rendered(template)
        current = page.exists() and page.read_text(encoding="utf-8") == text
        if check and not current:
            stale.append(f"{os.path.relpath(page)} is not current: docs/tools/pages.py writes it of "
                         f"{os.path.relpath(template)}")
        elif not current:
            page.write_text(text, encoding="utf-8")
            print(os.path.relpath(page))
    sys.exit("\n".join(stale) or 0)


if __name__ == "__main__":
    try:
        main()
    except NotFound as missing:
        sys.exit(f"docs/tools/pages.py: {missing}")
