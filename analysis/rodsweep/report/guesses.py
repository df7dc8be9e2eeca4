"""What the guesses and methods of a sweep are, one sentence each.

A function of KINDS has the parameters of a kind of guess, with the defaults of the job's schema. Files come as their
names without folder and ending, and parameters that vary in the job as texts, such as "5 or 10".
"""

import os

from rodsweep.reading.constants import PATHS

METHODS = {  # by the first word of a label
    "direct": "A block factorisation of the matrix, in the order of the rods' joints: no iterations, no guess.",
    "end_to_end": "A network answers each linear system instead of a solver.",
    "state_network": "A network predicts the next state instead of a time step.",
    "xpbd": "Extended position-based dynamics: so many Gauss-Seidel iterations a step, no linear systems.",
    "pbd": "Position-based dynamics: so many Gauss-Seidel iterations a step, no linear systems.",
}


def described(file, labels):
    """{label: sentence} of those of the labels that are known: guesses of the job, names of kinds, methods."""
    specs = dict(zip(file.guesses, file.job().get("guesses", [])))
    found = {label: _sentence(specs.get(label, label)) or METHODS.get(label.split()[0]) for label in labels}
    return {label: sentence for label, sentence in found.items() if sentence}


def _sentence(spec):
    """Empty if the spec is a text that does not name a kind, such as a label of a file without a job."""
    if isinstance(spec, str) and spec not in KINDS:
        return ""
    said = _said(spec)
    return said[0].upper() + said[1:] + "."


def _said(spec):
    if isinstance(spec, str):
        return KINDS[spec]()
    for word in ("grid", "zip"):
        if word in spec:
            return "one of these: " + "; ".join(map(_said, spec[word]))
    (kind, parameters), = spec.items()
    return KINDS[kind](**{name: value if name == "guess" else _value(name, value) for name, value in parameters.items()
                          if name != "label"})


def _value(name, value):
    """A parameter as it is said; a text if it varies or is a list."""
    if isinstance(value, dict):
        (word, values), = value.items()
        return (" or " if word in ("grid", "zip") else " to ").join(str(_value(name, one)) for one in values)
    if isinstance(value, list):
        return ", ".join(_value(name, one) for one in value)
    return os.path.splitext(os.path.basename(value))[0] if name in PATHS else value


def _times(number):
    return "once" if number == 1 else f"{number} times"


def zero():
    return "CG starts at zero; ratios and speedups compare with this"


def previous():
    return "the solution of the same Newton iteration in the last time step"


def linear():
    return "a straight line in time through the last two solutions, continued to this step"


def quadratic():
    return "a parabola in time through the last three solutions, continued to this step"


def fischer(size=10):
    return (f"the best combination of up to {size} earlier solutions (smallest error in the A-norm), then it restarts with "
            "one; each costs a product with A")


def subspace(size=10):
    return (f"the best combination of the last {size} solutions (smallest error in the A-norm); each costs a product "
            "with A")


def deflation(size=10):
    return subspace(size) + "; CG then searches without their directions (deflated CG)"


def regression(size=6):
    return f"the combination of the last {size} solutions whose right-hand sides fit the new one; no product with A"


def copingnet(model, corrections=1, lag_steps=0, stop_at=0):
    return (f"learned: the network {model} corrects its base guess (zero or a classical one) {_times(corrections)}" +
            (", with a product with A for each correction after the first" if corrections != 1 else "") +
            (f"; its factors serve {lag_steps} time steps" if lag_steps else "") +
            (f"; it stops at a residual of {stop_at} of the right-hand side" if stop_at else ""))


def knn(data, k=3, simulations=0, inputs="all"):
    return (f"the mean solution of the {k} most similar systems in the data set {data}" +
            (f", of its first {simulations} simulations" if simulations else "") +
            (f"; similar by: {inputs}" if inputs != "all" else ""))


def plugin(library, options="", inputs=()):
    return f"from your shared library {library}" + _given(options, inputs)


def python(file, options="", inputs=()):
    return f"from your Python file {file}" + _given(options, inputs)


def _given(options, inputs):
    return (f", with the options {options}" if options else "") + (f", with the files {inputs}" if inputs else "")


def oracle(error=0.1, errors="white"):
    where = {"white": "random in every entry", "smooth": "smooth, in the directions that CG finds last"}.get(errors, errors)
    return (f"the exact solution with an error of {error} of its A-norm, {where}: it shows what a guess of that quality "
            "would save, and is not a method")


def guarded(guess, threshold):
    return f"{_said(guess)}; used only if its residual is below {threshold} times that of zero, else CG starts at zero"


def totals(guess):
    return f"{_said(guess)}; it learns from the sum of a step's increments"


def first(guess):
    return f"{_said(guess)}; only at the first Newton iteration of a step, else CG starts at zero"


def ritz(guess, size=10, collected=20, lag_steps=50):
    return (f"{_said(guess)}; CG also searches without {size} approximate eigenvectors from {collected} residuals of earlier "
            f"solves (deflated CG)" + (f", which serve {lag_steps} time steps" if lag_steps else ""))


KINDS = {of.__name__: of for of in (zero, previous, linear, quadratic, fischer, subspace, deflation, regression, copingnet,
                                    knn, plugin, python, oracle, guarded, totals, first, ritz)}
