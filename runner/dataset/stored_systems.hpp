// The linear systems of a data set, written into a task's record during its simulation and read back from it.
//
// Rows go step by step, within a step by Newton iteration (the first, or all), then by rod; each has as many rows of
// segments and joints as its rod. Newton iterations that a step did not need keep their sentinels.
#pragma once

#include <vector>

#include "network/encoding/stored_simulation.hpp"
#include "runner/file/record.hpp"

namespace rodsweep {

/// Where a system stands in a record.
class SystemRows {
 public:
  struct Place {
    std::size_t system = 0, segment = 0, joint = 0;  ///< (first) rows
  };

  /// `iterations`: stored Newton iterations of a step.
  SystemRows(const Scene& scene, int iterations);

  bool holds(const SolvePosition& at) const { return at.newton < iterations_; }
  Place place(const SolvePosition& at) const;

 private:
  int iterations_;
  std::vector<Place> rods_;  ///< of every rod within an iteration
  Place iteration_;          ///< rows of all rods
};

/// Writes systems into a record. Allocates nothing after construction.
class SystemStore {
 public:
  SystemStore(const Scene& scene, int iterations, TaskRecord& record) : rows_(scene, iterations), record_(record) {}

  bool holds(const SolvePosition& at) const { return rows_.holds(at); }

  /// What the system is assembled from: the rod as it is. `balanced`: with the balance of momentum.
  void before(const Rod& rod, const SolvePosition& at, bool balanced);

  /// Where the solution belongs once there is one, six numbers a joint.
  double* solution(const SolvePosition& at) { return record_.system_solution.data() + 6 * rows_.place(at).joint; }

 private:
  SystemRows rows_;
  TaskRecord& record_;
};

/// Records what another solve is given and what it finds. Allocates nothing.
class StoringSolve : public LinearSolve {
 public:
  /// All arguments must outlive this.
  StoringSolve(const Scene& scene, int iterations, LinearSolve& solve, TaskRecord& record);

  SolveOutcome solve(const LinearSystem& system, const SolvePosition& at, double assemble_s,
                     VectorX& delta_lambda) override;

 private:
  const Scene& scene_;
  SystemStore store_;
  LinearSolve& solve_;
};

/// The systems that were solved, in order.
std::vector<StoredSystem> stored_systems(const TaskRecord& record, const Scene& scene, int iterations);

}  // namespace rodsweep
