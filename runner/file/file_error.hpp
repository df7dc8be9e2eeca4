// What can go wrong with a results file, without HDF5's or MPI's headers.
#pragma once

#include <stdexcept>

namespace rodsweep {

/// Something about a file that its user must change: it exists already, is not ours, belongs to another job, is
/// damaged, or the disk is full. what() is the whole message for the user.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What is wrong with the contents of a file: what() is the reason alone, without the file.
class Damage : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A failing HDF5 call: its name, the object it was about, and HDF5's own error text.
class Hdf5Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace rodsweep
