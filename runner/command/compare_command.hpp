// The command `compare`: what differs between two sweeps, task by task and in the mean. No MPI.
// Throws FileError and Hdf5Error.
#pragma once

#include <filesystem>

#include "runner/command/exit_codes.hpp"
#include "runner/job/plan_matching.hpp"
#include "runner/terminal/console.hpp"

namespace rodsweep {

struct CompareOptions {
  enum class Format { text, csv, json };
  std::filesystem::path a, b;
  MatchBy by = MatchBy::everything;
  bool tasks = false;  ///< list each that differs
  Format format = Format::text;
};

inline constexpr const char* compare_help =
    "Tasks are the same where all is that their results depend on: parameters, seed, sample, guesses with what is in\n"
    "their models; so sweeps with other grids, samples or guesses overlap where they can. Where the jobs differ in\n"
    "something on purpose (a tolerance, a preconditioner), --by parameters matches tasks by their sample and by what\n"
    "varies within either job, and guesses by their label.\n"
    "Told are the keys in which the jobs differ; how many tasks are in both; which of their values differ, by how "
    "much;\n"
    "changed outcomes; and of every guess the mean CG ratio in both and its difference, task by task, with a "
    "bootstrap\n"
    "interval of 95 % over draws of the random parameters (\"-\" of fewer than 5). Times are told and make no "
    "difference.\n"
    "The table has one tolerance, that of the first job; --csv and --json have all. Reads only.\n\n"
    "Examples:\n"
    "  rodsweep compare results/before.h5 results/after.h5\n"
    "  rodsweep compare results/jacobi.h5 results/icc.h5 --by parameters\n"
    "  rodsweep compare old.h5 new.h5 --tasks --csv >differing.csv\n\n"
    "Exit codes:\n"
    "  0  what is in both files is the same, to the last bit\n"
    "  2  the command line or a file is at fault, or no task is in both\n"
    "  3  results differ";

ExitCode execute(const CompareOptions& options, Console& console);

}  // namespace rodsweep
