"""Writes pictures as a film, one at a time: MP4 with ffmpeg, GIF with Pillow. Both hold at most two frames."""

import contextlib
import io
import subprocess
import tempfile

import numpy as np
from PIL import GifImagePlugin, Image
from scipy.spatial import cKDTree

from rodsweep.reading.errors import ToolError

COLOURS = 255      # of a GIF; all frames share one palette, so that still parts do not flicker


def write_mp4(path, pictures, rate):
    """H.264 for all browsers. pictures: PNG bytes of one size, with even width and height."""
    command = ["ffmpeg", "-loglevel", "error", "-y", "-f", "image2pipe", "-framerate", str(rate), "-c:v", "png", "-i",
               "-", "-c:v", "libx264", "-preset", "slow", "-crf", "20", "-pix_fmt", "yuv420p", "-movflags",
               "+faststart", "-f", "mp4", path]
    with tempfile.TemporaryFile() as said:
        with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=said) as encoder:
            with contextlib.suppress(BrokenPipeError):  # ffmpeg stopped with a message
                for picture in pictures:
                    encoder.stdin.write(picture)
            with contextlib.suppress(BrokenPipeError):
                encoder.stdin.close()
        said.seek(0)
        if encoder.returncode:
            raise ToolError("ffmpeg failed: " + " ".join(said.read().decode("utf-8", "replace").split()))


def write_gif(path, pictures, rate, samples):
    """An endless loop. samples: pictures of any size that together have all colours. Frames after the first store only
    the rectangle that changes."""
    palette, before = Palette(samples), None
    show = {"duration": max(20, 10 * round(100 / rate))}   # ms, in steps of 10; viewers slow down below 20
    with open(path, "wb") as out:
        for picture in pictures:
            indices = palette.nearest(pixels(picture))
            if before is None:
                out.writelines(GifImagePlugin.getheader(palette.image(indices), info={"loop": 0, **show})[0])
                rows = columns = slice(None)
            else:
                rows, columns = changed(indices, before)
            part = palette.image(indices[rows, columns])
            out.writelines(GifImagePlugin.getdata(part, (columns.start or 0, rows.start or 0), **show))
            before = indices
        out.write(b";")


class Palette:
    """The colours of a GIF. Pillow's own search for the nearest colour is too coarse for soft greys."""

    def __init__(self, samples):
        colours = np.concatenate([pixels(sample).reshape(-1, 3) for sample in samples])
        found = Image.fromarray(colours[None]).quantize(COLOURS, method=Image.Quantize.MEDIANCUT, kmeans=1)
        self.colours = found.getpalette()
        self.tree = cKDTree(np.reshape(self.colours, (-1, 3)))

    def nearest(self, rgb):
        """[row, column] indices of colours."""
        packed = rgb.astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], np.uint32)
        different, place = np.unique(packed, return_inverse=True)
        index = self.tree.query(np.stack([different >> 16, different >> 8 & 255, different & 255], axis=-1))[1]
        return index.astype(np.uint8)[place].reshape(packed.shape)

    def image(self, indices):
        made = Image.fromarray(np.ascontiguousarray(indices), "P")
        made.putpalette(self.colours)
        return made


def changed(indices, before):
    """The smallest rectangle with all differences, as slices; one pixel if there are none."""
    different = indices != before
    if not different.any():
        return slice(0, 1), slice(0, 1)
    return tuple(slice(int(found[0]), int(found[-1]) + 1)
                 for found in (np.flatnonzero(different.any(axis=axis)) for axis in (1, 0)))


def pixels(picture):
    """[row, column, rgb] of a PNG."""
    return np.asarray(Image.open(io.BytesIO(picture)).convert("RGB"))
