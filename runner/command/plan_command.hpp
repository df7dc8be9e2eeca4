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
    "Up to three tasks (cheapest, median, dearest), or some steps of a training, are really run for a moment, unless\n"
    "--no-probe is given. A training's data set must be there.\n\n"
    "Examples:\n"
    "  rodsweep plan jobs/spatial_bending.json\n"
    "  rodsweep plan jobs/spatial_bending.json --workers 64      what to ask Slurm for";

ExitCode execute(const PlanOptions& options, Console& console);

}  // namespace rodsweep
