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
    "Runs parts of up to three tasks (cheapest, median, most expensive), or some steps of a training, unless\n"
    "--no-probe is given. The data set of a training must exist.\n\n"
    "Examples:\n"
    "  rodsweep plan jobs/spatial_bending.json\n"
    "  rodsweep plan jobs/spatial_bending.json --workers 64      resources to request from Slurm";

ExitCode execute(const PlanOptions& options, Console& console);

}  // namespace rodsweep
