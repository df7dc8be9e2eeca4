// Gauss-Seidel in an experiment: every iteration has a row of /solves with the residual that it met. There is no linear
// system to tell more of; the time is that of the step.
#pragma once

#include <memory>

#include "runner/file/record.hpp"
#include "runner/job/task.hpp"
#include "solver/step/gauss_seidel.hpp"

namespace rodsweep {

class RecordedIterations : public Projection {
 public:
  /// All arguments must outlive this.
  RecordedIterations(const Scene& scene, const TaskSpec& spec, TaskRecord& record,
                     std::unique_ptr<GaussSeidelProjection> projection);

  ProjectionReport project(Rod& rod, const SolvePosition& at, double dt, double newton_tolerance) override;

 private:
  const TaskSpec& spec_;
  TaskRecord& record_;
  std::size_t rods_;
  std::unique_ptr<GaussSeidelProjection> projection_;
};

}  // namespace rodsweep
