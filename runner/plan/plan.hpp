// A job expanded into tasks. The list is the same on every rank, so that the master sends only task indices.
//
// Order of tasks: grid points, then samples, then guesses (closed loop with cg). The grid is the cross product of all
// `grid` axes and the joint axis of the `zip`s, in job order, the last varying fastest. Random values depend only on
// (seed, sample, key path), so grid points share draws. Throws JobError (runner/job/job.hpp) if values conflict at any
// point.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "runner/job/job.hpp"
#include "runner/plan/task.hpp"
#include "runner/plan/task_list.hpp"
#include "runner/specs/task_spec.hpp"
#include "runner/sweep/sweep_space.hpp"
#include "solver/scene/scenes.hpp"

namespace rodsweep {

/// The rows of a column, each of `width` values, appended one by one. While all rows are equal, one is stored: of the
/// parameters of a million tasks, most are constant.
template <class Value>
class ColumnValues {
 public:
  using value_type = Value;

  explicit ColumnValues(std::size_t width = 1) : width_(width) {}

  void append(const Value* row) {
    if (rows_++ == 0) {
      values_.assign(row, row + width_);
    } else if (values_.size() > width_ || !equal(row, values_.data())) {
      if (values_.size() == width_) values_ = repeated(rows_ - 1);
      values_.insert(values_.end(), row, row + width_);
    }
  }

  /// All rows, one after another.
  std::vector<Value> all() const { return values_.size() == width_ ? repeated(rows_) : values_; }
  /// One row if all rows are equal, else all.
  const std::vector<Value>& distinct() const { return values_; }

 private:
  bool equal(const Value* a, const Value* b) const {
    if constexpr (std::is_arithmetic_v<Value>)
      return std::memcmp(a, b, width_ * sizeof(Value)) == 0;  // NaN equals NaN
    else
      return std::equal(a, a + width_, b);
  }
  std::vector<Value> repeated(std::size_t times) const {
    std::vector<Value> rows;
    rows.reserve(times * width_);
    for (std::size_t i = 0; i < times; ++i) rows.insert(rows.end(), values_.begin(), values_.end());
    return rows;
  }

  std::size_t width_, rows_ = 0;
  std::vector<Value> values_;
};

/// One column of /tasks: the value of a key (number, 3-vector or string) for every task, including defaults. If the key
/// does not apply to a task (such as a helix key), the value is NaN, -1 or "".
struct ParameterColumn {
  std::string path;     ///< key path in the job, e.g. "scene.segments"
  std::string unit;     ///< "m", "Pa", "" ...
  std::string meaning;  ///< one line, from the key's description
  bool swept = false;   ///< whether it varies over the tasks to which it applies
  int width = 1;        ///< 3 for vectors
  std::variant<ColumnValues<double>, ColumnValues<std::int64_t>, ColumnValues<std::string>> values;  ///< one row a task
};

/// All inputs of a task's results, as bytes that are equal in all plans with this task.
struct TaskInputs {
  std::string trajectory;  ///< in a closed loop including the guess that advances it
  std::vector<std::string>
      guesses;         ///< tried on it, in order: name and parameters without label; empty in a closed loop
  std::string record;  ///< settings of what is recorded

  bool operator==(const TaskInputs& other) const {
    return trajectory == other.trajectory && guesses == other.guesses && record == other.record;
  }
};

class Plan {
 public:
  explicit Plan(Job job);

  /// A plan with one of this plan's tasks, and a trajectory frame every `trajectory_every` steps. The task keeps its
  /// point, sample and guess, and so its values and results; its rows begin at 0.
  Plan single_task(std::int64_t index, int trajectory_every) const;
  const std::optional<std::int64_t>& task_alone() const { return task_alone_; }  ///< its index in the whole plan

  const Job& job() const { return job_; }
  std::int64_t size() const { return tasks_.size(); }
  Task task(std::int64_t index) const { return tasks_.at(index); }
  double cost(std::int64_t index) const { return tasks_.cost(index); }
  const TaskList& tasks() const { return tasks_; }
  TaskSpec spec(std::int64_t index) const;  ///< built on demand: a plan of 100,000 tasks stays small

  /// Replaces the job's limit in this run; 0: none. Results of tasks within the limit do not depend on it.
  void set_task_time_limit(double seconds) { task_time_limit_s_ = seconds; }

  TaskInputs inputs(std::int64_t index) const;  ///< built on demand

  const std::vector<std::string>& guess_labels() const { return guess_labels_; }  ///< /axes/guess; empty without cg

  /// Built on demand, in job order: the keys of scene, time, solve and evaluation that apply to any task, and the keys
  /// of guesses that vary. `steps` is always included, if necessary computed from `duration_s`. "guesses[2]" is the
  /// guess's name, "guesses[2].oracle.error" a parameter. Keys that contain others, such as "scene.contact", are
  /// included by their option_label() if they vary.
  std::vector<ParameterColumn> parameters() const;

  /// Rows of all tasks; 0 for kinds that the job does not record.
  std::int64_t rows(Rows kind) const { return tasks_.rows()[kind]; }
  std::int64_t max_frames() const { return max_frames_; }

 private:
  void fill(Point& point, std::int64_t index) const;
  void expand();
  void add(const Task& task);

  Job job_;
  SweepSpace space_;
  TaskList tasks_;
  std::vector<std::string> guess_labels_;
  std::optional<std::int64_t> task_alone_;
  std::vector<std::string> kept_;  ///< task alone: parameters with columns in the whole plan
  std::int64_t max_frames_ = 0;
  double task_time_limit_s_;
};

/// Sets the numbers of segments, joints, steps, frames and rows of every kind.
void size_rows(Task& task, const SceneSpec& scene, const TimeSpec& time, const OutputSpec& output);

/// The tolerances at which iterations are counted (/axes/tolerance), relative to ||b||.
const std::vector<double>& tolerance_ladder();  // 1e-1 ... 1e-8

// Constructs the scene from a job's values at one parameter point. Throws JobError.

SceneSpec scene_spec(const Point& point, const Job& job);

/// Throws JobError if a value of the scene is not allowed or if there is nothing to solve for.
void check_scene(const SceneSpec& scene, const Job& job);

/// Throws JobError if the scene cannot be built, for example because a segment's mass vanishes.
void check_built(const SceneSpec& scene, const Job& job);

// Whether a job extends an earlier one, in job_extension.cpp: more samples, or more values in a grid or zip, in any
// order (a single value may become a grid that contains it). Name, description, labels of guesses and the paths of
// files with equal content may change. Everything else must be equal, above all the seed and the guesses: times of
// guesses are compared within one run.

/// Throws JobError if `job` does not extend `before`, with the first different key, both values and advice.
void check_extends(const Job& job, const Job& before);
bool extends(const Job& job, const Job& before);

}  // namespace rodsweep
