"""Blocks of columns as a Parquet file, without a library: data pages of version 1 with a dictionary or plain, gzip.

All columns are flat and optional: what is not there (NaN, -1 of whole numbers, an empty text) is null. A row group is
of about GROUP_ROWS rows, a column in it one page, which has a dictionary where that is smaller. Unit and meaning of a
column NAME are the file's metadata NAME.unit and NAME.meaning. The structures and the numbers of their fields are those
of the format's parquet.thrift, https://github.com/apache/parquet-format.
"""

import gzip
import os
from concurrent.futures import ThreadPoolExecutor
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
    """Writes all blocks to a binary file; returns how many rows there were. `table`: the Tidy that they are of."""
    kinds = {name: Kind.of(table.dtype(name)) for name in names}
    out.write(MAGIC)
    at, groups, total = len(MAGIC), [], 0
    with ThreadPoolExecutor(os.cpu_count()) as pool:    # compressing is most of the work, and leaves Python alone
        for group in _gathered(blocks):
            begin, chunks = at, []
            made = pool.map(lambda name: _pages(kinds[name], [block[name] for block in group]), names)
            for name, pages in zip(names, made):
                out.write(pages.data)
                chunks.append(_chunk(name, kinds[name], pages, at))
                at += len(pages.data)
            # RowGroup
            groups.append([(1, ["struct"], chunks), (2, "i64", at - begin), (3, "i64", pages.rows)])
            total += pages.rows
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
    about = [(f"{name}.{word}", said) for name in names for word, said in zip(("unit", "meaning"), table.about(name))]
    metadata = [[(1, "text", key), (2, "text", said)] for key, said in about if said]    # KeyValue
    # FileMetaData
    return struct([(1, "i32", 1), (2, ["struct"], schema), (3, "i64", rows), (4, ["struct"], groups),
                   (5, ["struct"], metadata), (6, "text", "rodsweep")])


@dataclass(frozen=True)
class Pages:
    """A column in a row group."""
    data: bytes        # the page with its dictionary, if any, before it
    dictionary: int    # bytes of that
    raw: int           # all bytes before compression
    rows: int
    encoding: int


def _pages(kind, columns):
    values, index = _joined(columns)
    there = ~_taken(absent(values), index)
    dictionary, codes = _coded(kind, values, index, there)
    data, raw = b"", 0
    if dictionary is None:
        encoding, body = PLAIN, _taken(values, index)[there].astype(kind.stored).tobytes()
    else:
        encoding, (count, entries), width = RLE_DICTIONARY, dictionary, codes.dtype.itemsize
        data, raw = _page(DICTIONARY_PAGE, entries, [(1, "i32", count), (2, "i32", PLAIN)])
        run = varint(-(-len(codes) // 8) << 1 | 1)    # of whole eights
        body = bytes([8 * width]) + run + codes.tobytes() + bytes(-len(codes) % 8 * width)
    page, size = _page(DATA_PAGE, _levels(there) + body, [(1, "i32", len(there)), (2, "i32", encoding), (3, "i32", RLE),
                                                          (4, "i32", RLE)])
    return Pages(data + page, len(data), raw + size, len(there), encoding)


def _chunk(name, kind, pages, at):
    """ColumnChunk of pages that begin at byte `at` of the file."""
    # ColumnMetaData
    metadata = [(1, "i32", kind.physical), (2, ["i32"], sorted({PLAIN, RLE, pages.encoding})), (3, ["text"], [name]),
                (4, "i32", GZIP), (5, "i64", pages.rows), (6, "i64", pages.raw), (7, "i64", len(pages.data)),
                (9, "i64", at + pages.dictionary), (11, "i64", at if pages.dictionary else None)]
    return [(2, "i64", at), (3, "struct", metadata)]


def _page(kind, data, header):
    """(PageHeader and compressed data, their size before)."""
    packed = gzip.compress(data, LEVEL, mtime=0)
    head = struct([(1, "i32", kind), (2, "i32", len(data)), (3, "i32", len(packed)),
                   (5 if kind == DATA_PAGE else 7, "struct", header)])
    return head + packed, len(head) + len(data)


def _joined(columns):
    """Values of all columns, each array once, and what index every row has in them; None: its own."""
    distinct = {id(column.values) for column in columns}
    if len(distinct) == len(columns) and all(column.index is None for column in columns):
        return np.concatenate([column.values for column in columns]), None
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


def _taken(values, index):
    return values if index is None else values[index]


def _coded(kind, values, index, there):
    """((number of entries, their bytes), code of every row that is there) where this is smaller than the values; else
    (None, None)."""
    rows = int(there.sum())
    if kind.physical != TEXT and values.dtype.kind in "iu" and rows:
        low, high = int(values.min()), int(values.max())
        if high - low < FEW:
            entries, codes, count = np.arange(low, high + 1), values.astype(np.int64) - low, high - low + 1
            return _smaller(kind, entries.astype(kind.stored).tobytes(), count, codes, index, there)
    if index is None and kind.physical != TEXT:
        return None, None
    used = np.zeros(len(values), dtype=bool)
    used[_taken(np.arange(len(values)), index)[there]] = True
    codes = np.zeros(len(values), dtype=np.int64)
    if kind.physical != TEXT:
        entries = values[used]
        codes[used] = np.arange(len(entries))
        return _smaller(kind, entries.astype(kind.stored).tobytes(), len(entries), codes, index, there)
    distinct, codes[used] = np.unique(values[used].astype(str), return_inverse=True)
    texts = [text.encode() for text in distinct.tolist()]
    entries = b"".join(len(text).to_bytes(4, "little") + text for text in texts)
    return _smaller(kind, entries, len(texts), codes, index, there)


def _smaller(kind, entries, count, codes, index, there):
    width = next(size for size in (1, 2, 4) if count <= 1 << 8 * size)
    rows = int(there.sum())
    if kind.physical != TEXT and len(entries) + rows * width >= rows * np.dtype(kind.stored).itemsize:
        return None, None
    return (count, entries), _taken(codes.astype(f"<u{width}"), index)[there]


def _levels(there):
    """Definition levels: which rows are not null, as one run, or a bit each."""
    if there.all() or not there.any():
        runs = varint(len(there) << 1) + bytes([bool(there.all())])
    else:
        runs = varint(-(-len(there) // 8) << 1 | 1) + np.packbits(there, bitorder="little").tobytes()
    return len(runs).to_bytes(4, "little") + runs
