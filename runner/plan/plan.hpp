// A job expanded into its tasks: the same list on every rank, so that the master needs to send task numbers only.
//
// Order of tasks: the grid (cross product of all `grid` axes and of the joint axis of the `zip`s, in the order in which
// they stand in the job, the last varying fastest), within a grid point the samples, within a sample (closed loop with
// cg) the guesses. Random values depend on (seed, sample, key path) only, so grid points share draws. Values that do
// not fit together at some point are refused here, before anything runs. Throws JobError (runner/job/job.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "runner/job/job.hpp"
#include "runner/job/sweep_space.hpp"
#include "runner/job/task.hpp"
#include "runner/plan/task_list.hpp"

namespace rodsweep {

/// One column of /tasks: the value of a key (number, 3-vector or string) for every task, defaults included. Where a key
/// does not apply (a helix's at a bending rod) it is NaN, -1 or "".
struct ParameterColumn {
  std::string path;     ///< key path in the job, e.g. "scene.segments"
  std::string unit;     ///< "m", "Pa", "" ...
  std::string meaning;  ///< one line, from the key's description
  bool swept = false;   ///< does it vary over the tasks to which it applies?
  int width = 1;        ///< 3 for vectors
  std::variant<std::vector<double>, std::vector<std::int64_t>, std::vector<std::string>> values;  ///< tasks x width
};

/// All that a task's results depend on, as bytes that are the same in every plan that holds the task.
struct TaskIdentity {
  std::string trajectory;            ///< in a closed loop with the guess that advances it
  std::vector<std::string> guesses;  ///< by place on the guess axis: name and parameters, not the label; empty without
  std::string record;                ///< what of them the job writes
};

class Plan {
 public:
  explicit Plan(Job job);

  /// One of this plan's tasks as a plan of its own, with a frame of the trajectory every so many steps. The task keeps
  /// its point, sample and guess, and so its values and its results; its rows begin at 0.
  Plan alone(std::int64_t index, int trajectory_every) const;
  const std::optional<std::int64_t>& task_alone() const { return task_alone_; }  ///< its number in the whole plan

  const Job& job() const { return job_; }
  std::int64_t size() const { return tasks_.size(); }
  Task task(std::int64_t index) const { return tasks_.at(index); }
  double cost(std::int64_t index) const { return tasks_.cost(index); }
  const TaskList& tasks() const { return tasks_; }
  TaskSpec spec(std::int64_t index) const;  ///< built on demand: a plan of 100,000 tasks stays small

  /// Of this start, in place of the job's; 0: none. What tasks that meet it result in does not depend on it.
  void set_task_time_limit(double seconds) { task_time_limit_s_ = seconds; }

  TaskIdentity identity(std::int64_t index) const;  ///< built on demand

  const std::vector<std::string>& guess_labels() const { return guess_labels_; }  ///< /axes/guess; empty without cg

  /// Built on demand, in the order of the job: every key of scene, time, solve and evaluation that applies anywhere
  /// (`steps` always, from `duration_s` if need be), and of the guesses what varies over the tasks: "guesses[2]" is
  /// the name of the guess itself, "guesses[2].oracle.error" a parameter of it. Keys that stand for many, such as
  /// "scene.contact", where they vary, by their option_label().
  std::vector<ParameterColumn> parameters() const;

  /// Rows of all tasks; 0 of a kind that the job does not record.
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
  std::vector<std::string> kept_;  ///< of a task alone: parameters that the whole plan has columns of
  std::int64_t max_frames_ = 0;
  double task_time_limit_s_;
};

/// Sets how many segments, joints, steps, frames and rows of every kind a task has.
void size_rows(Task& task, const SceneSpec& scene, const TimeSpec& time, const OutputSpec& output);

/// The tolerances at which iterations are counted (/axes/tolerance), relative to ||b||.
const std::vector<double>& tolerance_ladder();  // 1e-1 ... 1e-8

}  // namespace rodsweep
