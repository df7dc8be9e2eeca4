"""The reader of results files and model files, and all numbers that are made of them. Draws nothing."""

import os

# Before any h5py: a sweep may still be writing, on a file system without locks.
LOCKING = os.environ.get("HDF5_USE_FILE_LOCKING")    # of the user
os.environ.setdefault("HDF5_USE_FILE_LOCKING", "FALSE")
