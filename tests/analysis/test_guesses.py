"""Every guess that a job can have is explained: the sentences of the report against jobs/schema.json."""

import glob
import inspect
import json
import os
import unittest
import unittest.mock

import synthetic
from rodsweep.report import guesses

JOBS = os.path.join(synthetic.ANALYSIS, "..", "jobs")
with open(os.path.join(JOBS, "schema.json"), encoding="utf-8") as _file:
    DEFINITIONS = json.load(_file)["definitions"]
OF_GUESSES = {kind: {name: parameter for name, parameter in of["properties"].items() if name != "label"}
              for choice in DEFINITIONS["guess"]["anyOf"] for kind, of in choice.get("properties", {}).items()
              if kind not in ("grid", "zip", "label")}
INNER = {"fischer": {"size": 7}}


def of_values(kind, name):
    """Two values of a parameter, the first of them not its default."""
    if name == "guess":
        return INNER, "previous"
    plain = DEFINITIONS[f"guess.{kind}.{name}"]["anyOf"][0]
    if "enum" in plain:
        return sorted(plain["enum"], key=lambda value: value == OF_GUESSES[kind][name].get("default"))
    return {"array": (["one"], ["two"]), "string": ("one", "two"), "number": (0.25, 0.5), "integer": (2, 4)}[plain["type"]]


def required(kind):
    return {name: of_values(kind, name)[1] for name, parameter in OF_GUESSES[kind].items() if "default" not in parameter}


class Sentences(unittest.TestCase):
    def said(self, spec):
        file = unittest.mock.Mock(guesses=["label"], **{"job.return_value": {"guesses": [spec]}})
        sentence = guesses.described(file, ["label"])["label"]
        self.assertRegex(sentence, r"^[A-Z][^{}]*[^ .]\.$")
        return sentence

    def test_kinds_and_their_parameters_are_those_of_the_schema(self):
        mine = {kind: {name: list(parameter.default) if isinstance(parameter.default, tuple) else parameter.default
                       for name, parameter in inspect.signature(of).parameters.items()} for kind, of in guesses.KINDS.items()}
        self.assertEqual(mine, {kind: {name: parameter.get("default", inspect.Parameter.empty)
                                       for name, parameter in of.items()} for kind, of in OF_GUESSES.items()})

    def test_every_parameter_changes_the_sentence_and_varying_ones_name_their_values(self):
        for kind in OF_GUESSES:
            plain = self.said({kind: required(kind)})
            self.assertEqual(self.said({kind: {**required(kind), "label": "another name"}}), plain)
            for name in OF_GUESSES[kind]:
                with self.subTest(kind=kind, parameter=name):
                    one, other = of_values(kind, name)
                    self.assertNotEqual(self.said({kind: {**required(kind), name: one}}), plain)
                    if name != "guess":
                        varying = self.said({kind: {**required(kind), name: {"grid": [one, other]}}})
                        words = [value[0] if isinstance(value, list) else str(value) for value in (one, other)]
                        self.assertIn(" or ".join(words), varying)

    def test_a_guess_in_another_and_one_of_several_are_said_in_full(self):
        self.assertEqual(self.said({"guarded": {"guess": "previous", "threshold": 1}}),
                         "The solution of the same Newton iteration in the last time step; used only if its residual is "
                         "below 1 times that of zero, else CG starts at zero.")
        varying = self.said({"copingnet": {"model": {"zip": ["a/rods-large.h5", "rods.h5"]}}})
        self.assertIn("the network rods-large or rods ", varying)
        self.assertEqual(self.said({"grid": ["previous", {"oracle": {"error": 0.5}}], "label": "x"})[:13], "One of these:")

    def test_all_guesses_of_all_jobs_have_a_sentence(self):
        seen = 0
        for path in glob.glob(os.path.join(JOBS, "**", "*.json"), recursive=True):
            with open(path, encoding="utf-8") as file:
                job = json.load(file)
            for spec in job.get("guesses", []) if job.get("kind") == "sweep" else []:
                self.said(spec)
                seen += 1
        self.assertGreater(seen, 100)

    def test_labels_without_a_job_are_explained_if_they_name_a_kind_or_method(self):
        file = unittest.mock.Mock(guesses=["zero", "mine"], **{"job.return_value": {}})
        self.assertEqual(list(guesses.described(file, ["zero", "mine", "direct", "xpbd 20"])), ["zero", "direct", "xpbd 20"])


if __name__ == "__main__":
    unittest.main()
