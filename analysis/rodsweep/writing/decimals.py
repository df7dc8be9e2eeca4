"""Whole arrays of floating-point numbers as text: the shortest digits that give the same number, as str() writes them.

A number a = x 10^(e - 16) with x in [1e16, 1e17) is scaled with a table of powers in extended precision, so that x is
known to 0.011; of its roundings to 15, 16 and 17 digits the first that is nearer to x than half of the distance between
neighbours gives a back (of 15 digits zeros at the end are left out, which makes the shortest). float32 does the same in
double precision, with 6 to 9 digits. Where x is too near to a border to say, and for the few numbers near the limits of
their type, numpy's own, slower text is taken. A text is a row of bytes in which zeros are nothing: they are taken out
when rows have been put together, all at once.
"""

from dataclasses import dataclass

import numpy as np

DIGITS = 17                   # of every number; nothing stands for zeros at their end
POINT, ZERO, MINUS = b".0-"
LEAST_LAYOUT = -4             # least exponent of a positional number
SCIENTIFIC = 16               # stands in the place of a positional number's exponent
PREFIX, BODY, SUFFIX = 6, 18, 5    # sign and "0.000"; digits and point; "e-308"
WIDTH = PREFIX + BODY + SUFFIX


@dataclass(frozen=True)
class Precision:
    """How numbers of a type are scaled."""
    powers: np.ndarray   # of ten, in the type of x, from 10^-LARGEST_POWER
    digits: tuple        # how many may be enough, in order; the last always are
    error: float         # that of x
    least: float         # above the type's subnormal numbers
    largest: float


LARGEST_POWER = 308
POWERS = np.array([np.longdouble(f"1e{k}") for k in range(-LARGEST_POWER, LARGEST_POWER + 1)])
POWERS_64 = POWERS.astype(np.float64)
PRECISIONS = {np.dtype(np.float64): Precision(POWERS, (15, 16, 17), 0.012, 1e-290, 1e290),
              np.dtype(np.float32): Precision(POWERS_64, (6, 7, 8, 9), 1e-5, 1e-35, 1e35)}
EXTENDED = np.finfo(np.longdouble).nmant >= 63    # not so on every machine

EXPONENTS = np.array([f"e{k:+03d}" for k in range(-LARGEST_POWER, LARGEST_POWER + 1)], dtype=f"S{SUFFIX}")
EXPONENTS = EXPONENTS.view(np.uint8).reshape(-1, SUFFIX)
FOUR_DIGITS = np.array([b"%04d" % k for k in range(10_000)], dtype="S4").view(np.uint32)
LAST_DIGITS = np.array([(b"%04d" % k).rstrip(b"0") for k in range(10_000)], dtype="S4").view(np.uint32)


def text_bytes(values):
    """[value, byte] of float32 or float64; zeros are nothing, and NaN is nothing at all."""
    out = np.zeros((len(values), WIDTH), dtype=np.uint8)
    precision, size = PRECISIONS[values.dtype], np.abs(values)
    regular = (size > precision.least) & (size < precision.largest) & EXTENDED
    rows = np.flatnonzero(regular)
    if len(rows):
        size = size[rows]
        digits, exponent, sure = _digits(size, precision)
        positional = (size.astype(np.float64) >= 1e-4) & (size.astype(np.float64) < 1e16)
        if not sure.all():
            regular[rows[~sure]] = False
            rows, digits, exponent, positional = rows[sure], digits[sure], exponent[sure], positional[sure]
        out[:, 0] = np.where(regular & (values < 0), MINUS, 0)
        _lay_out(out, rows, _letters(digits), np.where(positional, exponent, SCIENTIFIC), exponent)
    others = np.flatnonzero(~regular & ~np.isnan(values))
    out[others] = values[others].astype(f"S{WIDTH}").view(np.uint8).reshape(-1, WIDTH)
    return out


def _digits(size, precision):
    """(whole numbers of DIGITS digits, exponents of the first digits, mask of what is certain)."""
    last = precision.digits[-1]
    exponent = np.floor(np.log10(size)).astype(np.int64)
    x = size * precision.powers[last - 1 - exponent + LARGEST_POWER]
    off = (x >= 10 ** last).astype(np.int64) - (x < 10 ** (last - 1))
    if off.any():
        exponent += off
        x = size * precision.powers[last - 1 - exponent + LARGEST_POWER]
    whole = np.rint(x)
    rest, whole = (x - whole).astype(np.float64), whole.astype(np.int64)
    lopsided = np.frexp(size)[0] == 0.5     # powers of two are nearer to their neighbour below
    half = np.spacing(size) * np.where(lopsided, 0.25, 0.5) * POWERS_64[last - 1 - exponent + LARGEST_POWER]
    found, undecided, sure = whole, np.ones(len(size), dtype=bool), np.abs(rest) < 0.5 - precision.error
    for count in precision.digits[:-1]:
        unit = 10 ** (last - count)
        fewer = whole // unit
        beyond = whole - fewer * unit + rest
        up = beyond > unit / 2
        away = np.where(up, unit - beyond, beyond)
        inside = undecided & (away < half)
        unclear = (np.abs(away - half) < precision.error) | (unit / 2 - away < precision.error) | (lopsided & ~inside)
        sure = np.where(undecided & (inside | unclear), ~unclear, sure)
        found = np.where(inside, (fewer + up) * unit, found)
        undecided &= ~(inside | unclear)
    carried = found >= 10 ** last           # 9.99... rounded up
    return np.where(carried, found // 10, found) * 10 ** (DIGITS - last), exponent + carried, sure


def _letters(digits):
    """[number, place] of whole numbers of DIGITS digits, without the zeros at their end."""
    letters = np.empty((len(digits), 5), dtype=np.uint32)
    at_end = np.ones(len(digits), dtype=bool)
    for k in range(4, -1, -1):
        rest = digits // 10_000
        group = digits - rest * 10_000
        letters[:, k] = np.where(at_end, LAST_DIGITS[group], FOUR_DIGITS[group])
        at_end &= group == 0
        digits = rest
    return letters.view(np.uint8)[:, 20 - DIGITS:]


def _lay_out(out, rows, letters, layout, exponent):
    """Writes digits with points, and exponents where `layout` says so, into rows of `out`."""
    for power in np.flatnonzero(np.bincount(layout - LEAST_LAYOUT)) + LEAST_LAYOUT:
        some = np.flatnonzero(layout == power)
        text, own = np.zeros((len(some), BODY), dtype=np.uint8), letters[some]
        if power < 0:
            leading = b"0." + b"0" * (-1 - power)
            out[rows[some], 1:1 + len(leading)] = np.frombuffer(leading, dtype=np.uint8)
            text[:, :DIGITS] = own
        elif power < SCIENTIFIC:
            before = power + 1
            text[:, :before], text[:, before + 1:] = np.maximum(own[:, :before], ZERO), own[:, before:]
            text[:, before], text[:, before + 1] = POINT, np.maximum(text[:, before + 1], ZERO)    # 3.0
        else:
            text[:, 0], text[:, 2:] = own[:, 0], own[:, 1:]
            text[:, 1] = np.where(own[:, 1] > 0, POINT, 0)
            out[rows[some], PREFIX + BODY:] = EXPONENTS[exponent[some] + LARGEST_POWER]
        out[rows[some], PREFIX:PREFIX + BODY] = text
