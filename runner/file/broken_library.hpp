// HDF5 after a failed write or close (a full disk): shutting it down, which MPI does as it finalises and the C library
// at exit, would crash.
#pragma once

namespace rodsweep {

/// Has a write failed in this process? Then it has to leave by _Exit().
bool hdf5_is_broken();
void set_hdf5_broken();

}  // namespace rodsweep
