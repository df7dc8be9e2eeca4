#!/usr/bin/python3
"""Losses and CG ratios on validation simulations by epoch, as figure and table.

The first panel has the training loss (dotted: while the weights changed) and the validation loss; a dot marks the
epoch of the model's weights. Each tolerance has a panel of the CG ratio: CG iterations from the network's guess over
those from zero. Iterations are summed over a validation simulation's first Newton iterations, ratios are averaged over
simulations. A dashed line is the ratio of the base guess that the network corrects, a star that of the model. The last
panel has the learning rate. Several models are drawn together, but losses of different kinds cannot be compared. A
running training is shown up to its last epoch.
"""

import os

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, MaxNLocator, NullLocator

from rodsweep.drawing import layout, study, style
from rodsweep.reading import commandline, modelfile, texts

EXAMPLES = """examples:
  analysis/loss.py results/train_rods.h5
  analysis/loss.py results/train_rods.h5 results/train_rods_large.h5 -o figures --width 84"""


def arguments():
    made = commandline.plain_parser(__doc__, EXAMPLES)
    made.add_argument("files", nargs="+", metavar="MODEL", help="model file of `rodsweep run` with a job of kind \"train\"")
    study.add_figure_arguments(made)
    made.set_defaults(scene=None, newton="first")
    return made.parse_args()


def main():
    options = arguments()
    trainings = [modelfile.read(path) for path in options.files]
    print("\n".join(table(trainings)) + "\n")
    name = f"and-{len(trainings) - 1}-more-loss" if len(trainings) > 1 else "loss"
    study.save(trainings[0], options, {name: figure(trainings, options.width)})


def labels(trainings):
    """Names of the jobs, or of the files if job names repeat."""
    names = [t.name for t in trainings]
    return names if len(set(names)) == len(names) else [os.path.splitext(os.path.basename(t.path))[0] for t in trainings]


def table(trainings):
    tolerances = trainings[0].tolerances
    rows = [["", "epochs", "kept", "validation loss", "seconds"] +
            [f"CG ratio at {texts.tolerance_label(t)}" for t in tolerances]]
    for label, t in zip(labels(trainings), trainings):
        rows.append([label + ("" if t.ended else " (has not ended)"), str(len(t.epochs)), str(t.best_epoch),
                     f"{t.best_loss:.4g}", f"{t.seconds:.0f}"] + ratio_texts(t.kept_ratio))
        rows.append(["  its base guess alone", "", "", "", ""] + ratio_texts(t.base_ratio))
        for scene, (kept, base) in t.scenes.items():
            name = scene.replace("_", " ")
            rows.append([f"  {name}", "", "", "", ""] + ratio_texts(kept))
            rows.append([f"  {name}, base", "", "", "", ""] + ratio_texts(base))
    return texts.aligned(rows)


def ratio_texts(ratios):
    return [f"{r:.3f}" if np.isfinite(r) else "-" for r in ratios]


def figure(trainings, width_mm):
    looks = style.series_styles(len(trainings))
    handles = [Line2D([], [], label=style.literal(label), color=look.colour, marker=look.marker)
               for label, look in zip(labels(trainings), looks)]
    grey = {"color": "#555555"}
    handles += [Line2D([], [], label="training loss", linestyle=(0, (1, 1.2)), **grey),
                Line2D([], [], label="base guess alone", linestyle=(0, (4, 2)), linewidth=0.8, **grey)]
    tolerances = trainings[0].tolerances
    wide = width_mm > 100
    page = layout.Page(width_mm, [""], len(tolerances) + 2, 3 if wide else 2, 34 if wide else 30, handles,
                       [about(trainings)], gap_mm=9, left_mm=10, ticks_mm=8.5)
    loss, *ratios, rate = page.axes[0]
    _losses(loss, trainings, looks)
    for k, axes in enumerate(ratios):
        _ratios(axes, k, trainings, looks)
        axes.set_title(f"CG ratio at {style.tolerance_text(tolerances[k])}")
    for training, look in zip(trainings, looks):
        rate.plot(training.epochs, training.rate, color=look.colour)
    rate.set_title("learning rate")
    rate.yaxis.set_major_formatter(FuncFormatter(lambda value, _: texts.number_text(value)))
    rate.yaxis.set_major_locator(MaxNLocator(3))
    rate.set_ylim(0, 1.08 * max(t.rate.max() for t in trainings))
    last = max(t.epochs[-1] for t in trainings)
    for axes in page.axes[0]:
        axes.set_xlabel("epoch", labelpad=1.5)
        axes.set_xlim(0 if last > 1 else 0.5, last * 1.03)
        axes.xaxis.set_major_locator(MaxNLocator(5, integer=True))
    return page


def about(trainings):
    counts = texts.range_text([t.simulations for t in trainings])
    text = (f"CG ratio: iterations from the network's guess over those from zero, first Newton iterations (j = 0), jacobi, "
            f"true residual; mean over {counts} validation simulations. Stars, dots: the kept model, from the epoch "
            "with the smallest validation loss.")
    running = [label for label, t in zip(labels(trainings), trainings) if not t.ended]
    return text + (f" Still running: {', '.join(running)}." if running else "")


def _losses(axes, trainings, looks):
    axes.set_yscale("log")
    for t, look in zip(trainings, looks):
        axes.plot(t.epochs, t.training_loss, color=look.colour, linestyle=(0, (1, 1.2)), linewidth=0.8)
        axes.plot(t.epochs, t.validation_loss, color=look.colour)
        axes.plot([t.best_epoch], [t.best_loss], color=look.colour, marker="o", linestyle="")
    values = np.concatenate([v for t in trainings for v in (t.training_loss, t.validation_loss)])
    ticks = layout.log_ticks(values.min() / 1.2, values.max() * 1.2)
    axes.set_ylim(values.min() / 1.2, values.max() * 1.2)
    axes.set_yticks(ticks, labels=[texts.number_text(tick) for tick in ticks])
    axes.yaxis.set_minor_locator(NullLocator())
    axes.set_title("validation and training loss")


def _ratios(axes, k, trainings, looks):
    top = 0
    for t, look in zip(trainings, looks):
        measured = np.isfinite(t.cg_ratio[:, k])
        axes.plot(t.epochs[measured], t.cg_ratio[measured, k], color=look.colour, marker=look.marker, markersize=2.2)
        if np.isfinite(t.base_ratio[k]):
            axes.axhline(t.base_ratio[k], color=look.colour, linestyle=(0, (4, 2)), linewidth=0.8)
            axes.plot([t.best_epoch], [t.kept_ratio[k]], color=look.colour, marker="*", markersize=6, linestyle="")
        shown = np.concatenate([t.cg_ratio[measured, k], [t.base_ratio[k], t.kept_ratio[k]]])
        top = np.nanmax([top, *shown])
    axes.set_ylim(0, 1.08 * top if top > 0 else 1)


if __name__ == "__main__":
    commandline.run(main)
