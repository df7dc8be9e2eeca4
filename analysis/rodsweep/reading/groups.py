"""Groups simulations of a sweep into panels and points of a figure, or into blocks of a table.

A key of the job is *gridded* if it varies while scene type, x and draw are the same. A key that only varies with the
draw is random and is averaged over. Simulations that differ in a gridded key are never averaged: they go to separate
panels. (A table over all of a scene type pools keys of the scene, never those of time or solve.)
"""

from dataclasses import dataclass, replace

import numpy as np

from rodsweep.reading import texts
from rodsweep.reading.errors import KeyNotFound

MOST_PANELS = 6
MOST_POINTS = 14   # more distinct values of x than this are binned
BINS = 8
LOG_SPAN = 20      # positive x whose largest value exceeds the smallest by this factor get a logarithmic axis


@dataclass(frozen=True)
class Panel:
    scene: str
    settings: dict        # gridded keys other than x: text of their value
    index: np.ndarray     # rows of Simulations
    words: tuple = ()     # the settings in words

    def without(self, keys):
        """The same panel without some settings."""
        kept = [(item, word) for item, word in zip(self.settings.items(), self.words) if item[0] not in keys]
        return replace(self, settings=dict(item for item, _ in kept), words=tuple(word for _, word in kept))

    def title(self):
        """For tables: settings with keys, as --select takes them."""
        return ", ".join([self._name()] + [f"{key} = {value}" for key, value in self.settings.items()])

    def caption(self):
        """For figures: settings in words."""
        return ", ".join([self._name(), *self.words])

    def _name(self):
        return self.scene.replace("_", " ").capitalize()


@dataclass(frozen=True)
class Points:
    """The points along x of one panel: position, tick text and rows of Simulations."""
    position: np.ndarray
    text: list
    index: list
    categorical: bool
    binned: bool

    @property
    def log(self):
        low, high = self.position.min(), self.position.max()
        return bool(not self.categorical and low > 0 and high > LOG_SPAN * low)


def gridded_keys(file, tasks, x, pooled=""):
    """Keys that vary within (scene type, x, draw) over these tasks, without those that begin with `pooled` (one text
    or a tuple).

    x is one key, several in a tuple, or None."""
    axes = _keys(x)
    fixed = [file.sample[tasks]]
    fixed += [file.parameters[key].codes()[tasks] for key in ("scene.type", *axes) if key in file.parameters]
    order = np.lexsort(fixed)
    same = np.ones(max(0, len(tasks) - 1), dtype=bool)
    for codes in fixed:
        same &= codes[order][1:] == codes[order][:-1]
    found = []
    for parameter in file.parameters.values():
        if not parameter.swept or parameter.name in ("scene.type", "guess", *axes):
            continue
        if pooled and parameter.name.startswith(pooled):
            continue
        codes = parameter.codes()[tasks][order]
        if ((codes[1:] != codes[:-1]) & same).any():
            found.append(parameter.name)
    return found


def panels(file, sims, x=None, pooled="", most=MOST_PANELS):
    """Panels by scene type and gridded keys, in the order of the tasks. Raises KeyNotFound for more than `most`."""
    tasks = sims.any_task
    keys = gridded_keys(file, tasks, x, pooled)
    scenes = file.scene_types()[tasks]
    if "scene.type" in _keys(x):
        scenes = np.full(len(tasks), "all scenes")
    members = {}
    for row, task in enumerate(tasks):
        # Without the parameters of guesses ("guesses[1].oracle.error") and methods that the task does not use.
        settings = {key: file.parameters[key].text(task) for key in keys
                    if not key.startswith(("guesses[", "solve.")) or file.parameters[key].applies()[task]}
        members.setdefault((scenes[row], tuple(settings.items())), []).append(row)
    if most is not None and len(members) > most:
        raise KeyNotFound(f"{len(members)} panels are too many for a page (at most {most}): the job also has a "
                          f"grid over {', '.join(keys) or 'scene.type'}; choose by --scene TYPE or --select KEY=VALUE")
    return [Panel(scene, dict(settings), np.array(rows), _words(file, dict(settings), tasks[rows[0]]))
            for (scene, settings), rows in members.items()]


def _words(file, keys, task):
    """"Young's modulus 1e6 Pa", "preconditioner block icc"."""
    found = []
    for key in keys:
        parameter = file.parameters[key]
        known = parameter.numeric and parameter.applies()[task]
        value = texts.number_text(parameter.values[task]) if known else parameter.text(task).replace("_", " ")
        unit = f" {parameter.unit}" if parameter.unit not in ("", "1") else ""
        found.append(f"{texts.quantity(key, parameter.unit)} {value}{unit}")
    return tuple(found)


def with_direct(sims, panels):
    """Panels of a closed loop, each with the tasks of the direct solve that differ from it only in keys of `solve`."""
    own = [panel.index[sims.own[panel.index]] for panel in panels]
    if not any(map(len, own)):
        return panels

    def other_settings(panel):
        return panel.scene, {key: value for key, value in panel.settings.items() if not key.startswith("solve.")}

    found, taken = [], set()
    for panel, rows in zip(panels, own):
        if not len(rows):
            continue
        beside = [k for k, other in enumerate(panels) if other_settings(other) == other_settings(panel)]
        direct = [panels[k].index[~sims.own[panels[k].index]] for k in beside]
        taken.update(beside)
        found.append(replace(panel, index=np.concatenate([rows, *direct])))
    return found + [panel for k, panel in enumerate(panels) if k not in taken]


def short_titles(panels):
    """Captions that have only the differences of the panels; empty for a single one."""
    if len(panels) == 1:
        return [""]
    scenes = {panel.scene for panel in panels}
    return [", ".join(([panel.scene.replace("_", " ")] if len(scenes) > 1 else []) + list(panel.words))
            for panel in panels]


def _keys(x):
    return () if x is None else (x,) if isinstance(x, str) else tuple(x)


def applicable(file, sims, x, without=False):
    """Rows of Simulations to which the key x applies. Raises KeyNotFound if there are none.

    `without`: also those of the same scene types without the key, such as friction if "contact" is "none"."""
    parameter = file.parameter(x)
    applies = parameter.applies()[sims.any_task]
    if without and x.startswith("scene."):
        scenes = file.scene_types()[sims.any_task]
        applies = np.isin(scenes, scenes[applies])
    rows = np.flatnonzero(applies)
    if not len(rows):
        raise KeyNotFound(f"parameter {x!r} does not apply to the chosen simulations")
    return rows


def points(file, sims, panel, x):
    parameter, tasks = file.parameter(x), sims.any_task[panel.index]
    codes = parameter.codes()[tasks]
    distinct, first = np.unique(codes, return_index=True)
    if parameter.numeric and len(distinct) > MOST_POINTS:
        return _binned(parameter.values[tasks], panel.index)
    if not parameter.numeric:
        distinct = distinct[np.argsort(first)]
    index = [panel.index[codes == code] for code in distinct]
    representative = [sims.any_task[rows[0]] for rows in index]
    text = [parameter.text(task) for task in representative]
    position = parameter.values[representative] if parameter.numeric else np.arange(len(index))
    return Points(np.asarray(position, dtype=float), text, index, not parameter.numeric, False)


def _binned(values, index):
    """Bins of (nearly) equal counts, each at the median of its values."""
    parts = np.array_split(np.argsort(values, kind="stable"), BINS)
    position = np.array([np.median(values[part]) for part in parts])
    return Points(position, [f"{p:.3g}" for p in position], [index[part] for part in parts], False, True)
