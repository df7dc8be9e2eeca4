"""The score in pages: tables and sentences of analysis/results/score/NAME.json (docs/score.md).

The fastest kinds of a row are the base and those that are equal to it or not told apart. If some are faster than the
base, the fastest of them takes its place. CG with Jacobi is left out where kinds are named, since its settings are among
those of the others."""

import functools
import os
import sys

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "analysis"))
from rodsweep.scoring import answers, scenes, settings, verdicts  # noqa: E402

KINDS = {settings.DIRECT: "direct solve", settings.ZERO: "CG from zero", settings.CLASSICAL: "classical guess",
         settings.CALL: "one call of a network", settings.FACTORS: "learned preconditioner",
         settings.JACOBI: "Jacobi, any guess", settings.GAUSS_SEIDEL: "Gauss–Seidel"}
SHORT = {"direct solve": (settings.DIRECT,), "CG, no network": (settings.ZERO, settings.CLASSICAL),
         "CG, network": (settings.CALL, settings.FACTORS), "Gauss–Seidel": (settings.GAUSS_SEIDEL,)}


class Scores:
    """Of the scenes in `root`/jobs/score that were measured."""
    learned, without_network = SHORT["CG, network"], SHORT["CG, no network"]

    def __init__(self, root):
        self.scenes = [scenes.Scene(name, root) for name in scenes.names(root)]

    @functools.cached_property
    def _scored(self):
        return [answers.Scored.of(scene) for scene in self.scenes if os.path.exists(scene.measured(".json"))]

    @functools.cached_property
    def _rows(self):
        """{(scene, "1 %"): {kind: Answer}}, of errors that a kind keeps to"""
        found = {(one.title, f"{100 * level:g} %"): one.at(level) for one in self._scored for level in one.levels}
        return {row: of for row, of in found.items() if any(answer.kept for answer in of.values())}

    def times(self, *levels):
        """A Markdown table of ms for a simulated second at these errors, such as "1 %". Bold: the fastest kinds. In
        parentheses: the setting does not keep to the error on the draws for testing."""
        rows = [["scene", "error", *KINDS.values()]]
        for (scene, level), of in self._rows.items():
            if level in levels:
                rows.append([scene, level, *(_time_text(of.get(kind), kind in _fastest(of)) for kind in KINDS)])
        return markdown(rows)

    def factors(self, level):
        """A Markdown table of a few kinds: how many times as long as the base. Bold: the fastest kinds."""
        rows = [["", *SHORT]]
        for (scene, at), of in self._rows.items():
            if at == level:
                kept = [min((of[kind] for kind in kinds if kind in of and of[kind].kept), key=lambda answer: answer.tuning_s,
                            default=None) for kinds in SHORT.values()]
                rows.append([scene, *(_bold(f"{answer.factor.value:.2g}", answer.kind in _fastest(of)) if answer else "–"
                                      for answer in kept)])
        return markdown(rows)

    def fastest(self, *kinds):
        """Where only these kinds are the fastest; "" if nowhere."""
        return _places(row for row, of in self._rows.items() if _fastest(of) - {settings.JACOBI} <= set(kinds))

    def among(self, *kinds):
        """Where these kinds are among the fastest, with others; "" if nowhere."""
        return _places(row for row, of in self._rows.items()
                       if (best := _fastest(of) - {settings.JACOBI}) & set(kinds) and not best <= set(kinds))

    def chosen(self, kind, words):
        """Where the setting of this kind has these words and keeps to the error; "" if nowhere."""
        return _places(row for row, of in self._rows.items()
                       if kind in of and of[kind].kept and words in of[kind].setting.text())

    def chooser(self):
        """A Markdown table: the time of the cheapest kind over that of the cheapest timed setting of any kind for each draw,
        among those whose error on this draw keeps to the level; geometric means. Settings are chosen on two repetitions, and
        compared on the third: the least of noisy times is too small."""
        levels = list(dict.fromkeys(level for _, level in self._rows))
        rows = [["", *levels]]
        for one in self._scored:
            gains = [self._gain(one, of) if (of := self._rows.get((one.title, level))) else "–" for level in levels]
            rows.append([one.title, *gains])
        return markdown(rows)

    @staticmethod
    def _gain(one, of):
        cheapest = min((answer for answer in of.values() if answer.kept), key=lambda answer: answer.time)
        settings_ = list({answer.setting: answer for answer in [cheapest, *one.answers]}.values())    # it is the first
        times = np.array([np.log(answer.time_s).mean(axis=0) for answer in settings_])    # [setting, repetition, draw]
        keeps = np.array([np.median(answer.error, axis=0) <= cheapest.level for answer in settings_])
        keeps[0], gains = True, []
        for out in range(times.shape[1]):
            known = np.delete(times, out, axis=1).mean(axis=1)
            best = np.where(keeps & np.isfinite(known), known, np.inf).argmin(axis=0)
            gains.append(times[0, out] - np.take_along_axis(times[:, out], best[None], axis=0)[0])
        return f"{np.exp(np.nanmean(gains)):.2f}"

    def missing(self):
        """The scenes that were not measured; "" if there are none."""
        measured = {one.name for one in self._scored}
        return listed([scene.title for scene in self.scenes if scene.name not in measured])

    def made_by(self):
        """Revisions, and days."""
        return listed(sorted({f"{one.revision} ({one.date})" for one in self._scored}))

    def rules(self):
        """The version of the rules, and what was measured by an earlier one."""
        titles = {}
        for one in sorted(self._scored, key=lambda one: -one.protocol):
            titles.setdefault(one.protocol, []).append(one.title)
        newest, *earlier = titles
        return f"{newest}" + "".join(f" ({listed(titles[version])}: {version})" for version in earlier)


def _fastest(of):
    faster = [answer for answer in of.values() if answer.verdict == answers.FASTER]
    if not faster:
        return {kind for kind, answer in of.items() if answer.kept and answer.verdict != answers.SLOWER}
    best = min(faster, key=lambda answer: answer.time)
    return {kind for kind, answer in of.items() if answer.kept and verdicts.factor(answer.time_s, best.time_s).low <= 1}


def _time_text(answer, fastest):
    if answer is None:
        return "–"
    text = f"{float(f'{1e3 * answer.time:.3g}'):g}"
    return _bold(text, fastest) if answer.kept else f"({text})"


def _bold(text, is_bold):
    return f"**{text}**" if is_bold else text


def _places(rows):
    """[("helix", "1 %"), ("knot", "1 %"), ("knot", "10 %")] as "helices at 1 % and knots at 1 and 10 %"."""
    levels = {}
    for scene, level in rows:
        levels.setdefault(scene, []).append(level.removesuffix(" %"))
    plural = {"helix": "helices", "falling rods": "falling rods"}
    return listed([f"{plural.get(scene, scene + 's')} at {listed(given)} %" for scene, given in levels.items()])


def listed(words):
    return " and ".join([", ".join(words[:-1]), words[-1]] if words[1:] else words)


def markdown(rows):
    return "\n".join(f"| {' | '.join(row)} |" for row in (rows[0], ["---"] * len(rows[0]), *rows[1:]))
