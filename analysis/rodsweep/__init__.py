"""Results of rodsweep in Python: `reading` has files and all numbers made of them, `drawing` figures, pictures and films."""
