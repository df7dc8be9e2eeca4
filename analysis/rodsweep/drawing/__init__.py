"""Figures, pictures and films of the numbers of `reading`, and their files."""
