"""Blocks of columns as a Parquet file, without a library: data pages of version 1 with a dictionary or plain, gzip.

All columns are flat and optional: what is not there (NaN, -1 of whole numbers, an empty text) is null. A row group is of
about GROUP_ROWS rows, a column in it one page, which has a dictionary where that is smaller. Unit and meaning of a column
NAME are the file's metadata NAME.unit and NAME.meaning. Numbers in comments are those of the format's parquet.thrift,
https://github.com/apache/parquet-format.
"""

import gzip
from dataclasses import dataclass

import numpy as np

from rodsweep.reading.conditions import absent
from rodsweep.writing.thrift import struct, varint

MAGIC = b"PAR1"
GROUP_ROWS = 1 << 17
LEVEL = 1    # of gzip: half of the time of the next ones for a tenth more bytes
PLAIN, RLE, RLE_DICTIONARY = 0, 3, 8
GZIP = 2
OPTIONAL = 1
DATA_PAGE, DICTIONARY_PAGE = 0, 2
TEXT = 6     # BYTE_ARRAY
FEW = 1 << 16    # whole numbers in so narrow a range are a dictionary


@dataclass(frozen=True)
class Kind:
    """How the values of a column are stored: a physical type, and what it stands for."""
    physical: int
    stored: str          # numpy's type of a value in a page
    converted: int = None
    logical: list = None

    @staticmethod
    def of(dtype):
        if dtype.kind == "f":
            return Kind(4, "<f4") if dtype.itemsize <= 4 else Kind(5, "<f8")
        if dtype.kind not in "iu":
            return Kind(TEXT, "", 0, [(1, "struct", [])])
        bits, signed = 8 * dtype.itemsize, dtype.kind == "i"
        converted = (15 if signed else 11) + {8: 0, 16: 1, 32: 2, 64: 3}[bits]
        logical = [(10, "struct", [(1, "i8", bits), (2, "bool", signed)])]
        return Kind(2, "<i8", converted, logical) if bits == 64 else Kind(1, "<i4", converted, logical)


def write(out, table, names, blocks):
    """Writes all blocks to a binary file; returns how many rows there were. `table`: the Tidy whose columns they are."""
    kinds = {name: Kind.of(table.dtype(name)) for name in names}
    out.write(MAGIC)
    at, groups, total = len(MAGIC), [], 0
    for group in _gathered(blocks):
        rows = sum(len(block[names[0]]) for block in group)
        begin, chunks = at, []
        for name in names:
            pages, chunk = _chunk(name, kinds[name], [block[name] for block in group], at)
            out.write(pages)
            at += len(pages)
            chunks.append(chunk)
        # RowGroup
        groups.append([(1, ["struct"], chunks), (2, "i64", at - begin), (3, "i64", rows)])
        total += rows
    footer = _footer(table, names, kinds, groups, total)
    out.write(footer + len(footer).to_bytes(4, "little") + MAGIC)
    return total


def _gathered(blocks):
    group, rows = [], 0
    for block in blocks:
        group.append(block)
        rows += len(next(iter(block.values())))
        if rows >= GROUP_ROWS:
            yield group
            group, rows = [], 0
    if group:
        yield group


def _footer(table, names, kinds, groups, rows):
    schema = [[(4, "text", "rows"), (5, "i32", len(names))]]    # SchemaElement, of the root and of the columns
    schema += [[(1, "i32", kinds[name].physical), (3, "i32", OPTIONAL), (4, "text", name),
                (6, "i32", kinds[name].converted), (10, "struct", kinds[name].logical)] for name in names]
    about = {f"{name}.{word}": said for name in names for word, said in zip(("unit", "meaning"), table.about(name)) if said}
    metadata = [[(1, "text", key), (2, "text", value)] for key, value in about.items()]
    # FileMetaData
    return struct([(1, "i32", 1), (2, ["struct"], schema), (3, "i64", rows), (4, ["struct"], groups),
                   (5, ["struct"], metadata), (6, "text", "rodsweep")])


def _chunk(name, kind, columns, at):
    """(pages, ColumnChunk) of a column in a row group that begins at byte `at` of the file."""
    values, index = _joined(columns)
    there = ~absent(values)[index]
    dictionary, codes = _coded(kind, values, index[there])
    levels = _levels(there)
    pages, raw = b"", 0
    if dictionary is not None:
        count, data = dictionary
        pages, raw = _page(DICTIONARY_PAGE, data, [(1, "i32", count), (2, "i32", PLAIN)])
        width = codes.dtype.itemsize
        body = bytes([8 * width]) + varint(-(-len(codes) // 8) << 1 | 1) + codes.tobytes() + bytes(-len(codes) % 8 * width)
    else:
        body = values[index[there]].astype(kind.stored).tobytes()
    encoding = PLAIN if dictionary is None else RLE_DICTIONARY
    page, size = _page(DATA_PAGE, levels + body, [(1, "i32", len(there)), (2, "i32", encoding), (3, "i32", RLE),
                                                  (4, "i32", RLE)])
    # ColumnMetaData
    metadata = [(1, "i32", kind.physical), (2, ["i32"], sorted({PLAIN, RLE, encoding})), (3, ["text"], [name]),
                (4, "i32", GZIP), (5, "i64", len(there)), (6, "i64", raw + size), (7, "i64", len(pages) + len(page)),
                (9, "i64", at + len(pages)), (11, "i64", at if pages else None)]
    return pages + page, [(2, "i64", at), (3, "struct", metadata)]


def _page(kind, data, header):
    """(PageHeader and compressed data, their size before)."""
    packed = gzip.compress(data, LEVEL, mtime=0)
    head = struct([(1, "i32", kind), (2, "i32", len(data)), (3, "i32", len(packed)),
                   (5 if kind == DATA_PAGE else 7, "struct", header)])
    return head + packed, len(head) + len(data)


def _joined(columns):
    """Values that all columns index, each array once, and the index of every row."""
    arrays, offsets, index, size = [], {}, [], 0
    for column in columns:
        values = column.values
        if id(values) not in offsets:
            offsets[id(values)] = size
            arrays.append(values)
            size += len(values)
        rows = np.arange(len(values)) if column.index is None else column.index
        index.append(rows + offsets[id(values)])
    return np.concatenate(arrays), np.concatenate(index)


def _coded(kind, values, index):
    """((number of entries, their bytes), code of every row) where that is smaller than the values, else (None, None)."""
    used = np.zeros(len(values), dtype=bool)
    used[index] = True
    entries = values[used]
    if kind.physical == TEXT:
        distinct, which = np.unique(entries.astype(str), return_inverse=True)
        texts = [text.encode() for text in distinct.tolist()]
        data = b"".join(len(text).to_bytes(4, "little") + text for text in texts)
    elif values.dtype.kind in "iu" and len(entries) and int(entries.max()) - int(entries.min()) < FEW:
        low = int(entries.min())
        data = np.arange(low, int(entries.max()) + 1).astype(kind.stored).tobytes()
        which = entries.astype(np.int64) - low
    else:
        data, which = entries.astype(kind.stored).tobytes(), np.arange(len(entries))
    count = len(texts) if kind.physical == TEXT else len(data) // np.dtype(kind.stored).itemsize
    width = next(size for size in (1, 2, 4) if count <= 1 << 8 * size)
    if kind.physical != TEXT and len(data) + len(index) * width >= len(index) * np.dtype(kind.stored).itemsize:
        return None, None
    code = np.zeros(len(values), dtype=f"<u{width}")
    code[used] = which
    return (count, data), code[index]


def _levels(there):
    """Definition levels: which rows are not null, as one run, or a bit each."""
    if there.all() or not there.any():
        runs = varint(len(there) << 1) + bytes([bool(there.all())])
    else:
        runs = varint(-(-len(there) // 8) << 1 | 1) + np.packbits(there, bitorder="little").tobytes()
    return len(runs).to_bytes(4, "little") + runs
