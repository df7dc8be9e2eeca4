// The command line: what the user asked for. Parsing alone; nothing is run, printed or started here.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "runner/command/exit_codes.hpp"
#include "runner/command/pack_command.hpp"
#include "runner/command/query_command.hpp"
#include "runner/command/rerun_command.hpp"
#include "runner/command/sweep_run.hpp"

namespace rodsweep {

struct PlanOptions {
  std::filesystem::path job;
  bool probe = true;
  bool json = false;
  std::string program;
};

struct ValidateOptions {
  std::vector<std::filesystem::path> jobs;
};

struct StatusOptions {
  std::filesystem::path file;
  bool json = false;
};

struct InfoOptions {
  std::filesystem::path file;
  bool verify = false;
  bool job = false;
  bool json = false;
};

struct VersionOptions {};

/// Nothing to run: help, or a mistake in the command line.
struct Answer {
  std::string text;
  ExitCode code = ExitCode::ok;
};

using Command = std::variant<RunOptions, PlanOptions, ValidateOptions, StatusOptions, InfoOptions, QueryOptions,
                             RerunOptions, PackOptions, VersionOptions, Answer>;

Command parse_command_line(int argc, const char* const* argv);

}  // namespace rodsweep
