// The linear systems of a data set: written to a task's record during its simulation, and read back from it.
//
// Rows are ordered by step, then by Newton iteration (the first, or all), then by rod. Each system has the segment and
// joint rows of its rod. Rows of Newton iterations that a step did not need keep their fill values.
#pragma once

#include <vector>

#include "network/encoding/stored_simulation.hpp"
#include "runner/file/record.hpp"

namespace rodsweep {

/// The rows of a system in a record.
class SystemRows {
 public:
  struct First {
    std::size_t system = 0, segment = 0, joint = 0;  ///< (first) rows
  };

  /// `iterations`: stored Newton iterations per step.
  SystemRows(const Scene& scene, int iterations);

  bool holds(const SolvePosition& at) const { return at.newton < iterations_; }
  First first_of(const SolvePosition& at) const;

 private:
  int iterations_;
  std::vector<First> rods_;  ///< offset of each rod within an iteration
  First iteration_;          ///< rows of all rods
};

/// Records the input and the solution of another solve in a task's record. Allocates nothing after construction.
class StoringSolve : public LinearSolve {
 public:
  /// All arguments must outlive this.
  StoringSolve(const Scene& scene, int iterations, LinearSolve& solve, TaskRecord& record)
      : scene_(scene), rows_(scene, iterations), solve_(solve), record_(record) {}

  SolveOutcome solve(const LinearSystem& system, const SolvePosition& at, double assemble_s,
                     VectorX& delta_lambda) override;

 private:
  /// Writes the rod's state, from which the system is assembled. `balanced`: also the data of the momentum balance.
  void write_state(const Rod& rod, const SolvePosition& at, bool balanced);

  const Scene& scene_;
  SystemRows rows_;
  LinearSolve& solve_;
  TaskRecord& record_;
};

/// Reads the solved systems, in order.
std::vector<StoredSystem> stored_systems(const TaskRecord& record, const Scene& scene, int iterations);

}  // namespace rodsweep
