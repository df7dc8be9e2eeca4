"""Rows of results files in other formats: CSV and Parquet, a block at a time."""
