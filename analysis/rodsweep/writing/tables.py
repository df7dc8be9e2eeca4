"""Writes frames of equal columns as CSV or Parquet with pandas. Missing values are empty fields in CSV, null in Parquet."""

from rodsweep.reading.errors import UserError, library


def write_csv(out, frames):
    """Writes the frames to a binary file, one by one; returns the number of rows."""
    count = 0
    for number, frame in enumerate(frames):
        frame.to_csv(out, index=False, header=number == 0, mode="wb")
        count += len(frame)
    return count


def write_parquet(out, frames):
    """Writes all frames to a binary file at once, so they must fit in memory; returns the number of rows. Raises
    UserError without pyarrow, which pandas needs."""
    first, *others = frames
    whole = library("pandas").concat([frame for frame in others if len(frame)] or [first], ignore_index=True)
    try:
        whole.to_parquet(out, index=False)
    except ImportError:
        raise UserError("pandas needs pyarrow to write Parquet: pip install pyarrow, or write CSV (-o FILE.csv.gz)") from None
    return len(whole)
