"""A colour bar with its unit, in a strip under a picture."""

import io

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter
from PIL import Image

DPI = 100


def height(picture_height):
    """Pixels of the strip in a picture of this height."""
    return min(max(26, picture_height // 11), picture_height // 2)


def strip(scale, shades, size):
    """An image of size (width, height) with the bar of a tints.Scale. shades: [shade, rgb] from low to high."""
    figure = Figure(figsize=(size[0] / DPI, size[1] / DPI), dpi=DPI, facecolor="white")
    canvas = FigureCanvasAgg(figure)
    letters = {"fontsize": 0.34 * size[1] * 72 / DPI}
    axes = figure.add_axes((0.3, 0.55, 0.4, 0.3))
    axes.imshow(np.arange(len(shades))[None], cmap=ListedColormap(shades), aspect="auto",
                extent=(scale.low, scale.high, 0, 1))
    ticks = np.linspace(scale.low, scale.high, 3)
    axes.set_xticks(ticks, [EngFormatter(scale.unit)(tick) for tick in ticks], **letters)
    axes.tick_params(length=0, pad=0.08 * size[1] * 72 / DPI)
    axes.set_yticks([])
    figure.text(0.28, 0.7, scale.name, ha="right", va="center", **letters)
    canvas.draw()
    return Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")


def under(picture, bar):
    """PNG bytes of a picture (PNG bytes) with a bar under it, scaled to the picture's width."""
    with Image.open(io.BytesIO(picture)) as above:
        bar = bar.resize((above.width, max(1, bar.height * above.width // bar.width)))
        whole = Image.new("RGB", (above.width, above.height + bar.height))
        whole.paste(above.convert("RGB"), (0, 0))
    whole.paste(bar, (0, whole.height - bar.height))
    out = io.BytesIO()
    whole.save(out, "PNG")
    return out.getvalue()
