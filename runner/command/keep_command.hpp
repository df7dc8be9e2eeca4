// The command `keep`: starts a sweep or a training again, whatever ends it, until it is done.
//
// The command that it keeps is typed behind `--`, with mpirun and all. It runs in a process group of its own; a start
// ends by itself, or is ended where its results file shows no sign of life (a sweep's master shows one every five
// seconds, a training whenever it saves). What then? What the last start wrote into the file decides: its exit code
// says that the job is done (0, 3), that it stopped for its time limit or since this was told to stop (4), or that what
// is left never fits (5); a start that left none was killed, one that lost all workers (6) or was stopped by somebody
// else (4) says so, and either is followed by the next after a pause that doubles while nothing more gets done. A time
// limit of the run is one of all starts together. What is left of a start elsewhere, as its lock on the file tells, is
// given time to end. Open MPI is told to let ranks die alone (its own exit code is worth nothing then), so that a sweep
// goes on without the ranks that it loses, and to notice a host that is cut off within a minute.
//
// A signal to stop is handed on, as SIGUSR1, once; should this process die, its sweep is stopped likewise.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runner/command/exit_codes.hpp"
#include "runner/command/run_command.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

struct KeepOptions {
  std::vector<std::string> command;            ///< words: mpirun ... rodsweep run ...
  RunOptions run;                              ///< what its rodsweep was told
  std::optional<std::filesystem::path> hosts;  ///< as mpirun's --hostfile
  double silence_s = 300;                      ///< a start that shows no sign of life for so long is ended; 0: never
  double pause_s = 1;                          ///< before the first of several starts that get nothing done
  int vain_starts = 10;                        ///< so many in a row that get nothing done are enough
};

inline constexpr const char* keep_help =
    "What ran and was lost is begun again: by the sweep itself where a worker dies or hangs, by another start where\n"
    "the master, mpirun or a host is lost. A task that ends three workers is set aside as crashed.\n"
    "It ends with the sweep's own exit code. SIGTERM, SIGINT (Ctrl-C) and SIGUSR1 stop the sweep.\n\n"
    "With --hosts, whose file is like mpirun's --hostfile, every start leaves out the hosts that do not answer to\n"
    "mpirun's launch agent (ssh, or what OMPI_MCA_plm_rsh_agent names); {hosts} in COMMAND is the file of the "
    "others.\n\n"
    "Examples:\n"
    "  rodsweep keep -- mpirun -n 9 rodsweep run job.json\n"
    "  rodsweep keep -- mpirun -n 9 rodsweep run job.json -o out.h5 --worker-timeout 30\n"
    "  rodsweep keep --hosts hosts.txt -- mpirun --hostfile {hosts} rodsweep run job.json\n"
    "  rodsweep keep -- rodsweep run train.json             a training goes on from its checkpoint";

/// The words of the `rodsweep run ...` within a command; empty: there is none.
std::vector<std::string> run_words(const std::vector<std::string>& command);

ExitCode execute(const KeepOptions& options, Console& console);

}  // namespace rodsweep
