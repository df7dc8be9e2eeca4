// The part of the command line that asks for work on results files, and for what editors and shells want of the
// program: query, rerun, pack, schema, completion.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "runner/command/command_line.hpp"

namespace rodsweep {

class FileCommandLine {
 public:
  /// Adds its commands to `app`, which must outlive this. It stays where it is, since `app` refers to it.
  explicit FileCommandLine(CLI::App& app);
  FileCommandLine(const FileCommandLine&) = delete;
  FileCommandLine& operator=(const FileCommandLine&) = delete;

  /// What was asked for, if it was one of these; `line`: as it was typed.
  std::optional<Command> chosen(const std::string& line) const;

 private:
  void add_query();
  void add_rerun();
  void add_pack();

  CLI::App& app_;
  CLI::App *query_command_, *rerun_command_, *pack_command_, *schema_command_, *completion_command_;
  QueryOptions query_;
  RerunOptions rerun_;
  PackOptions pack_;
  std::vector<std::string> where_;
  bool csv_ = false, json_ = false;
};

}  // namespace rodsweep
