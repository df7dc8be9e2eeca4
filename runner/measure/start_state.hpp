// The state of a frame of another simulation, from which a task starts ("start" in a job). A simulation that starts from
// a frame of one with the same settings continues it: bit by bit but for what contacts remember, and pauses of the balance
// of momentum (solver/step/time_step.hpp).
#pragma once

#include <memory>

#include "runner/file/record.hpp"
#include "runner/specs/task_spec.hpp"
#include "solver/scene/scene.hpp"
#include "solver/step/time_step.hpp"

namespace rodsweep {

class StartState {
 public:
  /// Puts the scene into the state. Throws FileError if the file does not have it, or if it is of other segments or joints.
  StartState(const StartSpec& spec, Scene& scene);
  /// The same with a record in memory.
  StartState(std::shared_ptr<const TaskRecord> record, const StartSpec& spec, Scene& scene);

  /// For the steps of that scene.
  void continue_steps(TimeStepper& stepper) const;

 private:
  std::shared_ptr<const TaskRecord> record_;
  const Scene& scene_;
  std::size_t first_segment_ = 0;  ///< row of the frame's first segment
};

}  // namespace rodsweep
