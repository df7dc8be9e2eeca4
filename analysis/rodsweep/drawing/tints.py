"""Colours of segments in pictures: by rod, by position along the rod, or by radius."""

import numpy as np
from matplotlib import colormaps, colors

from rodsweep.drawing import staging
from rodsweep.drawing.looks import HELD, RODS

WOOD = colors.LinearSegmentedColormap.from_list("wood", ["#8fb648", "#6f8a3c", "#7a5d3b", "#5d4230"])   # thin to thick
SHADES = 64             # colours of a continuous scale


def colours(trajectory, by):
    """A palette [colour, rgb] (sRGB) and every segment's index in it. by: "rod", "along" its rod, or "radius"."""
    if by == "rod":
        palette = [colors.to_rgb(c) for c in RODS]
        number = trajectory.rod % len(palette)
    else:
        values = np.log(staging.drawn_radius(trajectory)) if by == "radius" else along(trajectory.rod)
        low, high = values.min(), values.max()
        scale = colormaps["viridis"] if by == "along" else WOOD
        palette = [scale(shade)[:3] for shade in np.linspace(0.1, 0.95, SHADES)]
        number = np.rint((SHADES - 1) * (values - low) / (high - low or 1)).astype(int)
    return np.array([*palette, colors.to_rgb(HELD)]), np.where(trajectory.static, len(palette), number)


def along(rod):
    """Every segment's position within its rod, from 0 to 1."""
    place = np.zeros(len(rod))
    for number in np.unique(rod):
        mine = rod == number
        place[mine] = np.linspace(0, 1, mine.sum())
    return place
