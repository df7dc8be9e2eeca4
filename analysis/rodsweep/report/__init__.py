"""The report of one or several sweeps: one self-contained page of HTML. Its numbers are those of `reading`."""
