// The command `plan`: the extent and estimated cost of a job. Throws JobError. No MPI; probes need PETSc.
#pragma once

#include <filesystem>
#include <string>

#include "runner/command/exit_codes.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

struct PlanOptions {
  std::filesystem::path job;
  bool probe = true;
  bool json = false;
  int workers = 0;                   ///< 0: one per core of this host
  std::string program = "rodsweep";  ///< as the user typed it
};

inline constexpr const char* plan_help =
    "Runs parts of up to three tasks (cheapest, median, most expensive), unless --no-probe is given. Of a training it\n"
    "prints the size; `run` prints the time that is left. The data set of a training must exist.\n\n"
    "Examples:\n"
    "  rodsweep plan jobs/spatial_bending.json\n"
    "  rodsweep plan jobs/spatial_bending.json --workers 64      resources to request from Slurm";

ExitCode execute(const PlanOptions& options, Console& console);

}  // namespace rodsweep
