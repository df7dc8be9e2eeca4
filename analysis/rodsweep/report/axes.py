"""Estimates of a family's measures at the points along every axis, panel by panel, packed for the page.

Axes are the parameters that the job sweeps: first grids, then random ones in bins, as long as the estimates fit into a
budget. The others are listed in `left_out`. Estimates are flat arrays in the order Newton iterations, points, lines,
tolerances, rounded to visible precision; None stands for a missing value.
"""

import math

import numpy as np

from rodsweep.reading import groups, texts

SCENE = "scene.type"
PREFERRED = "scene.segments"
MOST_PANELS = 60
POOLED = {"guesses": (), "methods": ("solve.",)}   # keys that give lines instead of panels


class Budget:
    """Remaining budget of a page, in estimates or in bytes."""

    def __init__(self, left, whole=None):
        self.left, self.whole = left, whole

    def takes(self, count):
        if count > self.left:
            return False
        self._spend(count)
        return True

    def share(self, parts):
        """One of `parts` equal shares; spending from it also spends from the whole."""
        return Budget(self.left / parts, self)

    def _spend(self, count):
        self.left -= count
        if self.whole is not None:
            self.whole._spend(count)


def packed(file, family, budget, wanted=()):
    """The family in the form that the page reads. `wanted`: the axes that the user asked for, without a budget. An
    axis needs several points in most panels; without any axis, the scene type is one."""
    keys = [key for key in wanted if key in candidates(file, family.sims)]
    if keys:
        budget = Budget(math.inf)
    axes, left_out = [], []
    for key in keys or candidates(file, family.sims):
        axis = _axis(file, family, key, budget)
        if axis is None:
            left_out.append(key)
        elif sum(len(panel["x"]) > 1 for panel in axis["panels"]) > len(axis["panels"]) / 2:
            axes.append(axis)
    if not axes and SCENE in file.parameters:
        axis = _axis(file, family, SCENE, budget)
        axes = [axis] if axis is not None else []
    return {"name": family.name,
            "reference": list(family.lines).index(family.reference) if family.reference else None,
            "measures": [{"name": m.name, "title": m.title, "unit": m.unit, "log": m.log, "newton": list(m.values),
                          "tolerances": m.tolerances, "note": m.note} for m in family.measures],
            "axes": axes, "left_out": left_out}


def candidates(file, sims):
    """Keys that can be an axis, the most useful first."""
    tasks = sims.any_task
    gridded, distinct, common = groups.gridded_keys(file, tasks, None), {}, set()
    for parameter in file.parameters.values():
        applies = parameter.applies()[tasks]
        if (parameter.swept or parameter.name == SCENE) and parameter.name != "guess" and applies.any():
            distinct[parameter.name] = len(np.unique(parameter.codes()[tasks][applies]))
            common |= {parameter.name} if applies.all() else set()

    def rank(key):
        return (key != PREFERRED, key not in gridded, key not in common, not file.parameters[key].numeric,
                -distinct[key])

    return sorted((key for key, count in distinct.items() if count > 1), key=rank)


def _axis(file, family, key, budget):
    """None if it has too many panels or does not fit into the budget."""
    parameter = file.parameter(key)
    rows = groups.applicable(file, family.sims, key)
    sims = family.sims.subset(rows)
    pooled = POOLED[family.name] + (("scene.",) if key == SCENE else ())     # as the tables pool over a scene
    panels = groups.panels(file, sims, key, pooled, most=None)
    points = [groups.points(file, sims, panel, key) for panel in panels]
    count = sum(len(of_panel.index) for of_panel in points) * sum(map(_estimates, family.measures))
    if len(panels) > MOST_PANELS or not budget.takes(count):
        return None
    keys = {name: None for panel in panels for name in panel.settings}
    return {"key": key, "label": texts.parameter_label(key, parameter.unit),
            "categorical": any(of_panel.categorical for of_panel in points),
            "binned": any(of_panel.binned for of_panel in points),
            "log": any(of_panel.log for of_panel in points),
            "settings": [{"key": name, "label": texts.parameter_label(name, file.parameter(name).unit)}
                         for name in keys],
            "panels": [_panel(family, rows, *one) for one in zip(panels, points)]}


def _panel(family, rows, panel, points):
    index = [rows[some] for some in points.index]
    return {"scene": panel.scene, "caption": panel.caption(), "settings": panel.settings,
            "x": _rounded(points.position), "text": points.text, "simulations": [len(some) for some in index],
            "values": {measure.name: _values(measure, family.sims, index) for measure in family.measures}}


def _estimates(measure):
    some = next(iter(measure.values.values()))
    return len(measure.values) * some[:1].size


def _values(measure, sims, index):
    """[value, low, high, count] as flat lists; a constant count is one number."""
    found = [measure.estimate(values[some], sims.sample[some]) for values in measure.values.values() for some in index]
    numbers = [np.concatenate([getattr(estimate, name).ravel() for estimate in found])
               for name in ("value", "low", "high", "count")]
    value, low, high, count = (_rounded(part, digits) for part, digits in zip(numbers, (4, 3, 3, 9)))
    return [value, low, high, count[0] if len(set(count)) == 1 else count]


def _rounded(numbers, digits=6):
    """Numbers rounded to `digits` digits; None if not finite."""
    short = (float(f"{number:.{digits}g}") for number in np.ravel(numbers))
    return [None if not math.isfinite(number) else int(number) if number == int(number) else number for number in short]
