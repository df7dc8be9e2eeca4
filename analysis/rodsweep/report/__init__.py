"""The report of one or several sweeps: a page of HTML that needs nothing else. Its numbers are those of `reading`."""
