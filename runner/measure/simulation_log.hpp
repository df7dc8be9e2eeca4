// Records the observables, trajectory frames and outcome of a simulation after each step, and decides when it ends.
#pragma once

#include <string>
#include <vector>

#include "runner/file/record.hpp"
#include "runner/plan/task.hpp"
#include "runner/specs/task_spec.hpp"
#include "solver/rod/momentum_balance.hpp"
#include "solver/scene/scene.hpp"
#include "solver/step/time_step.hpp"

namespace rodsweep {

/// Records that a task timed out in its current step, or in step 0 if its scene was still being built. `where`: the user's
/// code that was running, or empty.
void end_late(const TaskSpec& spec, TaskRecord& record, const std::string& where = "");

class SimulationLog {
 public:
  /// `scene` is the initial state, which is frame 0. All other arguments must outlive this.
  SimulationLog(const Task& task, const TaskSpec& spec, TaskRecord& record, const Scene& scene,
                const TimeStepper& stepper);

  /// Returns true and ends the task if its time limit has passed.
  bool out_of_time(double elapsed_s);

  /// `scene` is the state after the step. Returns false if a failure ends the task.
  bool finish_step(int step, const Scene& scene, const StepReport& report);

  /// Call after the last step.
  void finish();

  /// The scene is at rest after this step, the task's last: keeps it as a frame.
  void finish_at_rest(int step, const Scene& scene);
  /// Not at rest: the part of the largest force that is missing.
  void lacks(double force) { lacking_ = force; }

 private:
  /// Intermediate results shared by several observables of a rod.
  struct Observed {
    Linearization at;
    MomentumBalance balance;
    VectorX before;  ///< C at the end of the last step
  };
  void log_step(std::size_t step, const Scene& scene, const StepReport& report);
  std::string slipped_joint() const;
  void note_turns(const Scene& scene);
  std::string warnings() const;  ///< of a task that ends well
  void fail(TaskOutcome outcome, int step, const std::string& why);
  void log_frame(std::size_t frame, const Scene& scene);
  void log_reactions(std::size_t step);
  void log_joints(std::size_t frame, const Scene& scene);
  void log_state(std::size_t frame, const Scene& scene);

  const Task& task_;
  const TaskSpec& spec_;
  TaskRecord& record_;
  const TimeStepper& stepper_;
  std::vector<Observed> observed_;  ///< by rod
  double initial_length_ = 0;
  int unbalanced_ = 0;    ///< steps that should have balanced momentum
  bool slipped_ = false;  ///< a joint turned past half a turn
  double lacking_ = 0;
  double tumbled_ = 0, rolled_ = 0;  ///< the most that a segment turned across and about its axis in a step [rad]
};

}  // namespace rodsweep
