"""Output files: whole or absent. Rows and systems of results files in other formats."""
