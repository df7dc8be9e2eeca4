// Errors of results files, without HDF5's or MPI's headers.
#pragma once

#include "runner/text/formatted_error.hpp"

namespace rodsweep {

/// A file error that the user must fix: the file exists, is foreign, belongs to another job or is damaged, or the disk
/// is full. what() is the complete message for the user.
struct FileError : FormattedError<> {
  using FormattedError::FormattedError;
};

/// Invalid contents of a file. what() is only the reason, without the path.
struct Damage : FormattedError<> {
  using FormattedError::FormattedError;
};

/// A failed HDF5 call: its name, the object, and HDF5's error text.
struct Hdf5Error : FormattedError<> {
  using FormattedError::FormattedError;
};

/// Whether a write or close failed in this process, for example on a full disk. HDF5's shutdown would then crash, in
/// MPI_Finalize and at exit, so the process must end with _Exit().
bool hdf5_is_broken();
void set_hdf5_broken();

}  // namespace rodsweep
