"""A condition for `rodsweep query`, --select, export.py --where and where= in Python: COLUMN OPERATOR VALUE.

  =  (or ==)   equal to one of the values, which commas (outside of parentheses) separate; of numbers, a value may be a
               range LOW:HIGH, LOW: or :HIGH, ends included
  !=           equal to none of them
  < <= > >=    numbers
  ~            texts that contain the value

All operators treat numbers as equal up to a relative 1e-9. A missing value (NaN, an empty text, -1 of integers) meets
no condition. Every column of the tasks (task_columns.py) is known everywhere; frames and export.py add those of their
rows. tests/conditions.json has cases. Raises KeyNotFound for an unknown column or word, with the nearest known one. Raises
it also for a number or an operator that does not fit the column.
"""

import re
from dataclasses import dataclass

import numpy as np

from rodsweep.reading import texts
from rodsweep.reading.errors import LISTED, KeyNotFound, listed, not_found

OPERATORS = ("<=", ">=", "!=", "==", "=", "<", ">", "~")   # the longer ones first
FORM = "one of = != < <= > >= ~ (contains), and a value; for = also A,B or LOW:HIGH"   # in help texts, after the column
ROUNDING = 1e-9
# What to use where rows do not have these columns: the nearest names mean something else.
OF_ROWS = {"tolerance": "these rows have no tolerance; columns have it in their name (iterations_1e-2, "
                        "cg_ratio.GUESS@1e-2), scripts have --tolerance; solve.tolerance is that of the timed solves",
           "guess": "these rows have no guess; columns have it in their name (cg_ratio.GUESS), scripts have --guess; "
                    "own_guess advances the rods in a closed loop"}
NUMBER = re.compile(r"[+-]?((\d+\.?\d*|\.\d+)(e[+-]?\d+)?|inf|infinity)", re.IGNORECASE)


@dataclass(frozen=True)
class Column:
    """Properties of a column for conditions. words: all texts that it can have, if known."""
    numeric: bool
    words: tuple = ()


@dataclass(frozen=True)
class Condition:
    text: str
    column: str
    operator: str
    ranges: tuple = ()      # (low, high) of = and != on numbers
    limit: float = np.nan   # of < <= > >=
    texts: tuple = ()       # of =, != and ~ on texts

    def met(self, values):
        """Mask over the values of the column."""
        if values.dtype.kind not in "iuf":
            return self._texts_met(values.astype(str))
        numbers = values.astype(np.float64)
        numbers[absent(values)] = np.nan
        if self.operator not in ("=", "!="):
            return _compared(self.operator, numbers, self.limit)
        found = np.zeros(len(numbers), dtype=bool)
        for low, high in self.ranges:
            found |= _compared(">=", numbers, low) & _compared("<=", numbers, high)
        return found if self.operator == "=" else ~found & ~np.isnan(numbers)

    def _texts_met(self, values):
        if self.operator == "~":
            return np.char.find(values, self.texts[0]) >= 0
        found = np.isin(values, self.texts)
        return (found if self.operator == "=" else ~found) & (values != "")


def absent(values):
    """Mask of the missing values."""
    if values.dtype.kind == "f":
        return np.isnan(values)
    if values.dtype.kind == "i":
        return values == -1
    return np.zeros(len(values), dtype=bool) if values.dtype.kind == "u" else values == ""


def parse(text, columns, all_by=""):
    """Parses a condition on one of {name: Column}. all_by: the command that lists them (errors.not_found)."""
    name, operator, value = _parts(text, columns)
    if not value:
        raise _no_condition(text)
    if name not in columns:
        raise KeyNotFound(f'"{text}": {OF_ROWS[name]}') if name in OF_ROWS else not_found("column", name, columns, all_by)
    column, equality = columns[name], operator in ("=", "!=")
    if column.numeric:
        if operator == "~":
            raise KeyNotFound(f'"{text}": {name} holds numbers; ~ is for texts')
        if not equality:
            return Condition(text, name, operator, limit=_number(value, text, name))
        return Condition(text, name, operator, ranges=tuple(_range(item, text, name) for item in _listed(value)))
    if not equality and operator != "~":
        raise KeyNotFound(f'"{text}": {name} holds texts, which have no order; use =, != or ~')
    if not equality or value in column.words:
        return Condition(text, name, operator, texts=(value,))
    for item in _listed(value) if column.words else ():
        if item not in column.words:
            raise not_found(f'"{text}":', item, column.words)
    return Condition(text, name, operator, texts=(*_listed(value), value))   # the last: a value with a comma


def require_met(condition, values, what):
    """Raises KeyNotFound, with the values that there are, if none meets a condition."""
    if condition.met(values).any():
        return
    there = np.unique(values[~absent(values)])
    numeric = there.dtype.kind in "iuf"
    known = f"{there[0]:g} to {there[-1]:g}" if numeric and len(there) > LISTED else \
        listed([f"{value:g}" if numeric else value for value in there])
    raise KeyNotFound(f"no {what} meets {condition.text}; known: {known}")


def _parts(text, columns):
    """Labels may contain any character, so the operator is the first one after a known column name."""
    found = []
    for at in range(len(text)):
        operator = next((word for word in OPERATORS if text.startswith(word, at)), None)
        if operator:
            name, value = text[:at].strip(), text[at + len(operator):].strip()
            found.append((name, "=" if operator == "==" else operator, value))
            if name in columns:
                return found[-1]
    if not found or not found[0][0]:
        raise _no_condition(text)
    return found[0]


def _no_condition(text):
    return KeyNotFound(f'"{text}" is no condition: write COLUMN=VALUE, or with one of != < <= > >= ~ (~: contains)')


def _listed(value):
    return [item.strip() for item in texts.split_labels(value)]


def _range(item, text, name):
    low, colon, high = (part.strip() for part in item.partition(":"))
    if not colon:
        return (_number(item, text, name),) * 2
    if not low and not high:
        raise KeyNotFound(f'"{text}": a range has one end at least: LOW:HIGH, LOW: or :HIGH')
    ends = _number(low, text, name) if low else -np.inf, _number(high, text, name) if high else np.inf
    if ends[0] > ends[1]:
        raise KeyNotFound(f'"{text}": nothing is in the range {item}; write its lower end first')
    return ends


def _number(item, text, name):
    if not NUMBER.fullmatch(item):
        raise KeyNotFound(f'"{text}": {name} holds numbers, and "{item}" is none')
    return float(item)


def _compared(operator, numbers, limit):
    with np.errstate(invalid="ignore"):    # inf - inf
        apart = np.abs(numbers - limit)
        same = (numbers == limit) | (np.isfinite(apart) & (apart <= ROUNDING * np.maximum(np.abs(numbers), abs(limit))))
        strict = numbers < limit if operator[0] == "<" else numbers > limit
    return strict | same if operator.endswith("=") else strict & ~same
