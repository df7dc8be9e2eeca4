// What a simulation leaves in its task's record after every step, and when it has to end: the observables, the frames
// of the trajectory, the outcome. The same for tasks that run alone and in batches.
#pragma once

#include <string>
#include <vector>

#include "runner/file/record.hpp"
#include "runner/job/task.hpp"
#include "solver/rod/momentum_balance.hpp"
#include "solver/scene/scene.hpp"
#include "solver/step/time_step.hpp"

namespace rodsweep {

/// Ends a task whose time limit has passed: in the step that it was in, or while its systems were built for the first.
void end_late(const TaskSpec& spec, TaskRecord& record);

class SimulationLog {
 public:
  /// `scene` at the start, which is frame 0. All but the scene must outlive this.
  SimulationLog(const Task& task, const TaskSpec& spec, TaskRecord& record, const Scene& scene);

  /// Ends the task if its time limit has passed: true.
  bool out_of_time(double elapsed_s);

  /// `scene` after the step. False: the task has ended here, by a failure.
  bool finish_step(int step, const Scene& scene, const StepReport& report, double constraint_dt);

 private:
  /// What several observables of a rod are made of.
  struct Observed {
    Linearization at;
    MomentumBalance balance;
  };
  void log_step(std::size_t step, const Scene& scene, const StepReport& report, double constraint_dt);
  void fail(TaskOutcome outcome, int step, const std::string& why);
  void log_frame(std::size_t frame, const Scene& scene);

  const Task& task_;
  const TaskSpec& spec_;
  TaskRecord& record_;
  std::vector<Observed> observed_;  ///< of every rod
  double initial_length_ = 0;
};

}  // namespace rodsweep
