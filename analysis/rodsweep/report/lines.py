"""Look of a family's lines on the page: colours for light and dark pages, markers and dashes of its charts."""

from rodsweep.drawing import looks

SYMBOLS = {"o": "Circle", "v": "Wye", "s": "Square", ">": "Diamond", "8": "Plus", "P": "Cross", "^": "Triangle",    # of d3
           "<": "Triangle2", "X": "Times", "*": "Star", "D": "Diamond", "x": "Times", "H": "Plus", "h": "Plus",
           "p": "Square2", "d": "Diamond2", (5, 1, 0): "Star", (4, 2, 0): "Asterisk", (3, 1, 0): "Wye",
           (3, 2, 0): "Asterisk", (6, 1, 0): "Asterisk", (4, 1, 0): "Star"}
DASH = 1.6           # pixels per unit of a dash
ON_DARK = 0.30       # smallest relative luminance of a line on a dark page


def packed(found):
    """{label: looks.Look} in the form that the page reads."""
    return [{"label": label, "light": look.colour, "dark": on_dark(look.colour),
             "symbol": SYMBOLS.get(look.marker, "Circle"),
             "dash": " ".join(f"{DASH * length:g}" for length in look.dash[1]) if look.dash[1][-1] else ""}
            for label, look in found.items()]


def on_dark(colour):
    """The colour, lighter if a dark page needs it."""
    share = 0.0
    while looks.luminance(looks.channels(looks.lighter(colour, share))) < ON_DARK:
        share += 0.02
    return looks.lighter(colour, share)
