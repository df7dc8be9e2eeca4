"""Blocks of columns as comma-separated values (RFC 4180): every number with the shortest digits that give it back.

Nothing stands between commas for what is not there: NaN, -1 of whole numbers, an empty text. A column's distinct values
become rows of bytes with zeros in the place of what is missing to its width; these are put side by side, and the zeros
taken out of the whole block at once.
"""

import numpy as np

from rodsweep.reading.tidy import Remembered
from rodsweep.writing import decimals

COMMA, LINE_END = b",\n"
AT_ONCE = 1 << 11   # rows: their bytes stay in the cache
FEW = 1 << 16    # whole numbers in so narrow a range are looked up


def write(out, names, blocks):
    """Writes a line of names and all blocks to a binary file; returns how many rows there were."""
    out.write(",".join(_quoted(name) for name in names).encode() + b"\n")
    fields, count = Remembered(lambda _, values: _narrow(text_bytes(values))), 0
    for block in blocks:
        columns = [(fields(name, block[name].values), block[name].index) for name in names]
        rows, width = len(block[names[0]]), sum(part.shape[1] + 1 for part, _ in columns)
        for begin in range(0, rows, AT_ONCE):
            out.write(_lines(columns, begin, min(rows, begin + AT_ONCE), width))
        count += rows
    return count


def _lines(columns, begin, end, width):
    text = bytearray((end - begin) * width)
    lines, at = np.frombuffer(text, dtype=np.uint8).reshape(-1, width), 0
    for part, index in columns:
        after = at + part.shape[1]
        lines[:, at:after] = part[begin:end] if index is None else part[index[begin:end]]
        lines[:, after] = COMMA
        at = after + 1
    lines[:, -1] = LINE_END
    return text.translate(None, b"\0")


def _narrow(part):
    """Without the columns of bytes in which nothing stands."""
    used = np.bitwise_or.reduce(part, axis=0) > 0
    return part if used.all() else part[:, used]


def text_bytes(values):
    """[value, byte] of a column; zeros are nothing."""
    if values.dtype.kind == "f":
        return decimals.text_bytes(values)
    return _matrix(_whole(values) if values.dtype.kind in "iu" else _texts(values))


def _matrix(fields):
    return np.ascontiguousarray(fields).view(np.uint8).reshape(len(fields), -1)


def _whole(values):
    """Texts of whole numbers; nothing for -1."""
    low, high = (int(values.min()), int(values.max())) if len(values) else (0, 0)
    if high - low >= min(FEW, len(values)):
        fields = values.astype("S21")
        fields[values == -1] = b""
        return fields
    known = np.array([b"" if k == -1 else b"%d" % k for k in range(low, high + 1)], dtype=np.bytes_)
    return known[values.astype(np.int64) - low]


def _texts(values):
    distinct, which = np.unique(values.astype(str), return_inverse=True)
    fields = np.array([_quoted(text).encode() for text in distinct.tolist()], dtype=np.bytes_)
    return fields[which]


def _quoted(text):
    text = text.replace("\0", "")
    return '"' + text.replace('"', '""') + '"' if set(text) & set(',"\r\n') else text
