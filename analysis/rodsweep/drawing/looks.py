"""Colour, marker and dash of every guess and method, independent of drawing programs.

Colours are those of Okabe and Ito (2008), with darker variants for the additional kinds. Guesses also differ in marker
and dash, for colour-blind readers and for black-and-white print. The first word of a label gives the kind of a guess.
Several guesses of one kind (oracle 0.1, oracle 0.01) share a hue and differ in lightness, marker and dash, all written
in matplotlib's form.
"""

from dataclasses import dataclass

from rodsweep.reading import texts

KINDS = {  # colour, marker, dash
    "zero": ("#3c3c3c", None, (0, (1, 0))),
    "previous": ("#0072B2", "o", (0, (5, 1.5))),
    "linear": ("#2f9fd8", "v", (0, (1.2, 1.2))),
    "quadratic": ("#D55E00", "s", (0, (1, 0))),
    "oracle": ("#a8478c", ">", (0, (4, 1.2, 1, 1.2))),
    "oracle white": ("#c774b0", "8", (0, (2, 1, 1, 1))),
    "guarded": ("#7a5a00", "P", (0, (7, 1.5, 1, 1.5, 1, 1.5))),
    "fischer": ("#b8860b", "^", (0, (2.5, 1.2))),
    "subspace": ("#6b7f00", "<", (0, (6, 2))),
    "regression": ("#7b3fb5", (5, 1, 0), (0, (3, 1))),
    "deflation": ("#a0404a", (4, 2, 0), (0, (5, 1, 1, 1))),
    "ritz": ("#5d4a8a", (4, 1, 45), (0, (2, 1, 4, 1))),
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
}
RODS = ("#2f6f9f", "#c8553d", "#4f8a5b", "#d9a03f", "#7a5c99", "#5aa5b5", "#a8475c", "#8a8f3c")
HELD = "#4a4e54"    # segments that a clamp holds


@dataclass(frozen=True)
class Look:
    colour: str
    marker: str
    dash: tuple


def guess_looks(labels):
    """A look per label, from the label's kind and its rank among the labels of that kind."""
    looks, seen, spare = {}, {}, iter(SPARE * (1 + len(labels)))
    for label in labels:
        kind = texts.kind_of(label)
        rank = seen.get(kind, 0)
        seen[kind] = rank + 1
        if kind not in KINDS:
            looks[label] = Look(*next(spare))
        elif rank == 0:
            looks[label] = Look(*KINDS[kind])
        else:
            colour = lighter(KINDS[kind][0], min(0.55, 0.25 * rank))
            variant = (rank - 1) % len(VARIANT_MARKERS)
            looks[label] = Look(colour, VARIANT_MARKERS[variant], VARIANT_DASHES[variant])
    return looks


def channels(colour):
    """Red, green and blue of "#rrggbb", 0 to 1 each."""
    return tuple(int(colour[k:k + 2], 16) / 255 for k in (1, 3, 5))


def lighter(colour, share):
    return "#" + "".join(f"{round(255 * (c + (1 - c) * share)):02x}" for c in channels(colour))


def luminance(colour):
    """Relative luminance (WCAG) of red, green and blue, 0 to 1 each: 0 black, 1 white."""
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in colour[:3]]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
