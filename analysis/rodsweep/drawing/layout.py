"""Layout of a figure: a page of panels in millimetres, and an x axis whose ticks never overlap."""

import os
import textwrap

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.colors import LogNorm
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, MaxNLocator, NullFormatter, NullLocator
from matplotlib.transforms import Bbox

from rodsweep.drawing import style
from rodsweep.reading import texts
from rodsweep.writing import outputs

METADATA = {"pdf": {"CreationDate": None, "Producer": None, "Creator": "rodsweep"}, "png": {"Software": "rodsweep"},
            "svg": {"Date": None, "Creator": "rodsweep"}}
CHARACTER_MM = 1.45  # approximate width of a digit of a tick


class Page:
    """A figure laid out in millimetres: warning and legend above rows of equal panels, notes below them.

    Each row has a title. Panels of a row, axes[row][k], wrap at `columns`."""

    def __init__(self, width_mm, row_titles, panels_per_row, columns, panel_height_mm, handles, notes, warning="",
                 left_mm=12, gap_mm=4, panel_titles_mm=4.5, ticks_mm=5.5, bar_mm=0):
        style.use()
        self.figure = plt.figure(figsize=(width_mm * style.MM, 100 * style.MM))
        legend, legend_mm = self._legend(handles, width_mm)
        notes = [line for note in notes for line in textwrap.wrap(note, int((width_mm - 4) / 1.13),
                                                                  break_on_hyphens=False)]
        warned = textwrap.wrap(warning, int((width_mm - 4) / 1.35))
        notes_mm, warning_mm, title_mm = 2.9 * len(notes) + 2, 3.4 * len(warned) + (1 if warned else 0), 5
        columns = min(columns, panels_per_row)
        lines = -(-panels_per_row // columns)
        panels_mm = lines * (panel_titles_mm + panel_height_mm + ticks_mm) + 3.2
        rows_mm = len(row_titles) * (title_mm + panels_mm)
        height = warning_mm + legend_mm + bar_mm + rows_mm + notes_mm + 1
        self.figure.set_size_inches(width_mm * style.MM, height * style.MM)
        panel_width = (width_mm - left_mm - 2 - (columns - 1) * gap_mm) / columns
        top = height - 1
        for k, line in enumerate(warned):
            self._text(2, top - 3.4 * k, line, width_mm, height, size=8, weight="bold", color=style.WARNING_COLOUR)
        top -= warning_mm
        if legend:
            legend.set_bbox_to_anchor((0, 0, 1, top / height), transform=self.figure.transFigure)
        top -= legend_mm
        self.bar_box = [(width_mm - 62) / width_mm, (top - 4.5) / height, 60 / width_mm, 2.6 / height]
        top -= bar_mm
        self.axes = []
        for title in row_titles:
            self._text(2, top - 0.5, title, width_mm, height, size=8, weight="bold")
            top -= title_mm
            row = []
            for k in range(panels_per_row):
                line, column = divmod(k, columns)
                x = left_mm + column * (panel_width + gap_mm)
                y = top - line * (panel_titles_mm + panel_height_mm + ticks_mm) - panel_titles_mm - panel_height_mm
                box = [x / width_mm, y / height, panel_width / width_mm, panel_height_mm / height]
                row.append(self.figure.add_axes(box))
            self.axes.append(row)
            top -= panels_mm
        for k, note in enumerate(notes):
            self._text(2, notes_mm - 1 - 2.9 * k, note, width_mm, height, size=6, color="#333333")
        self.columns, self.ticks_mm, self.notes_mm = columns, ticks_mm, notes_mm

    def _text(self, x, y, text, width, height, **text_style):
        self.figure.text(x / width, y / height, style.literal(text), va="top", ha="left", **text_style)

    def _legend(self, handles, width_mm):
        """(legend, height in mm), with as few lines as the width allows, evenly filled."""
        if not handles:
            return None, 0
        most = len(handles)
        for columns in sorted({-(-most // lines) for lines in range(1, most + 1)}, reverse=True):
            legend = self.figure.legend(handles=handles, loc="upper left", ncol=columns, handlelength=2.8,
                                        columnspacing=1.4, handletextpad=0.5, borderpad=0.2, labelspacing=0.35)
            box = legend.get_window_extent(self.figure.canvas.get_renderer())
            if box.width / self.figure.dpi / style.MM <= width_mm - 2 or columns == 1:
                return legend, box.height / self.figure.dpi / style.MM + 1.5
            legend.remove()

    def label_y(self, axes, panel, text, shared=True):
        """Labels the first panel of a line; the others get no label and, if `shared`, no numbers."""
        if panel % self.columns == 0:
            axes.set_ylabel(text, labelpad=2)
        elif shared:
            axes.tick_params(labelleft=False)

    def colour_bar(self, mappable, text):
        """In the strip of `bar_mm` above the panels, at the right."""
        axes = self.figure.add_axes(self.bar_box)
        bar = self.figure.colorbar(mappable, cax=axes, orientation="horizontal")
        bar.outline.set_linewidth(0.4)
        low, high = mappable.norm.vmin, mappable.norm.vmax
        if isinstance(mappable.norm, LogNorm):
            ticks = log_ticks(low, high)
            bar.set_ticks(ticks, labels=[texts.number_text(t) for t in ticks])
            bar.ax.xaxis.set_minor_locator(NullLocator())
        bar.ax.tick_params(pad=1.5)
        axes.text(-0.02, 0.5, text, transform=axes.transAxes, ha="right", va="center")

    def label_x(self, row, text):
        """One label, centred under a row of panels."""
        height = self.figure.get_size_inches()[1] / style.MM
        boxes = [axes.get_position() for axes in self.axes[row]]
        middle, bottom = (min(b.x0 for b in boxes) + max(b.x1 for b in boxes)) / 2, min(b.y0 for b in boxes)
        self.figure.text(middle, bottom - (self.ticks_mm - 0.7) / height, text, ha="center", va="top")

    def title(self, axes, text, **text_style):
        """A panel's title: smaller in a narrow panel, on two lines in a very narrow one."""
        width = axes.get_position().width * self.figure.get_size_inches()[0] / style.MM
        size = 7.5 * width / (1.55 * len(text))
        if size < 5.5 and " " in text:
            text = min((text[:k] + "\n" + text[k + 1:] for k, letter in enumerate(text) if letter == " "),
                       key=lambda lines: max(map(len, lines.split("\n"))))
            size = min(5.5, 7.5 * width / (1.55 * max(map(len, text.split("\n")))))
            text_style = {"linespacing": 0.95, "pad": 1.5, **text_style}
        axes.set_title(style.literal(text), fontsize=max(4.5, min(7.5, size)), **text_style)

    def save(self, folder, name, formats=("pdf", "png"), caption=True):
        """Writes a file of each format; returns their paths. The same figure gives the same bytes."""
        width, height = self.figure.get_size_inches()
        box = None if caption else Bbox([[0, self.notes_mm * style.MM], [width, height]])
        paths = [os.path.join(folder, f"{name}.{ending}") for ending in formats]
        for path, ending in zip(paths, formats):
            with outputs.whole(path) as part:
                self.figure.savefig(part, metadata=METADATA[ending], bbox_inches=box)
        plt.close(self.figure)
        return paths


def even_columns(count, most):
    """Number of columns, at most `most`, that distributes `count` panels most evenly."""
    return -(-count // -(-count // most))


def log_ticks(low, high):
    """Few round numbers between the bounds: the coarsest set with at least three of them, else the finest."""
    for leading in ([1], [1, 2, 5], [1, 1.5, 2, 3, 4, 5, 6, 8]):
        ticks = [a * 10.0 ** k for k in range(-30, 31) for a in leading if low <= a * 10.0 ** k <= high]
        if len(ticks) >= 3:
            break
    return ticks[::max(1, len(ticks) // 6)]


def set_ticks(axis, ticks, text=texts.number_text):
    """These ticks alone, each labelled by text(its value)."""
    axis.set_major_locator(FixedLocator(ticks))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(FuncFormatter(lambda value, _: text(value)))


class XAxis:
    """Positions along x and their ticks. Bars get even distances if the values are too dense for them."""

    def __init__(self, points, bars=False):
        values, self.text, self.words = points.position, points.text, points.categorical
        self.log = points.log
        self.even = points.categorical
        scaled = np.log10(values) if self.log else values
        span = float(np.ptp(scaled)) or 1.0
        if bars and not self.even and len(values) > 1 and np.diff(np.sort(scaled)).min() < 0.06 * span:
            self.even, self.log = True, False
        if self.even:
            values = scaled = np.arange(len(values), dtype=float)
            span = max(1.0, float(len(values) - 1))
        self.position, self.scaled, self.span = values, scaled, span
        self.gap = float(np.diff(np.sort(scaled)).min()) if len(values) > 1 else span
        self.margin = 0.62 * self.gap if bars else 0.5 * self.gap if self.even else 0.1 * span
        if len(values) == 1:
            self.margin = span

    def _unscaled(self, scaled):
        return 10 ** scaled if self.log else scaled

    def dodged(self, rank, count):
        """Slightly shifted positions, so that intervals of several lines do not hide each other."""
        width = 0.5 * self.gap if self.even else min(0.05 * self.span, 0.6 * self.gap)
        return self._unscaled(self.scaled + width * (rank / max(1, count - 1) - 0.5))

    def edges(self):
        """Left edges and widths of bars."""
        left, right = (self._unscaled(self.scaled + side * 0.36 * self.gap) for side in (-1, 1))
        return left, right - left

    def apply(self, axes):
        if self.log:
            axes.set_xscale("log")
        axes.set_xlim(*self._unscaled(np.array([self.scaled.min() - self.margin, self.scaled.max() + self.margin])))
        width_mm = axes.get_position().width * axes.figure.get_size_inches()[0] / style.MM
        room = self.gap / (self.span + 2 * self.margin) * width_mm
        needed = CHARACTER_MM * (0.7 + max(map(len, self.text)))
        fits = needed <= room
        if self.even or fits:
            axes.xaxis.set_major_locator(FixedLocator(self.position))
            axes.xaxis.set_minor_locator(NullLocator())
            leaning = {} if fits or not self.words else {"rotation": 25, "ha": "right", "rotation_mode": "anchor"}
            every = 1 if self.words else -(-needed // room)    # only some numbers are labelled
            axes.set_xticklabels([style.literal(text) if k % every == 0 else "" for k, text in enumerate(self.text)],
                                 **leaning)
        elif self.log:
            axes.xaxis.set_major_locator(LogLocator(numticks=5))
            axes.xaxis.set_minor_formatter(NullFormatter())
        else:
            axes.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
