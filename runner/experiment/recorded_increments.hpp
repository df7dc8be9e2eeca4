// A network in place of the solve, in an experiment: its row of /solves holds the system that it was given. There are
// no iterations to count, and its time is within that of the step.
#pragma once

#include <memory>

#include "network/guess/end_to_end.hpp"
#include "runner/file/record.hpp"
#include "runner/job/task.hpp"

namespace rodsweep {

class RecordedIncrements : public IncrementSource {
 public:
  /// All arguments must outlive this.
  RecordedIncrements(const Scene& scene, const TaskSpec& spec, TaskRecord& record);

  bool predict(const Rod& rod, const LinearSystem& system, const SolvePosition& at, double dt_c, VectorX& delta_lambda,
               std::vector<Lane8>& moves) override;

 private:
  const TaskSpec& spec_;
  TaskRecord& record_;
  std::size_t rods_;
  CopingNetIncrements network_;
};

}  // namespace rodsweep
