// Starts the ranks of a run on this machine, for `run --workers`.
#pragma once

#include <string>

namespace rodsweep {

/// Whether mpirun, srun or another launcher started this process as a rank.
bool is_launched();

/// Warns of a launcher that started several processes which do not know of each other, such as srun without PMIx; empty
/// if the `ranks` of this world are all that it started.
std::string separate_processes_text(int ranks);

/// Replaces this process by mpirun with `ranks` ranks of it, all with the arguments of this process. Settings of Open MPI
/// for one machine are those of mpi-env.sh. Throws std::runtime_error if mpirun cannot be started.
[[noreturn]] void launch(int ranks);

}  // namespace rodsweep
