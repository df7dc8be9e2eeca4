"""The numbers of summary.py: all measurements of a group of simulations, also as flat records."""

from dataclasses import dataclass

import numpy as np

from rodsweep.reading import groups, intervals, measures, texts, timings

TIMES = ("assemble_us", "guess_us", "cg_us", "direct_us")
# The fields of records().
COLUMNS = ("scene", "settings", "newton", "quantity", "guess", "tolerance", "value", "low", "high", "simulations",
           "unreached_solves")
# Further CG ratios beside that of the first or of all Newton iterations: which iterations, and what is counted.
BESIDE = {"first": {"products": ("first", "matvecs"), "all": ("all", "iterations"), "all_products": ("all", "matvecs")},
          "all": {"products": ("all", "matvecs")}}


@dataclass(frozen=True)
class Block:
    """Estimates over the simulations of a group; None if the file does not have the data."""
    title: str
    scene: str
    settings: dict
    sims: measures.Simulations
    ratio: intervals.Estimate = None             # [guess, tolerance]
    beside: dict = None                          # name in BESIDE: Estimate [guess, tolerance] of a further ratio
    zero_iterations: np.ndarray = None           # [tolerance] per solve from zero; None for all Newton iterations
    unreached: np.ndarray = None                 # [guess, tolerance] solves
    speedup: dict = None                         # definition: Estimate [guess], over zero-guess CG
    speedup_over_direct: dict = None             # the same over the direct solve
    direct_speedup: dict = None                  # definition: Estimate, of the direct solve over zero-guess CG
    guess_share: np.ndarray = None               # [guess] median of the guess's part of the time of guess and CG
    times: dict = None                           # assemble_us, guess_us, cg_us, direct_us per solve: Estimate [guess]
    direct_times: dict = None                    # without guesses: assemble_us, direct_us per solve: Estimate
    interruptions: str = ""                      # what was left out of the times
    steps: dict = None                           # name: Estimate [guess] and largest [guess]


def blocks(file, sims, by, newton):
    """One Block per scene type, gridded key outside `scene`, and value of the key `by`."""
    panels = groups.panels(file, sims, by, pooled="scene.", most=None)
    found = []
    for panel in panels:
        if by is None:
            found.append(_measured(file, sims, panel.title(), panel, panel.settings, panel.index, newton))
            continue
        points = groups.points(file, sims, panel, by)
        for text, index in zip(points.text, points.index):
            value = f"about {text}" if points.binned else text
            found.append(_measured(file, sims, f"{panel.title()}, {by} = {value}", panel, {**panel.settings, by: text},
                                   index, newton))
    return found


def step_measures(found):
    """The measures.OF_STEPS that any of these Blocks has."""
    return {name: measure for name, measure in measures.OF_STEPS.items() if any(name in block.steps for block in found)}


def step_rows(found, guesses, labels):
    """[(title, {name: (median, largest), as texts})]: a row per Block, in a closed loop per Block and guess."""
    return [(f"{block.title}, {labels[g]}" if block.sims.closed_loop else block.title,
             {name: [texts.short_text(of[g], 2) for of in (estimate.value, largest)]
              for name, (estimate, largest) in block.steps.items()})
            for block in found for g in (guesses if block.sims.closed_loop and guesses else [0])]


def _measured(file, sims, title, panel, settings, index, newton):
    sims = sims.subset(index)
    parts = {"steps": _steps(file, sims)}
    if measures.has_guesses(file)[sims.any_task].all():
        parts.update(_ratios(file, sims, newton))
        if timings.timed(file):
            parts.update(_times(file, sims, newton))
    else:
        direct = timings.direct_times(file, sims)
        if np.isfinite(direct["direct_us"]).any():
            parts["direct_times"] = {name: e[0] for name, e in intervals.medians(direct, sims.sample).items()}
    return Block(title, panel.scene, settings, sims, **parts)


def _steps(file, sims):
    figures = measures.step_figures(file, sims)
    there = {name: values for name, values in figures.items() if np.isfinite(values).any()}
    if not sims.closed_loop:  # one trajectory for all guesses
        there = {name: values[:, :1] for name, values in there.items()}
    guesses = sims.task.shape[1]
    return {name: (estimate.broadcast(guesses), np.broadcast_to(np.fmax.reduce(there[name], axis=0), guesses))
            for name, estimate in intervals.medians(there, sims.sample).items()}


def _ratios(file, sims, newton):
    if file.zero is None:
        return {}
    ratios = measures.cg_counts(file, sims, newton)
    beside = {name: intervals.mean(measures.cg_counts(file, sims, of, counted).ratio, sims.sample)
              for name, (of, counted) in BESIDE[newton].items()}
    per_solve = intervals.mean(ratios.per_solve[:, file.zero], resamples=0).value
    return {"ratio": intervals.mean(ratios.ratio, sims.sample), "unreached": np.nansum(ratios.unreached, axis=0),
            "zero_iterations": per_solve if newton == "first" else None,
            "beside": {name: estimate for name, estimate in beside.items() if np.isfinite(estimate.value).any()}}


def _times(file, sims, newton):
    by_newton = timings.times(file, sims)
    part = by_newton[newton]
    timed = {"times": per_solve_us(part), "speedup_over_direct": timings.speedups(by_newton, newton, "direct")}
    if file.zero is not None:
        timed["speedup"] = timings.speedups(by_newton, newton)
        timed["direct_speedup"] = timings.direct_speedups(by_newton, newton, file.zero)
    found = intervals.medians({(kind, name): v for kind, of in timed.items() for name, v in of.items()}, sims.sample)
    share = measures.quotient(part.guess_s, part.guess_s + part.cg_s)
    return {"interruptions": timings.interruptions(by_newton["all"], sims), "guess_share": measures.median_of_finite(share),
            **{kind: {name: found[kind, name] for name in of} for kind, of in timed.items()}}


def per_solve_us(part):
    """{name of TIMES: [simulation, guess]}: mean time of a solve in a simulation, from a timings.Times."""
    return {name: getattr(part, name.replace("_us", "_s")) / part.solves * 1e6 for name in TIMES}


def records(file, block, guesses, tolerances, newton):
    """Flat dictionaries, one per number, for CSV and JSON."""
    common = {"scene": block.scene, "settings": "; ".join(f"{k}={v}" for k, v in block.settings.items()),
              "newton": newton}

    def record(quantity, estimate, guess="", tolerance="", unreached=""):
        return {**common, "quantity": quantity, "guess": guess, "tolerance": tolerance, "value": float(estimate.value),
                "low": float(estimate.low), "high": float(estimate.high), "simulations": int(estimate.count),
                "unreached_solves": unreached}

    labels = file.guesses or ["direct"]
    guesses = guesses or [0]
    found = []
    if block.ratio is not None:
        found += [record("cg_ratio", block.ratio[g, t], labels[g], float(file.tolerances[t]),
                         int(block.unreached[g, t]))
                  for g in guesses for t in tolerances]
        found += [record(f"cg_ratio_{name}", estimate[g, t], labels[g], float(file.tolerances[t]))
                  for name, estimate in block.beside.items() for g in guesses for t in tolerances]
    timed = [("speedup_", block.speedup), ("speedup_over_direct_", block.speedup_over_direct), ("", block.times)]
    found += [record(prefix + name, estimate[g], labels[g]) for prefix, estimates in timed if estimates
              for name, estimate in estimates.items() for g in guesses]
    if block.direct_speedup:
        found += [record("speedup_" + name, estimate, "direct") for name, estimate in block.direct_speedup.items()]
    if block.direct_times:
        found += [{**record(name, estimate, "direct"), "newton": "all"}
                  for name, estimate in block.direct_times.items()]
    for name, (estimate, largest) in block.steps.items():
        rows = guesses if block.sims.closed_loop else guesses[:1]
        for g in rows:
            label = labels[g] if block.sims.closed_loop else ""
            found.append({**record(f"{name}_median", estimate[g], label), "newton": "all"})
            found.append({**record(f"{name}_largest", estimate[g], label), "newton": "all",
                          "value": float(largest[g]), "low": float("nan"), "high": float("nan")})
    return found
