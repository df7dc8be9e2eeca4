"""Writes blocks of columns as CSV or Parquet with pandas. Missing values (-1 of integers, NaN, empty texts) are empty
fields in CSV and null in Parquet.
"""

from rodsweep.reading.errors import UserError, library


def write_csv(out, names, blocks):
    """Writes a line of names and all blocks to a binary file, block by block; returns the number of rows."""
    count = 0
    _frame(names, None).to_csv(out, index=False, mode="wb")
    for block in blocks:
        frame = _frame(names, block)
        frame.to_csv(out, index=False, header=False, mode="wb")
        count += len(frame)
    return count


def write_parquet(out, names, blocks):
    """Writes all blocks to a binary file at once, so they must fit in memory; returns the number of rows. Raises
    UserError without pyarrow, which pandas needs."""
    pandas = library("pandas")
    frame = pandas.concat([_frame(names, None), *(_frame(names, block) for block in blocks)], ignore_index=True)
    try:
        frame.to_parquet(out, index=False)
    except ImportError:
        raise UserError("pandas needs pyarrow to write Parquet: pip install pyarrow, or write CSV (-o FILE.csv.gz)") from None
    return len(frame)


def _frame(names, block):
    """A block as a frame; None: no rows."""
    return library("pandas").DataFrame({name: [] if block is None else _column(block[name].array()) for name in names})


def _column(values):
    if values.dtype.kind == "i":
        return library("pandas").arrays.IntegerArray(values, values == -1)
    if values.dtype.kind == "U":
        values = values.astype(object)
        values[values == ""] = None
    return values
