"""Puts sweeps, style, scripts and libraries into one self-contained page of HTML."""

import json
import math
from datetime import datetime, timezone
from pathlib import Path

import jinja2

from rodsweep.report import answers

HERE = Path(__file__).parent
LIBRARIES = ("d3.min.js", "plot.min.js")
SCRIPTS = ("numbers.js", "theme.js", "sorting.js", "chart.js", "cursor.js", "explorer.js", "rods.js", "main.js")

ANSWERS_OPEN, STEPS_OPEN = 6, 12    # answers and rows of steps of a sweep; more are folded


def html(sweeps, title):
    """The page of a list of sweep.Sweep."""
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(HERE / "static"), autoescape=True, trim_blocks=True,
                                     lstrip_blocks=True, undefined=jinja2.StrictUndefined)
    environment.filters["finite"] = lambda number: number is not None and math.isfinite(number)
    found = [answer for sweep in sweeps for answer in sweep.answers]
    return environment.get_template("page.html").render(
        sweeps=sweeps, title=title, tried=answers.tried(found) if found else "",
        dot=answers.DOT_WIDTH, bar=answers.BAR_WIDTH,
        answers_open=ANSWERS_OPEN, steps_open=STEPS_OPEN,
        made=datetime.now(timezone.utc).strftime("%Y-%m-%d %H:%M UTC"),
        style=_text("static", "report.css"), libraries=[_text("vendor", name) for name in LIBRARIES],
        script="\n".join(_text("static", name) for name in SCRIPTS), data=embedded([one.data for one in sweeps]))


def embedded(data):
    """JSON that stays within its <script> for any labels and messages."""
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


def _text(folder, name):
    return (HERE / folder / name).read_text(encoding="utf-8")
