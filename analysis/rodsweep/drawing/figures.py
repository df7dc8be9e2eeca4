"""The figures of spatial.py: CG ratios, speedups and times of a Study along one parameter, a row per panel.

Notes give Newton iterations, norm, tolerance, preconditioner, number of simulations, and what was left out.
"""

import numpy as np
from matplotlib.patches import Patch

from rodsweep.drawing import layout, looks, style
from rodsweep.drawing.study import sample_text
from rodsweep.reading import intervals, measures, remarks, timings

TIME_PARTS = ("assembly", "guess", "CG")
FOUR_CURVES = {"ratio": "CG ratio", "share": "time of the guess ÷ time of its CG",
               "guess_cg": "speedup of guess and CG", "step": "speedup of the whole step"}


def ratio_figure(study, tolerances):
    """CG iterations over those from zero: a panel per tolerance, a line per guess."""
    ratios = measures.cg_counts(study.file, study.sims, study.newton)
    estimates = [[intervals.mean(ratios.ratio[rows], study.sims.sample[rows]) for rows in points.index]
                 for points in study.points]
    lines = study.lines()
    chosen = [(g, t) for g in lines for t in tolerances]
    shown = [e[g, t] for row in estimates for e in row for g, t in chosen]
    open_points = [[_unreached(ratios, rows) for rows in points.index] for points in study.points]
    any_open = any(o[g, t] for row in open_points for o in row for g, t in chosen)
    notes = [f"Iterations with a guess ÷ from zero, summed over a simulation: mean over {sample_text(shown)}. "
             f"Counted: {measures.NEWTON[study.newton]}."]
    if any_open:
        notes.append("Open markers: some of these solves missed the tolerance (iteration limit or divergence); the "
                     "iterations that they used are counted.")
    width = study.width_mm
    page = layout.Page(width, [p.caption() for p in study.panels], len(tolerances), 4 if study.wide else 2,
                      40 if study.wide else 30, study.handles(lines, "zero guess (= 1)"), notes + [study.about()],
                      ticks_mm=_ticks_mm(study))
    top = 1.06 * max([1.0] + [float(np.nanmax([e.value, e.high])) for e in shown if np.isfinite(e.value)])
    for axes_row, points, row, marks in zip(page.axes, study.points, estimates, open_points):
        for k, (axes, t) in enumerate(zip(axes_row, tolerances)):
            _curves(axes, points, [([e[g, t] for e in row], study.style(g), [bool(m[g, t]) for m in marks])
                                   for g in lines], len(lines))
            axes.set_ylim(0, top)
            axes.set_title("tolerance " + style.tolerance_text(study.file.tolerances[t]))
            page.label_y(axes, k, "CG ratio")
    _x_labels(page, study)
    return page


def speedup_figure(study, by_newton):
    """Time of zero-guess CG over the time with a guess, and over `direct`: a panel per definition."""
    against_zero = timings.speedups(by_newton, study.newton)
    direct = timings.direct_speedups(by_newton, study.newton, study.file.zero)
    lines = study.lines()
    rows = []
    for points in study.points:
        rows.append({name: [(intervals.median(against_zero[name][i], study.sims.sample[i]),
                             intervals.median(direct[name][i], study.sims.sample[i])) for i in points.index]
                     for name in timings.SPEEDUPS})
    shown = [e[g] for row in rows for pairs in row.values() for e, _ in pairs for g in lines]
    with_direct = any(np.isfinite(d.value) for row in rows for pairs in row.values() for _, d in pairs)
    whole = "" if study.newton == "all" else "; the whole step has all Newton iterations"
    notes = [f"Time of zero-guess CG ÷ time of the method, sums over a simulation: median over {sample_text(shown)}. "
             f"Counted: {measures.NEWTON[study.newton]}{whole}. "
             f"Solved to tolerance {study.solve_tolerance()}. {remarks.oracle_note(study.file, lines)}"
             f"{timings.interruptions(by_newton['all'], study.sims)}"]
    handles = study.handles(lines, "zero-guess CG (= 1)")
    if with_direct:
        handles.append(style.DIRECT.handle("direct solve"))
    width = study.width_mm
    page = layout.Page(width, [p.caption() for p in study.panels], 3, 3, 40 if study.wide else 34, handles,
                      notes + [study.about()], study.timing_warning(), ticks_mm=_ticks_mm(study))
    shown += [d for row in rows for pairs in row.values() for _, d in pairs]
    limits = _limits(shown, 0.8, 1.25)
    for axes_row, points, row in zip(page.axes, study.points, rows):
        for k, (axes, (name, title)) in enumerate(zip(axes_row, timings.SPEEDUPS.items())):
            curves = [([e[g] for e, _ in row[name]], study.style(g), None) for g in lines]
            curves += [([d for _, d in row[name]], style.DIRECT, None)] * with_direct
            _curves(axes, points, curves, len(lines) + 1)
            _log_axis(axes, limits, "{:g}×")
            axes.set_title(title)
            page.label_y(axes, k, "speedup over zero-guess CG")
    _x_labels(page, study)
    return page


def four_curves_figure(study, by_newton):
    """The curves of Shao et al. 2021, a panel per learned guess: CG ratio, time of the guess over that of its CG, and
    two speedups over CG from zero (guess and CG; whole step). None without a learned guess."""
    learned = [g for g in study.lines() if study.file.guesses[g].removeprefix("first ").startswith("copingnet")]
    if not learned:
        return None
    file, part = study.file, by_newton[study.newton]
    timed = timings.timed_rung(file)[study.sims.any_task]
    ratios = measures.cg_counts(file, study.sims, study.newton).ratio
    speedups = timings.speedups(by_newton, study.newton)
    curves = {"ratio": ratios[np.arange(len(timed)), :, timed], "share": measures.quotient(part.guess_s, part.cg_s),
              "guess_cg": speedups["guess_cg"], "step": speedups["step"]}
    rows = [[{name: (intervals.mean if name == "ratio" else intervals.median)(values[i], study.sims.sample[i])
              for name, values in curves.items()} for i in points.index] for points in study.points]
    shown = [e[g] for row in rows for at in row for e in at.values() for g in learned]
    notes = [f"CG ratio: mean, times: median over {sample_text(shown)}. The time of the guess includes base, features, "
             f"network and products. Counted: {measures.NEWTON[study.newton]}; the whole "
             f"step has all Newton iterations. Solved to tolerance {study.solve_tolerance()}. "
             f"{timings.interruptions(part, study.sims)}"]
    handles = [style.FOUR_CURVES[name].handle(label) for name, label in FOUR_CURVES.items()]
    page = layout.Page(study.width_mm, [p.caption() for p in study.panels], len(learned),
                       layout.even_columns(len(learned), 3 if study.wide else 1), 42, handles,
                       notes + [study.about()], study.timing_warning(), gap_mm=6, ticks_mm=_ticks_mm(study))
    low, high = _limits(shown, 0.5, 2)
    for axes_row, points, row in zip(page.axes, study.points, rows):
        for k, (axes, g) in enumerate(zip(axes_row, learned)):
            _curves(axes, points, [([at[name][g] for at in row], style.FOUR_CURVES[name], None) for name in curves],
                    len(curves))
            _log_axis(axes, (max(low, 1e-3), high), "{:g}")
            page.title(axes, study.file.guesses[g], weight="bold")
            page.label_y(axes, k, "ratio or speedup")
    _x_labels(page, study)
    return page


def time_figure(study, by_newton):
    """Microseconds per segment and solve in stacked parts: a panel per guess, with the direct solve of its systems."""
    part = by_newton[study.newton]
    segments = study.file.results("segments", study.sims.any_task)[:, None, None]
    values = np.stack([part.assemble_s, part.guess_s, part.cg_s, part.assemble_s + part.direct_s,
                       part.assemble_s + part.guess_s + part.cg_s], axis=-1) / part.solves[..., None] / segments * 1e6
    rows = [[intervals.median(values[i], study.sims.sample[i]) for i in points.index] for points in study.points]
    shown = [e[g, 4] for row in rows for e in row for g in study.guesses]
    with_direct = any(np.isfinite(e.value[g, 3]) for row in rows for e in row for g in study.guesses)
    notes = [f"Mean time of a solve in a simulation, per segment, median over {sample_text(shown, ' of the total')}; "
             f"parts in the proportions of their medians. Counted: {measures.NEWTON[study.newton]}. "
             f"Solved to tolerance {study.solve_tolerance()}. CG includes the preconditioner's set-up. "
             f"{remarks.oracle_note(study.file, study.guesses)}{timings.interruptions(part, study.sims)}"]
    handles = [Patch(facecolor=looks.PARTS[name][0], hatch=looks.PARTS[name][1], edgecolor="white", label=name)
               for name in TIME_PARTS]
    if with_direct:
        handles.append(style.DIRECT.handle("assembly + direct solve"))
    width, count = study.width_mm, len(study.guesses)
    columns = layout.even_columns(count, 6 if study.wide else 3)
    page = layout.Page(width, [p.caption() for p in study.panels], count, columns,
                      34 if study.wide else 22, handles, notes + [study.about()], study.timing_warning(), gap_mm=3,
                      ticks_mm=_ticks_mm(study))
    for axes_row, points, row in zip(page.axes, study.points, rows):
        ends = np.array([[e.value[study.guesses, 3:], e.high[study.guesses, 3:]] for e in row])
        top = 1.06 * ends[np.isfinite(ends)].max(initial=0) or 1
        for k, (axes, g) in enumerate(zip(axes_row, study.guesses)):
            x = layout.XAxis(points, bars=True)
            _stack(axes, x, [e[g] for e in row])
            if with_direct:
                _line(axes, x.position, [e[g, 3] for e in row], style.DIRECT, points.categorical, size=2.8)
            axes.set_ylim(0, top)
            page.title(axes, study.file.guesses[g], color=study.style(g).colour, weight="bold")
            axes.grid(axis="x", visible=False)
            x.apply(axes)
            page.label_y(axes, k, "µs per segment and solve")
    _x_labels(page, study)
    return page


def _curves(axes, points, curves, slots):
    """Draws (estimates, style, hollow points or None) side by side in `slots`, and the line at 1."""
    x = layout.XAxis(points)
    axes.axhline(1, zorder=1.5, **style.ZERO_LINE)
    for rank, (estimates, look, hollow) in enumerate(curves):
        _line(axes, x.dodged(rank, slots), estimates, look, points.categorical, hollow)
    x.apply(axes)


def _limits(estimates, low, high):
    """Limits of a logarithmic axis with these values, all estimates and their intervals, and room for a marker."""
    bounds = [low, high, *(v for e in estimates for v in (e.value, e.low, e.high) if np.isfinite(v) and v > 0)]
    room = (max(bounds) / min(bounds)) ** 0.04
    return min(bounds) / room, max(bounds) * room


def _log_axis(axes, limits, text):
    axes.set(yscale="log", ylim=limits)
    layout.set_ticks(axes.yaxis, layout.log_ticks(*limits), text.format)


def _line(axes, x, estimates, guess_style, categorical, hollow=None, size=None):
    """Values with their intervals; no line joins categories."""
    line = {**guess_style.line(), "markersize": size}
    if categorical:
        line["linestyle"] = ""
    container = style.errorbar(axes, x, estimates, **style.WHISKERS, **line)
    if container is None:
        return
    for bar in (*container[1], *container[2]):
        bar.set_alpha(0.75)
    if hollow is not None and any(hollow):
        axes.plot(np.asarray(x)[hollow], [e.value for e, left in zip(estimates, hollow) if left], linestyle="",
                  marker=guess_style.marker, color=guess_style.colour, markerfacecolor="white", markeredgewidth=0.8,
                  zorder=container[0].get_zorder() + 0.1)


def _stack(axes, x, estimates):
    """Bars: the height is the median of the total, the parts have the proportions of their medians."""
    parts = np.array([e.value[:3] for e in estimates])
    total = np.array([e.value[4] for e in estimates])
    parts = parts * measures.quotient(total, parts.sum(axis=1))[:, None]
    left, width = x.edges()
    bottom = np.zeros(len(total))
    for k, name in enumerate(TIME_PARTS):
        colour, hatch = looks.PARTS[name]
        axes.bar(left, parts[:, k], width, bottom=bottom, align="edge", color=colour, hatch=hatch, edgecolor="white",
                 linewidth=0.3)
        bottom = bottom + np.nan_to_num(parts[:, k])
    style.errorbar(axes, x.position, [e[4] for e in estimates], fmt="none", ecolor="#222222",
                   **{**style.WHISKERS, "capsize": 1.2})


def _ticks_mm(study):
    """Space under the panels: words need more, since they may be rotated."""
    longest = max((len(text) for points in study.points if points.categorical for text in points.text), default=0)
    return 5.5 if longest < 5 else min(14, 5 + 0.6 * longest)


def _x_labels(page, study):
    for row, points in enumerate(study.points):
        page.label_x(row, study.x_label() + (f" (median of each of {len(points.index)} bins)" if points.binned else ""))


def _unreached(ratios, rows):
    """[guess, tolerance]: whether any solve of these simulations, from the guess or from zero, missed the tolerance."""
    return (np.nansum(ratios.unreached[rows], axis=0) + np.nansum(ratios.unreached_zero[rows], axis=0)) > 0
