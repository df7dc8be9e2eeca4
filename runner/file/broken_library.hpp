// Whether HDF5 is broken after a failed write or close (a full disk). Its shutdown would then crash, both in
// MPI_Finalize and at exit.
#pragma once

namespace rodsweep {

/// Whether a write failed in this process. Then it must exit with _Exit().
bool hdf5_is_broken();
void set_hdf5_broken();

}  // namespace rodsweep
