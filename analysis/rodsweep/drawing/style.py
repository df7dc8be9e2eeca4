"""How figures look: one colour, marker and line style per guess in every figure, type sizes and widths for print.

Colours are Okabe and Ito's (2008) with darker relatives for the additional kinds. Guesses are told apart by marker and
line style as well, so that neither a colour-blind reader nor a black-and-white print needs the colour. A guess is
recognised by the first word of its label; several of one kind (oracle 0.1, oracle 0.01) share a hue and differ in
lightness, marker and dash. Widths: 84 mm is one column of a page of two, 174 mm the whole page.
"""

import re
from dataclasses import dataclass

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib import colors
from matplotlib.lines import Line2D

from rodsweep.reading import texts

MM = 1 / 25.4
WIDTHS_MM = {"84": 84, "174": 174}

KINDS = {  # colour, marker, dash
    "zero": ("#3c3c3c", None, (0, (1, 0))),
    "previous": ("#0072B2", "o", (0, (5, 1.5))),
    "linear": ("#2f9fd8", "v", (0, (1.2, 1.2))),
    "quadratic": ("#D55E00", "s", (0, (1, 0))),
    "oracle": ("#a8478c", ">", (0, (4, 1.2, 1, 1.2))),
    "oracle white": ("#c774b0", "8", (0, (2, 1, 1, 1))),
    "guarded": ("#7a5a00", "P", (0, (7, 1.5, 1, 1.5, 1, 1.5))),
    "fischer": ("#b8860b", "^", (0, (2.5, 1.2))),
    "pod": ("#6b7f00", "<", (0, (6, 2))),
    "regression": ("#7b3fb5", (5, 1, 0), (0, (3, 1))),
    "deflation": ("#a0404a", (4, 2, 0), (0, (5, 1, 1, 1))),
    "totals": ("#c2571a", (3, 1, 0), (0, (4, 1, 1, 1))),
    "knn": ("#332288", "X", (0, (3, 1, 1, 1, 1, 1))),
    "copingnet": ("#00805c", "*", (0, (1, 0))),
    "direct": ("#000000", "D", (0, (1, 1))),
    "end": ("#CC3311", "x", (0, (3, 1.2, 1, 1.2))),   # end_to_end
    "state": ("#0f7f9c", (3, 2, 0), (0, (6, 1, 1, 1))),   # state_network
    "xpbd": ("#c2185b", (6, 1, 0), (0, (5, 1, 2, 1))),
    "pbd": ("#8d6e63", (4, 1, 0), (0, (4, 1, 1, 1, 1, 1, 1, 1))),
}
SPARE = [("#882255", "H", (0, (2, 2))), ("#117733", "h", (0, (8, 2))), ("#555555", "p", (0, (3, 3))),
         ("#aa4499", "d", (0, (1, 2)))]
VARIANT_MARKERS = "dpHh"
VARIANT_DASHES = [(0, (2, 1)), (0, (3, 1, 1, 1)), (0, (8, 1.5)), (0, (1, 1.6)), (0, (5, 1, 1, 1, 1, 1))]

PARTS = {  # parts of a solve's time: colour, hatch
    "assembly": ("#c9c9c9", ""),
    "guess": ("#E69F00", "////"),
    "CG": ("#4b93c3", ""),
    "direct": ("#5b5b5b", "...."),
}
DIVERGING = colors.LinearSegmentedColormap.from_list("blue to orange", [
    "#0b4f8a", "#4b93c3", "#a9cfe4", "#f7f7f5", "#f5c79a", "#e08a3c", "#a34a00"])
SEQUENTIAL = matplotlib.colormaps["cividis_r"]
WARNING_COLOUR = "#b00020"


@dataclass(frozen=True)
class GuessStyle:
    colour: str
    marker: str
    dash: tuple

    def line(self):
        return {"color": self.colour, "marker": self.marker, "linestyle": self.dash}

    def handle(self, label):
        """Its line in a legend."""
        return Line2D([], [], label=label, **self.line())


DIRECT = GuessStyle(*KINDS["direct"])
# As Shao et al. 2021 have them: black, purple, red, pink.
FOUR_CURVES = {"ratio": GuessStyle("#000000", "o", (0, (1, 0))), "share": GuessStyle("#7b3fb5", "v", (0, (3, 1))),
               "guess_cg": GuessStyle("#c62828", "s", (0, (1, 0))), "step": GuessStyle("#e88fb4", "D", (0, (5, 1.5)))}
ZERO_LINE = {"color": KINDS["zero"][0], "linewidth": 0.9}    # at 1, where guesses are compared with zero
WHISKERS = {"elinewidth": 0.7, "capsize": 1.1, "capthick": 0.7}


def guess_styles(labels):
    """A style per label, from the label's kind and its rank among the labels of that kind."""
    styles, seen, spare = {}, {}, iter(SPARE * (1 + len(labels)))
    for label in labels:
        kind = texts.kind_of(label)
        rank = seen.get(kind, 0)
        seen[kind] = rank + 1
        if kind not in KINDS:
            styles[label] = GuessStyle(*next(spare))
        elif rank == 0:
            styles[label] = GuessStyle(*KINDS[kind])
        else:
            colour = lighter(KINDS[kind][0], min(0.55, 0.25 * rank))
            variant = (rank - 1) % len(VARIANT_MARKERS)
            styles[label] = GuessStyle(colour, VARIANT_MARKERS[variant], VARIANT_DASHES[variant])
    return styles


def series_styles(count):
    """Styles of lines that are of no guess, in their order."""
    kinds = ("previous", "quadratic", "oracle", "copingnet", "linear", "guarded", "knn")
    looks = [KINDS[kind] for kind in kinds] + SPARE
    return [GuessStyle(*looks[k % len(looks)]) for k in range(count)]


def whiskers(value, low, high):
    """Lengths below and above a value for errorbar(); 0 where there is no interval."""
    return np.nan_to_num(np.stack([value - low, high - value]).clip(min=0))


def lighter(colour, share):
    return colors.to_hex([c + (1 - c) * share for c in colors.to_rgb(colour)])


def luminance(colour):
    """Relative luminance (WCAG): 0 black, 1 white."""
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in colors.to_rgb(colour)]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def use():
    plt.rcParams.update({
        "font.family": "DejaVu Sans", "font.size": 7, "axes.titlesize": 7.5, "axes.labelsize": 7, "legend.fontsize": 7,
        "xtick.labelsize": 6.5, "ytick.labelsize": 6.5, "axes.linewidth": 0.6, "lines.linewidth": 1.1,
        "lines.markersize": 3.6, "xtick.major.width": 0.6, "ytick.major.width": 0.6, "xtick.minor.width": 0.4,
        "ytick.minor.width": 0.4, "xtick.major.size": 2.5, "ytick.major.size": 2.5, "xtick.minor.size": 1.5,
        "ytick.minor.size": 1.5, "hatch.linewidth": 0.5, "axes.grid": True, "grid.linewidth": 0.35,
        "grid.color": "#dddddd", "axes.axisbelow": True, "axes.spines.top": False, "axes.spines.right": False,
        "legend.frameon": False, "pdf.fonttype": 42, "savefig.dpi": 300, "figure.dpi": 150})


def parameter_label(name, unit):
    """scene.youngs_modulus_pa, Pa -> "Young's modulus (Pa)"; the number of segments is N."""
    return texts.quantity(name, unit) + (f" ({unit})" if unit and unit != "1" else "")


def tolerance_text(value):
    """1e-2 as a power of ten in mathematical type."""
    mantissa, exponent = f"{value:.2e}".split("e")
    power = f"10^{{{int(exponent)}}}"
    return f"${power}$" if float(mantissa) == 1 else f"${float(mantissa):g}\\times{power}$"
