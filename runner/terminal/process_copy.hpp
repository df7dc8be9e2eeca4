// A copy of this process that does what may end it: reading a damaged file, which some make HDF5 (1.10) crash on.
// Without MPI in the copy. Throws std::system_error where there can be no copy.
#pragma once

#include <functional>

namespace rodsweep {

/// Does work() in a copy of this process, which then leaves, whatever work() throws. The signal that ended the copy
/// before; 0 otherwise.
int signal_of_copy(const std::function<void()>& work);

/// From here on the copy is the program: in the copy this returns 0. The original waits for it and ends as it ends;
/// only where the copy crashes, this returns there, with the signal.
int go_on_as_copy();

}  // namespace rodsweep
