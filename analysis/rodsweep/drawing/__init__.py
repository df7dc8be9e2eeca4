"""Figures, pictures and films of the numbers of `reading`, and the files that they go to."""
