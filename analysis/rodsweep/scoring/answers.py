"""What the score says of a scene: NAME.json, from the search, the sitting and the errors on the draws for testing.

An answer is a kind at an error: its setting, error, times, and the factor of its time over that of the kind that was the
cheapest on the draws for tuning. Errors, times and factors are of the draws for testing. A kind whose setting does not keep
to the error there has no factor. If the cheapest does not, the next cheapest takes its place.
"""

import json
import os
from dataclasses import dataclass, replace

import numpy as np

from rodsweep.reading import job_paths, modelfile, texts
from rodsweep.reading.errors import KeyNotFound, SweepFileError
from rodsweep.scoring import verdicts
from rodsweep.scoring.scenes import TEST
from rodsweep.scoring.settings import KINDS, OWN, TRAININGS, Setting, model_of
from rodsweep.writing import outputs

PROTOCOL = 5
READABLE = (4, 5)    # results of these may be shown; docs/score.md says what 5 changed
BASE, EQUAL, SLOWER, FASTER, UNDECIDED = "the base", "equal", "slower", "faster", "not told apart"
PRODUCTS_TO = 1e-3      # relative: those of timed simulations are those of the ones with errors


@dataclass(frozen=True)
class Answer:
    level: float
    kind: str
    setting: Setting
    tuning_s: float         # median time on the draws for tuning
    error: np.ndarray       # [training, draw]
    products: float         # for a simulated second
    network: float          # share of solves for which a network ran
    time_s: np.ndarray      # [training, repetition, draw], NaN where a simulation failed
    factor: verdicts.Factor = None
    verdict: str = ""

    @property
    def kept(self):
        return verdicts.kept(self.error, self.level)

    @property
    def time(self):
        return float(np.exp(np.nanmean(np.log(self.time_s))))

    def as_json(self):
        return {"level": self.level, "kind": self.kind, "text": self.setting.text(), **self.setting.as_json(),
                "tuning_s": texts.shortened(self.tuning_s, 4), "error": texts.shortened(self.error, 4),
                "products": texts.shortened(self.products, 4),
                "network": texts.shortened(self.network, 3), "time_s": texts.shortened(self.time_s, 5)}

    @classmethod
    def from_json(cls, found):
        error = np.array(found["error"], dtype=float)
        error[np.isnan(error)] = np.inf
        return cls(found["level"], found["kind"], Setting.from_json(found), found["tuning_s"], error, found["products"],
                   found["network"], np.array(found["time_s"], dtype=float))


@dataclass(frozen=True)
class Scored:
    """Of a scene. `reference`: bounds of the medians of its own error, by draws; `tried`: number of settings by kind."""
    name: str
    title: str
    job: str        # checksum of the scene's
    revision: str
    date: str
    reference: dict
    tried: dict
    levels: list
    training_minutes: dict      # {model: [training]}
    answers: list
    protocol: int = PROTOCOL

    def at(self, level):
        """{kind: Answer} with factors and verdicts."""
        return judged({answer.kind: answer for answer in self.answers if answer.level == level})

    def write(self, path):
        made = {name: getattr(self, name) for name in self.__dataclass_fields__ if name != "answers"}
        lines = [f" {json.dumps(name)}: {json.dumps(value)}" for name, value in made.items()]
        rows = ",\n".join(f"  {json.dumps(answer.as_json())}" for answer in self.answers)
        outputs.write(path, "{\n" + ",\n".join([*lines, f' "answers": [\n{rows}\n ]']) + "\n}\n")

    @classmethod
    def of(cls, scene):
        """Raises an error if the scene was not measured, or has changed since."""
        path = scene.measured(".json")
        if not os.path.exists(path):
            raise KeyNotFound(f"{scene.name} was not measured: run score.py --errors {scene.name}, then --times {scene.name}")
        read = cls.read(path)
        if read.job != job_paths.checksum(scene.job):
            raise SweepFileError(f"{path} is of another jobs/score/{scene.name}_draws.json: measure it again")
        return read

    @classmethod
    def read(cls, path):
        with open(path, encoding="utf-8") as file:
            found = json.load(file)
        if found["protocol"] not in READABLE:
            raise SweepFileError(f"{path} is of version {found['protocol']} of the rules, not {PROTOCOL} (docs/score.md)")
        answers = [Answer.from_json(entry) for entry in found.pop("answers")]
        return cls(**found, answers=answers)


def answers_of(chosen, times, runs, draws=TEST):
    """Those of a sitting ({(level, kind): (Setting, its time on the draws for tuning)}, {Setting: [repetition, 2, draw]}),
    with errors of its draws. Raises SweepFileError if the timed simulations are not those that gave the errors."""
    made = []
    for (level, kind), (setting, tuning_s) in chosen.items():
        of = [runs.results(training, draws, times[training].shape[-1]) for training in setting.trainings()]
        timed = np.array([times[training] for training in setting.trainings()])
        for one, products in zip(of, timed[:, :, 1]):
            ran = np.isfinite(one.error)
            if not np.allclose(products[:, ran], one.products[ran], rtol=PRODUCTS_TO):
                raise SweepFileError(f"{setting.text()} took other products when it was timed than when it gave its errors")
        made.append(Answer(level, kind, setting, tuning_s, np.array([one.error for one in of]),
                           float(np.nanmedian([one.products for one in of])), float(np.nanmean([one.network for one in of])),
                           timed[:, :, 0]))
    return made


def judged(answers):
    """{kind: Answer} at one error, with verdicts. A setting of two kinds is tested once."""
    kept = {kind: answer for kind, answer in answers.items() if answer.kept}
    if not kept:
        return answers
    base = kept[min(kept, key=lambda kind: (kind == OWN, kept[kind].tuning_s))]    # time on the user's machine
    factors = {answer.setting: verdicts.factor(answer.time_s, base.time_s) for answer in kept.values()
               if answer.setting != base.setting}
    sure = verdicts.holm({setting: factor.p for setting, factor in factors.items()})
    made = dict(answers)
    for kind, answer in kept.items():
        factor = factors.get(answer.setting)
        if factor is None:
            made[kind] = replace(answer, factor=verdicts.Factor(1, 1, 1, 1), verdict=BASE)
        else:
            differs = SLOWER if factor.value > 1 else FASTER
            verdict = EQUAL if factor.equal() else differs if sure[answer.setting] < 1 - verdicts.LEVEL else UNDECIDED
            made[kind] = replace(answer, factor=factor, verdict=verdict)
    return made


def training_minutes(root, settings):
    """{model: minutes of processor time [training]} of the models of settings; NaN where it was not measured."""
    found = {}
    for path in sorted({path for setting in settings for path in setting.models()}):
        trainings = dict.fromkeys(model_of(path, number) for number in TRAININGS)
        found[os.path.splitext(os.path.basename(path))[0]] = [
            texts.shortened(modelfile.read(os.path.join(root, training)).processor_seconds / 60, 3) for training in trainings]
    return found


def table(scored):
    """Lines: a block per error, then the trainings, and what made them."""
    lines = []
    for level in scored.levels:
        of = scored.at(level)
        rows = [[f"{scored.title}, error {100 * level:g} %", "ms/s", "÷ base", "95 %", "verdict", "products/s", "network",
                 "error", "tried", "setting"]]
        rows += [[kind, *_cells(of[kind]), str(scored.tried.get(kind, "-")), of[kind].setting.text()] if kind in of else
                 [kind, *["-"] * 7, str(scored.tried.get(kind, "-")), "none was found"]
                 for kind in KINDS if kind in of or kind != OWN]
        lines += [*texts.aligned(rows), ""]
    if scored.training_minutes:
        rows = [["model", "minutes of training, each"]]
        rows += [[name, " ".join(texts.short_text(float("nan") if m is None else m, 3) for m in of)]
                 for name, of in scored.training_minutes.items()]
        lines += [*texts.aligned(rows), ""]
    return [*lines, f"{scored.title}: version {scored.protocol} of the rules, program {scored.revision}, {scored.date}", ""]


def comparison(known, again):
    """Lines: the factors of the same settings over the same base, on two sets of draws; whether the second is within the
    interval of the first, and whether both settings still keep to the error."""
    rows = [[known.title, "error", "÷ base", "95 %", "again", "95 %", ""]]
    for level in known.levels:
        before, after = known.at(level), {answer.kind: answer for answer in again.answers if answer.level == level}
        base = next((kind for kind, answer in before.items() if answer.verdict == BASE), None)
        for kind, answer in before.items():
            if answer.factor and answer.verdict != BASE:
                found = verdicts.factor(after[kind].time_s, after[base].time_s)
                cells = [text for of in (answer.factor, found)
                         for text in (texts.short_text(of.value, 3), f"{of.low:.3g} to {of.high:.3g}")]
                outside = "apart" if found.low > answer.factor.high or found.high < answer.factor.low else "intervals overlap"
                said = "within" if answer.factor.low <= found.value <= answer.factor.high else outside
                lost = [of for of in (kind, base) if not after[of].kept]
                rows.append([kind, f"{100 * level:g} %", *cells, said + "".join(f", {of} does not keep" for of in lost)])
    return texts.aligned(rows)


def _cells(answer):
    failed = np.count_nonzero(~np.isfinite(answer.error))
    said = texts.short_text(100 * float(np.median(np.median(answer.error, axis=0))), 2) + " %"
    said += f", {failed} of {answer.error.size} failed" if failed else ""
    factor, of = ["-"] * 2, answer.factor
    if of:
        factor = [texts.short_text(of.value, 3), "-" if answer.verdict == BASE else f"{of.low:.3g} to {of.high:.3g}"]
    return [texts.short_text(1e3 * answer.time, 3), *factor, answer.verdict or "does not keep to it",
            texts.short_text(answer.products, 3), f"{100 * answer.network:.0f} %", said]
