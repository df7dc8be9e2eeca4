"""A parameter of the job: its value for every task."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Parameter:
    """One key of the job with its value for every task. Vectors have a second axis."""
    name: str
    unit: str
    meaning: str
    swept: bool
    values: np.ndarray

    @property
    def numeric(self):
        return self.values.ndim == 1 and self.values.dtype.kind in "iuf"

    def applies(self):
        """False if the key does not apply to the task's scene: NaN, -1 or the empty string."""
        first = self.values if self.values.ndim == 1 else self.values[:, 0]
        if first.dtype.kind == "f":
            return np.isfinite(first)
        return first != ("" if first.dtype.kind == "U" else -1)

    def codes(self):
        """An integer per task, equal if the values are equal; also equal for tasks to which the key does not apply."""
        def codes(values):
            return np.unique(values, return_inverse=True)[1].reshape(len(values))

        if self.values.ndim == 1:
            return codes(self.values)
        components = np.column_stack([codes(component) for component in self.values.T])  # in rows, NaN is unequal to NaN
        return np.unique(components, axis=0, return_inverse=True)[1].reshape(len(self.values))

    def flat(self):
        """A value for every task: of vectors a text, which is empty if the key does not apply."""
        return self.values if self.values.ndim == 1 else np.where(self.applies(), self.texts(), "")

    def texts(self):
        return np.array([self.text(task) for task in range(len(self.values))], dtype=str)

    def text(self, task):
        value = self.values[task]
        if np.ndim(value):
            return "(" + ", ".join(f"{v:g}" for v in value) + ")"
        if self.values.dtype.kind == "U":
            return str(value)
        return "none" if np.isnan(value) else f"{value:g}"
