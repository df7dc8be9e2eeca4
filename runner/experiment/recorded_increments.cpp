#include "runner/experiment/recorded_increments.hpp"

#include "runner/experiment/models.hpp"
#include "runner/experiment/solve_rows.hpp"

namespace rodsweep {

RecordedIncrements::RecordedIncrements(const Scene& scene, const TaskSpec& spec, TaskRecord& record)
    : spec_(spec),
      record_(record),
      rods_(scene.rods.size()),
      network_(shared_model(spec.solve.model), scene, spec.time.newton_iterations) {}

bool RecordedIncrements::predict(const Rod& rod, const LinearSystem& system, const SolvePosition& at, double dt_c,
                                 VectorX& delta_lambda, std::vector<Lane8>& moves) {
  if (spec_.record.solves) record_system(system, rod, at, solve_row(spec_, rods_, at), record_);
  return network_.predict(rod, system, at, dt_c, delta_lambda, moves);
}

}  // namespace rodsweep
