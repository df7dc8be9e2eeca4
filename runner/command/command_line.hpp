// Parses the command line. Runs, prints and starts nothing.
#pragma once

#include <string>
#include <variant>

#include "runner/command/commands.hpp"
#include "runner/command/exit_codes.hpp"
#include "runner/command/run_command.hpp"

namespace rodsweep {

/// Text to print instead of a command to run: help, version, schema, or a command-line error.
struct PrintedText {
  std::string text;
  ExitCode code = ExitCode::ok;
};

using Command = std::variant<RunOptions, PlanOptions, ValidateOptions, StatusOptions, InfoOptions, RerunOptions,
                             SystemsOptions, MergeOptions, ExternalCommand, PrintedText>;

Command parse_command_line(int argc, const char* const* argv);

}  // namespace rodsweep
