// Starts the ranks of a run on this machine, for `run --workers`.
#pragma once

#include <string>

#include "runner/command/exit_codes.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

/// Whether mpirun, srun or another launcher started this process as a rank.
bool is_launched();

/// Warns of a launcher that started several processes which do not know of each other, such as srun without PMIx; empty
/// if the `ranks` of this world are all that it started.
std::string separate_processes_text(int ranks);

/// Runs mpirun with `ranks` ranks of this program, all with the arguments of this process, and returns its exit code.
/// Settings of Open MPI for one machine are those of mpi-env.sh. mpirun gets the signals that request a stop. Its
/// standard output is printed here, because mpirun ignores failed writes.
ExitCode launch(int ranks, Console& console);

}  // namespace rodsweep
