#!/usr/bin/python3
"""Heat maps of a sweep over two parameters: a CG ratio, speedup, iterations or residual in every cell.

  --measure ratio            CG iterations relative to the zero guess (default)
            matvec-ratio     products with A instead, including those of the guess
            other-norm-ratio CG ratio with the residual test in the norm that the job does not use
            speedup-cg, speedup-guess-cg, speedup-step
                             time of zero-guess CG over the time with a guess
            iterations       CG iterations of a solve from zero
            newton-residual, joint-gap
                             largest at the end of a step

--x and --y name keys of the job, or `tolerance`: the tolerances that iterations are counted to. A cell shows the best
guess and its name. The oracle, which knows the solution, only takes part if --guess names it. --each draws a panel per
guess instead. Each value of any other grid has a panel. Writes PDF and PNG and prints the paths.
"""

import numpy as np
from matplotlib import colors
from matplotlib.cm import ScalarMappable
from matplotlib.patches import Rectangle

from rodsweep.drawing import layout, looks, study, style
from rodsweep.reading import commandline, groups, heat, measures, texts
from rodsweep.reading.errors import KeyNotFound
from rodsweep.reading.sweepfile import SweepFile

EXAMPLES = """examples:
  analysis/heatmap.py results/generalisation_step.h5 --x time.step_s --y tolerance
  analysis/heatmap.py results/stiffness.h5 --x scene.youngs_modulus_pa --y scene.segments --measure speedup-step
  analysis/heatmap.py results/stiffness.h5 --x scene.segments --y tolerance --guess quadratic
  analysis/heatmap.py results/spatial_bending.h5 --x scene.segments --y solve.preconditioner --measure iterations"""
MOST_PANELS = 12


def arguments():
    made = study.parser(__doc__, EXAMPLES)
    made.add_argument("--x", metavar="KEY", required=True, help="parameter along x, or `tolerance`")
    made.add_argument("--y", metavar="KEY", required=True, help="parameter along y, or `tolerance`")
    made.add_argument("--measure", choices=list(heat.MEASURES), default="ratio", help="default: ratio")
    made.add_argument("--each", action="store_true", help="one panel per guess instead of the best guess")
    return made.parse_args()


def main():
    options = arguments()
    with SweepFile(options.file) as file:
        shown, tolerances, guesses = chosen(file, options)
        sets = [[g] for g in guesses] if options.each else [guesses]
        found = [heat.planes(shown, options.measure, options.x, options.y, some, tolerances) for some in sets]
        planes = [plane for same in zip(*found) for plane in same]
        if len(planes) > MOST_PANELS:
            raise KeyNotFound(f"{len(planes)} panels are too many for a page (at most {MOST_PANELS}): choose with "
                              "--scene TYPE, --select KEY=VALUE or --guess LABEL")
        page = figure(shown, options, planes, guesses, tolerances)
        names = [key.rsplit(".", 1)[-1] for key in (options.x, options.y)]
        alone = heat.MEASURES[options.measure].ladder and heat.LADDER not in (options.x, options.y)
        study.save(file, options, {f"heatmap-{options.measure}": page},
                   ["-".join(names), "each" if options.each else "",
                    texts.tolerance_label(file.tolerances[tolerances[0]]) if alone else ""])


def chosen(file, options):
    """The Study, the tolerances and the guesses of the cells. Raises KeyNotFound if the options give no map."""
    measure = heat.MEASURES[options.measure]
    if options.x == options.y:
        raise KeyNotFound(f"--x and --y are both {options.x}: a map needs two parameters")
    laddered = heat.LADDER in (options.x, options.y)
    if laddered and not measure.ladder:
        raise KeyNotFound(f"--measure {options.measure} has values only at the job's tolerance: sweep solve.tolerance "
                          "in the job and give it as an axis instead of `tolerance`")
    if measure.of_guess or measure.ladder:
        shown = study.of_guesses(file, options)
    else:
        shown = study.of_tasks(file, options)
    for key in (options.x, options.y):
        if key != heat.LADDER:
            shown.sims = shown.sims.subset(groups.applicable(file, shown.sims, key))
    if laddered and not shown.sims.closed_loop and "solve.tolerance" in file.parameters:
        # In a paired sweep, counts do not depend on the tolerance of the timed solves.
        timed = file.parameters["solve.tolerance"].values[shown.sims.any_task]
        if (timed != timed[0]).any():
            shown.sims = shown.sims.subset(timed == timed.min())
            said = "counts do not depend on solve.tolerance, so tasks of one value are shown"
            shown.left_out = "; ".join(filter(None, [shown.left_out, said]))
    tolerances = commandline.chosen_tolerances(file, options) if measure.ladder else [0]
    if measure.ladder and not laddered:
        if len(tolerances) > 1 and options.tolerance:
            raise KeyNotFound("a cell shows one tolerance: give one with --tolerance, or `tolerance` as --x or --y")
        tolerances = tolerances if options.tolerance else [file.tolerance_index(1e-2)]
    guesses = shown.lines() if options.guess else heat.comparable(file, shown.guesses)
    if measure.of_guess and not guesses:
        raise KeyNotFound(f"no guess to compare with zero among {', '.join(file.guesses)}")
    if not measure.of_guess:
        guesses = shown.guesses[:1]
    return shown, tolerances, guesses


def figure(shown, options, planes, guesses, tolerances):
    file, measure = shown.file, heat.MEASURES[options.measure]
    tall = max(len(plane.y.index) for plane in planes)
    wide = max(len(plane.x.index) for plane in planes)
    columns = layout.even_columns(len(planes), most_columns(shown.width_mm, planes))
    lead = max(len(text) for plane in planes for text in (plane.y.text if plane.y.categorical else
                                                         map(texts.number_text, plane.y.position)))
    left = 8 + 1.25 * lead
    cell_mm = ((shown.width_mm - 2 - columns * left) / columns) / wide
    height = tall * min(max(8.5, 0.5 * cell_mm), 14)
    page = layout.Page(shown.width_mm, [heading(measure, options, file, tolerances)], len(planes), columns, height, [],
                       notes(shown, options, planes, guesses), shown.timing_warning() if measure.timed else "",
                       left_mm=left, gap_mm=left, panel_titles_mm=5, ticks_mm=9, bar_mm=9)
    norm, colormap = scale(measure, planes)
    for k, (axes, plane) in enumerate(zip(page.axes[0], planes)):
        draw(axes, plane, file, measure, norm, colormap,
             measure.of_guess and len(guesses) > 1 and not options.each, cell_mm)
        title = plane.panel.caption()
        if options.each:
            title = file.guesses[guesses[k % len(guesses)]] + (f" · {title}" if len(planes) > len(guesses) else "")
        page.title(axes, title, weight="bold")
        axes.set_xlabel(axis_label(file, options.x, plane.x), labelpad=1.5)
        page.label_y(axes, k, axis_label(file, options.y, plane.y), shared=False)
    page.colour_bar(ScalarMappable(norm, colormap), measure.label if shown.wide else "")
    return page


def most_columns(width_mm, planes):
    """Largest number of panels side by side whose cells have room for a number."""
    cells = max(len(plane.x.index) for plane in planes)
    return max(1, min(4, int(width_mm / (14 + 9.5 * cells))))


def heading(measure, options, file, tolerances):
    text = measure.label[0].upper() + measure.label[1:]
    if measure.ladder and heat.LADDER not in (options.x, options.y):
        text += f" at tolerance {texts.tolerance_label(file.tolerances[tolerances[0]])}"
    return text


def axis_label(file, key, points):
    if key == heat.LADDER:
        return "tolerance"
    return texts.parameter_label(key, file.parameter(key).unit) + (" (bin medians)" if points.binned else "")


def notes(shown, options, planes, guesses):
    measure = heat.MEASURES[options.measure]
    sample = study.sample_text([plane.cells for plane in planes], " exclude 1" if measure.better else "",
                               "bold" if measure.better else "", "cell")
    text = f"{measure.explained}: {measure.statistic} over {sample}. "
    if measure.of_guess or measure.ladder:
        text += f"Counted: {measures.NEWTON[shown.newton]}. "
    if measure.timed:
        text += f"Solved to tolerance {shown.solve_tolerance()}. "
    if measure.of_guess and len(guesses) > 1 and not options.each:
        text += "Each cell shows the best of " + ", ".join(shown.file.guesses[g] for g in guesses) + ". "
    if any(plane.unreached.any() for plane in planes):
        text += "*: some of these solves missed the tolerance; the iterations that they used are counted."
    return [text, shown.about()]


def scale(measure, planes):
    """Norm and colours: diverging about 1 for a comparison with zero (blue is better), else sequential."""
    values = np.concatenate([plane.cells.value.ravel() for plane in planes])
    values = values[np.isfinite(values) & (values > 0)]
    if not measure.better:
        low, high = (values.min(), values.max()) if len(values) else (0.1, 1)
        if high < 1.02 * low:
            low, high = low / 1.5, high * 1.5
        return (colors.LogNorm if high > 30 * low else colors.Normalize)(low, high), style.SEQUENTIAL
    low, high = (min(values.min(), 0.8), max(values.max(), 1.25)) if len(values) else (0.8, 1.25)
    reach = np.log(max(high, 1 / low))
    # The colours cover the range of the values; a factor above 1 and its inverse have the same strength.
    part = np.linspace(*(0.5 + 0.5 * np.log(end) / reach for end in (low, high)), 256)
    both = style.DIVERGING if measure.better < 0 else style.DIVERGING.reversed()
    return colors.LogNorm(low, high), colors.ListedColormap(both(part))


def draw(axes, plane, file, measure, norm, colormap, with_names, cell_mm):
    rows, columns = plane.cells.value.shape
    axes.set(xlim=(0, columns), ylim=(0, rows))
    axes.grid(False)
    for y, x in np.ndindex(rows, columns):
        value, low, high = (float(part[y, x]) for part in (plane.cells.value, plane.cells.low, plane.cells.high))
        known = np.isfinite(value)
        face = colormap(norm(value)) if known else "#ffffff"
        axes.add_patch(Rectangle((x, y), 1, 1, facecolor=face, edgecolor="white", linewidth=0.8,
                                 hatch=None if known else "////"))
        if not known:
            continue
        ink = "white" if looks.luminance(face) < 0.2 else "black"
        sure = bool(measure.better) and np.isfinite(low) and (low > 1 or high < 1)
        name = file.guesses[plane.guess[y, x]] if with_names else ""
        size = min(7, 7 * cell_mm / 8)
        axes.text(x + 0.5, y + (0.62 if name else 0.5), cell_text(value) + ("*" if plane.unreached[y, x] else ""),
                  ha="center", va="center", color=ink, fontsize=size, weight="bold" if sure else "normal")
        if name:
            axes.text(x + 0.5, y + 0.27, style.literal(name), ha="center", va="center", color=ink,
                      fontsize=min(5.5, 2.83 * cell_mm / (0.62 * max(4, len(name)))))
    for axis, points in ((axes.xaxis, plane.x), (axes.yaxis, plane.y)):
        text = points.text if points.categorical else [texts.number_text(value) for value in points.position]
        axis.set_ticks(np.arange(len(text)) + 0.5, map(style.literal, text))
        axis.set_tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)


def cell_text(value):
    """Two or three digits: 0.42, 1.7, 23, 4e-6."""
    if 0.01 <= value < 10:
        return f"{value:.2f}"
    if 10 <= value < 1000:
        return f"{value:.0f}" if value >= 100 else f"{value:.1f}"
    return texts.number_text(float(f"{value:.1e}"))


if __name__ == "__main__":
    commandline.run(main)
