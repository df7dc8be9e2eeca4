// The tasks of a results file as a table: a row per task, a column per parameter and per result, read one at a time, so
// that a file of 100,000 tasks needs the memory of the columns in use. Works while a sweep writes: the state bytes are
// read first, and of tasks that were not complete then no result is shown.
//
//   task, state ("done", "pending"), outcome, message          own to the table, or masked
//   scene.segments, time.step_s, scene.gravity_m_s2.x, ...     /tasks/parameters
//   point, sample, own_guess (its label), steps, ...           /tasks
//   cg_ratio.LABEL[@TOLERANCE], iterations_sum.LABEL, ...      /tasks, one of their guesses, by default at `headline`
//   elapsed_s, rank, host, attempt, ...                        /timing/tasks
//
// A value that is not there (a key that does not apply, a pending task's result, a missed sentinel) is NaN or "".
// Throws FileError: for a name that the file has not, with the nearest that it has.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runner/file/hdf5.hpp"

namespace rodsweep {

struct TaskColumn {
  enum class Kind { task, state, own_guess, outcome, number, text };
  std::string name, unit, meaning;
  Kind kind = Kind::number;
  bool whole = false;      ///< integers
  bool swept = false;      ///< a parameter that varies
  bool parameter = false;  ///< a key of the job
  bool result = false;     ///< only of tasks that are done
  std::string guess;       ///< that it is of; "": of none
  bool by_tolerance = false;

  std::string path;         ///< dataset
  std::size_t element = 0;  ///< which value of a row

  bool is_number() const { return kind == Kind::task || kind == Kind::number; }
};

/// One value per task, in the vector that is_number() says.
struct ColumnValues {
  std::vector<double> numbers;     ///< NaN: not there
  std::vector<std::string> texts;  ///< "": not there
};

class TaskTable {
 public:
  explicit TaskTable(const std::filesystem::path& path);

  std::int64_t size() const { return static_cast<std::int64_t>(states_.size()); }
  const std::vector<TaskColumn>& columns() const { return columns_; }  ///< at the headline tolerance only
  const std::vector<std::string>& guesses() const { return guesses_; }
  const std::vector<double>& tolerances() const { return tolerances_; }
  double headline() const;  ///< that of the job's timed solves if it is one and on the ladder, else 1e-2
  bool has_own_guesses() const { return own_guesses_; }  ///< a closed loop

  std::optional<TaskColumn> find(const std::string& name) const;
  TaskColumn column(const std::string& name) const;
  ColumnValues read(const TaskColumn& column) const;

 private:
  void list(const char* group, bool parameters);
  void add(const std::string& name, const std::string& path, bool parameter);
  void choose_headline();
  std::vector<double> numbers(const TaskColumn& column) const;

  std::filesystem::path path_;
  hdf5::File file_;
  std::vector<std::uint8_t> states_;
  std::vector<std::string> guesses_;
  std::vector<double> tolerances_;
  std::size_t headline_ = 0;
  bool own_guesses_ = false;
  std::vector<TaskColumn> columns_;
};

/// "1e-2", "0.03".
std::string tolerance_text(double tolerance);

}  // namespace rodsweep
