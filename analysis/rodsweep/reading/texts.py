"""Numbers, labels and tables as text."""

import csv
import math
import re

import numpy as np

NAMES = {"scene.segments": "number of segments N", "scene.youngs_modulus_pa": "Young's modulus",
         "time.step_s": "time step"}


def number_text(value):
    """Short: 0.005, 20, 1e6, 3.7e-4; "-" if it is not finite."""
    if not math.isfinite(value):
        return "-"
    if value == 0 or 1e-3 <= abs(value) < 1e4:
        return f"{value:.4g}"
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{float(mantissa):g}e{int(exponent)}"


def quantity(name, unit):
    """What a key measures, without its unit: scene.torsion_modulus_pa, Pa -> "torsion modulus"."""
    if name in NAMES:
        return NAMES[name]
    words = name.rsplit(".", 1)[-1].split("_")
    letters = re.sub(r"[^a-z0-9]", "", unit.lower())
    for k in range(1, len(words)):
        if letters and "".join(words[k:]) in (letters, "per" + letters.lstrip("1")):
            words = words[:k]
            break
    return " ".join(words)


def parameter_label(name, unit):
    """scene.youngs_modulus_pa, Pa -> "Young's modulus (Pa)"; the number of segments is N."""
    return quantity(name, unit) + (f" ({unit})" if unit and unit != "1" else "")


def tolerance_label(value):
    """1e-2, 3e-3."""
    mantissa, exponent = f"{value:.2e}".split("e")
    return f"{float(mantissa):g}e{int(exponent)}"


def interval_text(estimate, digits=2):
    """0.25 [0.21, 0.30] of an Estimate of one number; "-" if there is none."""
    if not math.isfinite(estimate.value):
        return "-"
    if not math.isfinite(estimate.low):
        return f"{estimate.value:.{digits}f}"
    return f"{estimate.value:.{digits}f} [{estimate.low:.{digits}f}, {estimate.high:.{digits}f}]"


def short_text(value, digits):
    return f"{value:.{digits}g}" if math.isfinite(value) else "-"


def fixed_text(value, digits):
    return f"{value:.{digits}f}" if math.isfinite(value) else "-"


def range_text(counts):
    """5 or 4–5."""
    counts = [int(c) for c in np.ravel(counts) if c > 0]
    if not counts:
        return "0"
    return str(min(counts)) if min(counts) == max(counts) else f"{min(counts)}–{max(counts)}"


def simulations_text(counts):
    """1 simulation, 5 simulations or 4–5 simulations."""
    text = range_text(counts)
    return f"{text} simulation{'s' if text != '1' else ''}"


def aligned(rows, right=None):
    """Columns of equal width. `right`: whether each is right-aligned, by default all but the first."""
    widths = [max(map(len, column)) for column in zip(*rows)]
    right = [False] + [True] * len(widths) if right is None else right
    return ["  ".join(cell.rjust(w) if r else cell.ljust(w) for cell, w, r in zip(row, widths, right)).rstrip() for row in rows]


def shortened(values, digits):
    """Numbers, in lists as they come, with so many digits; None if not finite."""
    if np.ndim(values):
        return [shortened(part, digits) for part in values]
    return float(f"{values:.{digits}g}") if np.isfinite(values) else None


def write_csv(out, columns, records):
    """NaN (the only value that is not equal to itself) and missing keys of a record become empty fields."""
    writer = csv.DictWriter(out, columns, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows({key: "" if value != value else value for key, value in record.items()} for record in records)


def split_labels(text):
    """Splits at commas outside parentheses, since labels may contain commas."""
    parts, depth, start = [], 0, 0
    for k, letter in enumerate(text):
        depth += (letter == "(") - (letter == ")")
        if letter == "," and depth == 0:
            parts.append(text[start:k])
            start = k + 1
    return parts + [text[start:]]


def kind_of(label):
    """A guess's kind, the first word of its label; an oracle with white errors is a kind of its own."""
    words = re.findall(r"[a-z]+", label.lower()) or [""]
    return "oracle white" if words[0] == "oracle" and "white" in words else words[0]
