#!/usr/bin/python3
"""CG ratios of networks that differ from a base network in one training setting each.

The results file is a sweep whose learned guesses are these networks, as `jobs/studies.py ablation` trains them. MODELS is the
folder of their model files, named like the guesses. Guesses without a model file go to the end of the table. --base
names the base network. The changed settings are read from the jobs in the model files.

Each setting has a panel: the base and its variants, with a dashed line at the base's ratio. Networks with several
changes share one panel. The table adds the number of weights, the time of a guess per segment and solve, and the ratio
over all Newton iterations. It has a mean over networks that differ only in their seed, with training's randomness.
"""

import os

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, NullLocator

from rodsweep.drawing import layout, study, style
from rodsweep.reading import commandline, intervals, measures, modelfile, texts, timings
from rodsweep.reading.errors import KeyNotFound
from rodsweep.reading.sweepfile import SweepFile

EXAMPLES = """examples:
  analysis/ablation.py results/ablation_bending.h5 results/ablation_bending
  analysis/ablation.py results/ablation_helix.h5 results/ablation_helix --tolerance 1e-1,1e-2 --base base"""
MOST = 1.4    # upper limit of the ratio axis
LABEL_MM = 0.62    # height of a rotated tick label per character


def _key(*path, default):
    """A function that reads a value of a training job."""
    def read(model):
        of = model.job
        for part in path[:-1]:
            of = of.get(part, {})
        return of.get(path[-1], default)
    return read


def _loss(model):
    loss = model.job["training"].get("loss", "energy")
    return ("mse of both" if model.network.get("moves") else "mse of Δλ") if loss == "mse" else loss.replace("_", " ")


def _base(model):
    base = model.network["base"]
    return base + (f" {model.network['base_size']}" if base in ("subspace", "regression") else "")


def _data(model):
    """The variant of the data set: the suffix after SCENE_data in its file name."""
    other = os.path.splitext(os.path.basename(model.job["data"]))[0].partition("_data")[2].strip("_")
    return f"{other} steps" if other.isdigit() else other or "as in Shao et al."


SETTINGS = {    # title of a panel: function that reads the setting of a model; None if its job does not set it
    "training simulations": lambda model: model.learned_from,
    "message-passing steps": lambda model: model.network.get("steps"),
    "latent size": lambda model: model.network["latent"],
    "hidden layers": lambda model: model.network.get("hidden_layers", 1),
    "largest learning rate": _key("training", "rate", default=2e-3),
    "turned copies": _key("training", "turned_copies", default=0),
    "loss": _loss,
    "best length": lambda model: "on" if model.network["best_length"] else "off",
    "global state": lambda model: "on" if model.network.get("globals") else "off",
    "processor": lambda model: model.network["processor"].replace("_", " "),
    "guess beneath": _base,
    "encoding": lambda model: model.network["encoding"],
    "Newton iterations learned": _key("training", "systems", default=None),
    "data": _data,
    "seed": _key("seed", default=0),
}
# Settings that change with another one: other processors have no steps and no moves, and the loss depends on moves.
FOLLOWS = {"processor": ("message-passing steps", "global state", "hidden layers", "loss"), "encoding": ("loss",)}
SEVERAL = "several at once"


def arguments():
    made = study.parser(__doc__, EXAMPLES)
    made.add_argument("models", metavar="MODELS", help="folder of the model files")
    made.add_argument("--base", default="base", help="name of the base model (default: base)")
    return made.parse_args()


def main():
    options = arguments()
    with SweepFile(options.file) as file:
        shown = study.of_guesses(file, options)
        paths = {g: os.path.join(options.models, name_of(file.guesses[g]) + ".h5") for g in shown.lines()}
        models = {g: modelfile.read(path) for g, path in paths.items() if os.path.exists(path)}
        base = next((g for g in models if name_of(file.guesses[g]) == options.base), None)
        if base is None:
            raise KeyNotFound(f"{file.path} has no guess \"copingnet {options.base}\" with a model in "
                              f"{options.models}: name the base model with --base")
        panels = panels_of(models, base)
        tolerances = commandline.chosen_tolerances(file, options)
        ratios = [measures.cg_counts(file, shown.sims, newton).ratio for newton in ("first", "all")]
        first, every = (intervals.mean(ratio, shown.sims.sample) for ratio in ratios)
        print("\n".join(table(shown, models, base, panels, ratios, (first, every), tolerances)) + "\n")
        ratio = first if shown.newton == "first" else every
        study.save(file, options, {"ablation": figure(shown, models, base, panels, ratio, tolerances)})


def name_of(label):
    """Name of a learned guess's model; "" for other guesses."""
    kind, _, name = label.partition(" ")
    return name if kind == "copingnet" else ""


def differences(model, base):
    """{setting: value} that differ from the base, without those that follow another change."""
    found = {what: value for what, read in SETTINGS.items() if (value := read(model)) not in (None, read(base))}
    for what, others in FOLLOWS.items():
        for other in others if what in found else ():
            found.pop(other, None)
    return found


def panels_of(models, base):
    """{setting: [(text of the value, guess)]} with the base: sorted if the values are numbers, else the base first."""
    panels = {}
    for g, model in models.items():
        if g == base:
            continue
        changed = differences(model, models[base])
        what = next(iter(changed)) if len(changed) == 1 else SEVERAL
        value = changed[what] if len(changed) == 1 else ", ".join(text_of(v, alone=False) for v in changed.items())
        panels.setdefault(what, []).append((value, g))
    ordered = {}
    for what in [*SETTINGS, SEVERAL]:
        if what not in panels:
            continue
        values = panels[what] + ([] if what == SEVERAL else [(SETTINGS[what](models[base]), base)])
        numbers = all(isinstance(value, (int, float)) for value, _ in values)
        values = sorted(values, key=lambda v: v[0]) if numbers else values[-1:] + values[:-1] if what != SEVERAL else values
        ordered[what] = [(text_of(value), g) for value, g in values]
    return ordered


def text_of(value, alone=True):
    """Short text of a value or, if not `alone`, of a (setting, value) pair."""
    if not alone:
        what, value = value
        if what == "seed":
            return f"seed {value}"
        return {"on": what.removesuffix(" state"), "all": "all j"}.get(value, text_of(value))
    return "-" if value is None else value if isinstance(value, str) else texts.number_text(value)


def trained_again(models):
    """Groups of at least two guesses whose networks differ only in the seed."""
    groups = {}
    for g, model in models.items():
        of = tuple((what, read(model)) for what, read in SETTINGS.items() if what != "seed")
        groups.setdefault(of, []).append(g)
    return [guesses for guesses in groups.values() if len(guesses) > 1]


def table(shown, models, base, panels, ratios, means, tolerances):
    file = shown.file
    labels = [texts.tolerance_label(file.tolerances[t]) for t in tolerances]
    spent = timings.times(file, shown.sims)["first"] if timings.timed(file) else None
    segments = file.results("segments", shown.sims.any_task)[:, None]
    cost = intervals.median(spent.guess_s / spent.solves / segments * 1e6, shown.sims.sample).value if spent else None

    def row(name, g, ratio):
        weights = str(models[g].parameters) if g in models else ""
        return [f"  {name}", weights] + ([f"{cost[g]:.3f}"] if spent else []) + [
            texts.interval_text(ratio[t], 3) for t in tolerances]

    names = {g: f"{what}: {value}" for what, values in panels.items() for value, g in values} | {base: "base"}

    lines = []
    for newton, values, ratio in zip(("first", "all"), ratios, means):
        rows = [["Guesses", "weights"] + (["us per segment"] if spent else []) + labels, row("base", base, ratio[base])]
        for what in panels:
            rows += [row(names[g], g, ratio[g]) for _, g in panels[what] if g != base]
        for same in trained_again(models):
            rows.append(row(f"{names[same[0]]}, {len(same)} trainings", same[0],
                            intervals.mean_over_trainings(values[:, same], shown.sims.sample)))
        rows += [row(file.guesses[g], g, ratio[g]) for g in shown.lines() if g not in models]
        lines += [f"CG ratio, {measures.NEWTON[newton]}: mean over simulations [95 % interval; of several trainings "
                  "with their randomness]", "", *texts.aligned(rows), ""]
    return lines[:-1]


def figure(shown, models, base, panels, ratio, tolerances):
    file = shown.file
    colours = [look.colour for look in style.series_styles(len(tolerances))]
    handles = [Line2D([], [], color=colour, marker="o", label=f"to {texts.tolerance_label(file.tolerances[t])}")
               for colour, t in zip(colours, tolerances)]
    handles.append(Line2D([], [], color="#777777", linewidth=0.8, linestyle=(0, (4, 2)), label="the base"))
    notes = [f"CG ratio: {measures.NEWTON[shown.newton]}; mean over simulations, {study.sample_text([ratio])}. Open "
             f"markers: the base ({described(models[base])}). All networks took the same number of optimiser steps.",
             shown.about()]
    columns = 5 if shown.wide else 2
    longest = max(len(text) for values in panels.values() for text, _ in values)
    page = layout.Page(shown.width_mm, [""], len(panels), columns, 30, handles, notes, gap_mm=3,
                       ticks_mm=max(12, LABEL_MM * longest))
    for k, (axes, (what, values)) in enumerate(zip(page.axes[0], panels.items())):
        at = np.arange(len(values), dtype=float)
        guesses = [g for _, g in values]
        for colour, t in zip(colours, tolerances):
            axes.axhline(ratio[base, t].value, color=colour, linewidth=0.6, linestyle=(0, (4, 2)), alpha=0.7)
            joined = {} if what in ORDERED else {"linestyle": ""}
            style.errorbar(axes, at, [ratio[g, t] for g in guesses], color=colour, marker="o", markersize=3, zorder=2,
                           **style.WHISKERS, **joined)
            if base in guesses:
                axes.plot(at[guesses.index(base)], ratio[base, t].value, marker="o", markersize=3.6, color=colour,
                          markerfacecolor="white", zorder=3)
        axes.axhline(1, zorder=1.5, **style.ZERO_LINE)
        highest = np.nanmax(ratio.high[[*models]][:, tolerances])
        axes.set(xlim=(-0.6, len(values) - 0.4), ylim=(0, min(MOST, 1.05 * max(1, highest))))
        axes.xaxis.set_major_locator(FixedLocator(at))
        axes.xaxis.set_minor_locator(NullLocator())
        long = max(len(text) for text, _ in values) > 4
        axes.set_xticklabels([style.literal(text) for text, _ in values], fontsize=5.5,
                             **({"rotation": 35, "ha": "right", "rotation_mode": "anchor"} if long else {}))
        page.title(axes, what)
        page.label_y(axes, k, "CG ratio")
    return page


# Settings with ordered values: a line joins their points.
ORDERED = ("training simulations", "message-passing steps", "latent size", "hidden layers", "largest learning rate",
           "turned copies")


def described(model):
    network = model.network
    return (f"encoding {network['encoding']}, {network['processor'].replace('_', ' ')} with {network.get('steps', '?')} steps, "
            f"latent size {network['latent']}, {_loss(model)}, {model.learned_from} simulations")


if __name__ == "__main__":
    commandline.run(main)
