"""Style of figures: colours, markers and dashes of `looks` for matplotlib, font sizes, widths for print.

Widths: 84 mm is one column of a page of two, 174 mm the whole page.
"""

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib import colors
from matplotlib.lines import Line2D

from rodsweep.drawing import looks
from rodsweep.drawing.looks import KINDS, SPARE

MM = 1 / 25.4

DIVERGING = colors.LinearSegmentedColormap.from_list("blue to orange", [
    "#0b4f8a", "#4b93c3", "#a9cfe4", "#f7f7f5", "#f5c79a", "#e08a3c", "#a34a00"])
SEQUENTIAL = matplotlib.colormaps["cividis_r"]
WARNING_COLOUR = "#b00020"


class GuessStyle(looks.Look):
    def line(self):
        return {"color": self.colour, "marker": self.marker, "linestyle": self.dash}

    def handle(self, label):
        """Its legend entry."""
        return Line2D([], [], label=literal(label), **self.line())


DIRECT = GuessStyle(*KINDS["direct"])
# The colours of Shao et al. 2021: black, purple, red, pink.
FOUR_CURVES = {"ratio": GuessStyle("#000000", "o", (0, (1, 0))), "share": GuessStyle("#7b3fb5", "v", (0, (3, 1))),
               "guess_cg": GuessStyle("#c62828", "s", (0, (1, 0))), "step": GuessStyle("#e88fb4", "D", (0, (5, 1.5)))}
ZERO_LINE = {"color": KINDS["zero"][0], "linewidth": 0.9}    # at 1, where guesses are compared with zero
WHISKERS = {"elinewidth": 0.7, "capsize": 1.1, "capthick": 0.7}


def guess_styles(labels):
    """A style per label."""
    return {label: GuessStyle(look.colour, look.marker, look.dash) for label, look in looks.guess_looks(labels).items()}


def series_styles(count):
    """Styles of lines that do not stand for guesses, in order."""
    kinds = ("previous", "quadratic", "oracle", "copingnet", "linear", "guarded", "knn")
    found = [KINDS[kind] for kind in kinds] + SPARE
    return [GuessStyle(*found[k % len(found)]) for k in range(count)]


def whiskers(value, low, high):
    """Lengths below and above a value for errorbar(); 0 without an interval."""
    return np.nan_to_num(np.stack([value - low, high - value]).clip(min=0))


def errorbar(axes, x, estimates, **drawing):
    """Draws a list of Estimates, each of a number, with their intervals: axes.errorbar(), or None if there is no point
    to draw. Matplotlib warns without one."""
    value, low, high = (np.array([getattr(one, part) for one in estimates], dtype=float)
                        for part in ("value", "low", "high"))
    there = np.isfinite(np.asarray(x, dtype=float)) & np.isfinite(value)
    return axes.errorbar(x, value, yerr=whiskers(value, low, high), **drawing) if there.any() else None


def literal(text):
    """A label or name for matplotlib, which would read dollar signs as the begin and end of a formula."""
    return text.replace("$", r"\$")


def use():
    plt.rcParams.update({
        "font.family": "DejaVu Sans", "font.size": 7, "axes.titlesize": 7.5, "axes.labelsize": 7, "legend.fontsize": 7,
        "xtick.labelsize": 6.5, "ytick.labelsize": 6.5, "axes.linewidth": 0.6, "lines.linewidth": 1.1,
        "lines.markersize": 3.6, "xtick.major.width": 0.6, "ytick.major.width": 0.6, "xtick.minor.width": 0.4,
        "ytick.minor.width": 0.4, "xtick.major.size": 2.5, "ytick.major.size": 2.5, "xtick.minor.size": 1.5,
        "ytick.minor.size": 1.5, "hatch.linewidth": 0.5, "axes.grid": True, "grid.linewidth": 0.35,
        "grid.color": "#dddddd", "axes.axisbelow": True, "axes.spines.top": False, "axes.spines.right": False,
        "legend.frameon": False, "pdf.fonttype": 42, "savefig.dpi": 300, "figure.dpi": 150})


def tolerance_text(value):
    """1e-2 as a power of ten in mathematical type."""
    mantissa, exponent = f"{value:.2e}".split("e")
    power = f"10^{{{int(exponent)}}}"
    return f"${power}$" if float(mantissa) == 1 else f"${float(mantissa):g}\\times{power}$"
