// The command line: what the user asked for. Parsing alone; nothing is run, printed or started here.
#pragma once

#include <string>
#include <variant>

#include "runner/command/compare_command.hpp"
#include "runner/command/exit_codes.hpp"
#include "runner/command/info_command.hpp"
#include "runner/command/keep_command.hpp"
#include "runner/command/merge_command.hpp"
#include "runner/command/pack_command.hpp"
#include "runner/command/plan_command.hpp"
#include "runner/command/query_command.hpp"
#include "runner/command/rerun_command.hpp"
#include "runner/command/run_command.hpp"
#include "runner/command/status_command.hpp"
#include "runner/command/validate_command.hpp"

namespace rodsweep {

/// Nothing to run: what was asked for (help, the version, a script for the shell), or a mistake in the command line.
struct Answer {
  std::string text;
  ExitCode code = ExitCode::ok;
};

using Command = std::variant<RunOptions, PlanOptions, ValidateOptions, StatusOptions, InfoOptions, QueryOptions,
                             CompareOptions, RerunOptions, PackOptions, KeepOptions, MergeOptions, Answer>;

Command parse_command_line(int argc, const char* const* argv);

}  // namespace rodsweep
