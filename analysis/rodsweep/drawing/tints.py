"""Colours of segments in pictures: by rod, by position along the rod, by radius, or by a force inside them."""

from dataclasses import dataclass
from typing import Callable

import numpy as np
from matplotlib import colormaps, colors

from rodsweep.drawing import staging
from rodsweep.drawing.looks import HELD, RODS
from rodsweep.reading.errors import KeyNotFound
from rodsweep.reading.internal_forces import QUANTITIES, SIGNED

WOOD = colors.LinearSegmentedColormap.from_list("wood", ["#8fb648", "#6f8a3c", "#7a5d3b", "#5d4230"])   # thin to thick
SHADES = 64             # colours of a continuous scale
CHOICES = ("rod", "along", "radius", *QUANTITIES)


@dataclass(frozen=True)
class Scale:
    """What a colour bar shows."""
    name: str
    unit: str
    low: float
    high: float


@dataclass(frozen=True)
class Colours:
    palette: np.ndarray                     # [colour, rgb] (sRGB); the last is that of held segments
    numbers: Callable[[int], np.ndarray]    # of a frame: every segment's index in the palette
    scale: Scale = None                     # None: the colours need no bar


def colours(trajectory, by, frames=()):
    """The Colours of a trajectory. by: one of CHOICES; forces have one scale over all `frames`."""
    if by in QUANTITIES:
        return of_forces(trajectory, by, frames)
    if by == "rod":
        palette = [colors.to_rgb(c) for c in RODS]
        number = trajectory.rod % len(palette)
    else:
        values = np.log(staging.drawn_radius(trajectory)) if by == "radius" else along(trajectory.rod)
        palette = shades(colormaps["viridis"] if by == "along" else WOOD)
        number = shade(values, values.min(), values.max())
    number = np.where(trajectory.static, len(palette), number)
    return Colours(with_held(palette), lambda frame: number)


def of_forces(trajectory, by, frames):
    """Signed forces have a scale from blue to red that is symmetric about zero. Segments without a value have the
    colour of held ones."""
    def values(frame):
        found = trajectory.internal_forces(frame)
        if by not in found:
            raise KeyNotFound("a section is neither a solid circle nor a tube, so the stress at its surface is not known: "
                              "choose --colour tension, bending or torsion")
        return np.where(trajectory.static, np.nan, found[by])

    def numbers(frame):
        found = values(frame)
        known = np.isfinite(found)
        return np.where(known, shade(np.where(known, found, 0), low, high), SHADES)

    largest = np.fmax.reduce([np.fmax.reduce(np.abs(values(frame))) for frame in frames])
    if not np.isfinite(largest):
        raise KeyNotFound(f"task {trajectory.task} has no forces in these frames: the first frame is the initial state")
    high = rounded_up(largest)
    low = -high if by in SIGNED else 0.0
    palette = shades(colormaps["coolwarm"], 0, 1) if by in SIGNED else shades(colormaps["viridis"])
    return Colours(with_held(palette), numbers, Scale(by, QUANTITIES[by], low, high))


def shades(scale, first=0.1, last=0.95):
    return [scale(place)[:3] for place in np.linspace(first, last, SHADES)]


def shade(values, low, high):
    return np.rint((SHADES - 1) * (values - low) / (high - low or 1)).astype(int)


def with_held(palette):
    return np.array([*palette, colors.to_rgb(HELD)])


def rounded_up(value):
    """To two digits, apart from rounding errors; 1 for 0."""
    if not value:
        return 1.0
    unit = 10.0 ** (np.floor(np.log10(value)) - 1)
    return float(unit * np.ceil(np.round(value / unit, 6)))


def along(rod):
    """Every segment's position within its rod, from 0 to 1."""
    place = np.zeros(len(rod))
    for number in np.unique(rod):
        mine = rod == number
        place[mine] = np.linspace(0, 1, mine.sum())
    return place
