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
STRIDE = 16            # rows that are looked at together
FEW = 1 << 16    # whole numbers in so narrow a range are looked up


def write(out, names, blocks):
    """Writes a line of names and all blocks to a binary file; returns how many rows there were."""
    out.write(",".join(_quoted(name) for name in names).encode() + b"\n")
    fields, joined, count = Remembered(lambda _, values: _with_comma(text_bytes(values))), {}, 0
    for block in blocks:
        columns = [(fields(name, block[name].values), block[name].index) for name in names]
        parts = [(_side_by_side(begin, [part for part, _ in group], joined), index)
                 for begin, index, group in _neighbours(columns)]
        rows, width = len(block[names[0]]), sum(part.shape[1] for part, _ in parts)
        for begin in range(0, rows, AT_ONCE):
            out.write(_lines(parts, begin, min(rows, begin + AT_ONCE), width))
        count += rows
    return count


def _neighbours(columns):
    """(number of the first, index, columns) of neighbours that have the same index, as columns of tasks do."""
    begin = 0
    for k in range(1, len(columns) + 1):
        index = columns[begin][1]
        if k == len(columns) or index is None or columns[k][1] is not index:
            yield begin, index, columns[begin:k]
            begin = k


def _side_by_side(begin, parts, joined):
    """Several parts as one. `joined` remembers the last that began at a column, which are the same for most blocks."""
    if len(parts) == 1:
        return parts[0]
    before, made = joined.get(begin, ([], None))
    if len(before) != len(parts) or any(one is not other for one, other in zip(before, parts)):
        made = np.hstack(parts)
        joined[begin] = (parts, made)
    return made


def _lines(parts, begin, end, width):
    text = bytearray((end - begin) * width)
    lines, at = np.frombuffer(text, dtype=np.uint8).reshape(-1, width), 0
    for part, index in parts:
        lines[:, at:at + part.shape[1]] = part[begin:end] if index is None else part[index[begin:end]]
        at += part.shape[1]
    lines[:, -1] = LINE_END    # in the place of a comma
    return text.translate(None, b"\0")


def _with_comma(part):
    """Without columns of bytes in which nothing stands, and a comma after the others."""
    several = len(part) // STRIDE * STRIDE
    used = np.bitwise_or.reduce(part[:several].reshape(-1, STRIDE * part.shape[1])).reshape(STRIDE, -1)
    kept = np.flatnonzero(np.bitwise_or.reduce(np.concatenate([used, part[several:]])))
    out = np.empty((len(part), len(kept) + 1), dtype=np.uint8)
    out[:, :-1], out[:, -1] = part[:, kept], COMMA
    return out


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
