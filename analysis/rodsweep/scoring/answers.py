"""What the score says of a scene: NAME.json, from the search, the sitting and the errors on the draws for testing.

An answer is a kind at an error: its setting, error, times, and the factor of its time over that of the cheapest kind. Both
are of the draws for testing. A kind whose setting does not keep to the error there has no factor.
"""

import json
import os
from dataclasses import dataclass, replace

import numpy as np

from rodsweep.reading import job_paths, modelfile, texts
from rodsweep.scoring import verdicts
from rodsweep.scoring.scenes import TEST
from rodsweep.scoring.settings import KINDS, OWN, Setting
from rodsweep.writing import outputs

PROTOCOL = 1
FASTEST, EQUAL, SLOWER, UNDECIDED = "cheapest", "equal", "slower", "not told apart"


@dataclass(frozen=True)
class Answer:
    level: float
    kind: str
    setting: Setting
    error: np.ndarray       # [draw], of several trainings the median
    products: float         # for a simulated second
    network: float          # share of solves for which a network ran
    time_s: np.ndarray      # [training, repetition, draw]
    factor: verdicts.Factor = None
    verdict: str = ""

    @property
    def kept(self):
        return verdicts.kept(self.error, self.level)

    @property
    def time(self):
        return float(np.exp(np.log(self.time_s).mean()))

    def as_json(self):
        return {"level": self.level, "kind": self.kind, "text": self.setting.text(), **self.setting.as_json(),
                "error": [_short(value, 4) for value in self.error], "products": _short(self.products, 4),
                "network": _short(self.network, 3), "time_s": np.vectorize(lambda v: _short(v, 5))(self.time_s).tolist()}

    @classmethod
    def from_json(cls, found):
        error = np.array([np.inf if value is None else value for value in found["error"]])
        return cls(found["level"], found["kind"], Setting.from_json(found), error, found["products"], found["network"],
                   np.array(found["time_s"]))


def _short(value, digits):
    return float(f"{value:.{digits}g}") if np.isfinite(value) else None


@dataclass(frozen=True)
class Scored:
    """Of a scene. `reference`: bounds of the medians of its own error, by draws; `tried`: number of settings by kind."""
    name: str
    title: str
    revision: str
    date: str
    reference: dict
    tried: dict
    levels: list
    training_minutes: dict      # {model: [training]}
    answers: list

    def at(self, level):
        """{kind: Answer} with factors and verdicts."""
        return judged({answer.kind: answer for answer in self.answers if answer.level == level})

    def write(self, path):
        made = {"protocol": PROTOCOL, **{name: getattr(self, name) for name in self.__dataclass_fields__ if name != "answers"}}
        lines = [f" {json.dumps(name)}: {json.dumps(value)}" for name, value in made.items()]
        rows = ",\n".join(f"  {json.dumps(answer.as_json())}" for answer in self.answers)
        outputs.write(path, "{\n" + ",\n".join([*lines, f' "answers": [\n{rows}\n ]']) + "\n}\n")

    @classmethod
    def read(cls, path):
        with open(path, encoding="utf-8") as file:
            found = json.load(file)
        found.pop("protocol")
        answers = [Answer.from_json(entry) for entry in found.pop("answers")]
        return cls(**found, answers=answers)


def answers_of(chosen, times, runs, draws=TEST):
    """Those of a sitting ({(level, kind): Setting}, {Setting: [repetition, draw]}), with errors of its draws."""
    made = []
    for (level, kind), setting in chosen.items():
        of = [runs.of(training, draws, times[training].shape[1]) for training in setting.trainings()]
        made.append(Answer(level, kind, setting, np.median([one.error for one in of], axis=0),
                           float(np.median([one.products for one in of])), float(np.mean([one.network for one in of])),
                           np.array([times[training] for training in setting.trainings()])))
    return made


def judged(answers):
    """{kind: Answer} at one error, with verdicts."""
    kept = {kind: answer for kind, answer in answers.items() if answer.kept}
    if not kept:
        return answers
    best = min(kept, key=lambda kind: kept[kind].time)
    factors = {kind: verdicts.factor(answer.time_s, kept[best].time_s) for kind, answer in kept.items()
               if answer.setting != kept[best].setting}
    sure = verdicts.holm({kind: factor.p for kind, factor in factors.items()})
    made = {}
    for kind, answer in answers.items():
        factor = factors.get(kind)
        if kind not in kept:
            made[kind] = answer
        elif factor is None:    # its setting is the cheapest
            made[kind] = replace(answer, factor=verdicts.Factor(1, 1, 1, 1), verdict=FASTEST)
        else:
            verdict = EQUAL if factor.equal() else SLOWER if sure[kind] < 1 - verdicts.LEVEL else UNDECIDED
            made[kind] = replace(answer, factor=factor, verdict=verdict)
    return made


def training_minutes(root, settings):
    """{model: minutes of processor time [training]} of the models of settings; NaN where it was not measured."""
    found = {}
    for setting in settings:
        for training in setting.trainings():
            for path in job_paths.given([json.loads(training.solve), json.loads(training.guess)], ("model",)):
                of = modelfile.read(os.path.join(root, path))
                first = Setting(training.step, "{}", json.dumps({"model": path})).of_training(1)
                name = os.path.basename(json.loads(first.guess)["model"]).removesuffix(".h5")
                found.setdefault(name, {})[path] = _short(of.processor_seconds / 60, 3)
    return {name: [of[path] for path in sorted(of, key=lambda path: (len(path), path))] for name, of in sorted(found.items())}


def table(scored):
    """Lines: a block per error, then the trainings."""
    lines = []
    for level in scored.levels:
        of = scored.at(level)
        rows = [[f"{scored.title}, error {100 * level:g} %", "ms/s", "÷ cheapest", "95 %", "verdict", "products/s", "network",
                 "error", "tried", "setting"]]
        rows += [[kind, *_cells(of[kind]), str(scored.tried.get(kind, "-")), of[kind].setting.text()] if kind in of else
                 [kind, *["-"] * 7, str(scored.tried.get(kind, "-")), "none keeps to it"]
                 for kind in KINDS if kind in of or kind != OWN]
        lines += [*texts.aligned(rows), ""]
    if scored.training_minutes:
        rows = [["model", "minutes of training, each"]]
        rows += [[name, " ".join(texts.short_text(float("nan") if m is None else m, 3) for m in of)]
                 for name, of in scored.training_minutes.items()]
        lines += [*texts.aligned(rows), ""]
    return lines


def comparison(known, again):
    """Lines: the factors of the same settings over the same cheapest kind, on two sets of draws."""
    rows = [[known.title, "error", "÷ cheapest", "95 %", "again", "95 %", ""]]
    for level in known.levels:
        before, after = known.at(level), {answer.kind: answer for answer in again.answers if answer.level == level}
        best = next((kind for kind, answer in before.items() if answer.verdict == FASTEST), None)
        for kind, answer in before.items():
            if answer.factor and answer.verdict != FASTEST:
                found = verdicts.factor(after[kind].time_s, after[best].time_s)
                apart = found.low > answer.factor.high or found.high < answer.factor.low
                cells = [text for of in (answer.factor, found)
                         for text in (texts.short_text(of.value, 3), f"{of.low:.3g} to {of.high:.3g}")]
                rows.append([kind, f"{100 * level:g} %", *cells, "differs" if apart else "agrees"])
    return texts.aligned(rows)


def _cells(answer):
    failed = np.count_nonzero(~np.isfinite(answer.error))
    said = texts.short_text(100 * float(np.median(answer.error)), 2) + " %" + (f", {failed} failed" if failed else "")
    factor, of = ["-"] * 2, answer.factor
    if of:
        factor = [texts.short_text(of.value, 3), "-" if answer.verdict == FASTEST else f"{of.low:.3g} to {of.high:.3g}"]
    return [texts.short_text(1e3 * answer.time, 3), *factor, answer.verdict or "does not keep to it",
            texts.short_text(answer.products, 3), f"{100 * answer.network:.0f} %", said]
