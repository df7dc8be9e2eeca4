#include "runner/experiment/recorded_iterations.hpp"

#include "runner/experiment/solve_rows.hpp"

namespace rodsweep {

RecordedIterations::RecordedIterations(const Scene& scene, const TaskSpec& spec, TaskRecord& record,
                                       std::unique_ptr<GaussSeidelProjection> projection)
    : spec_(spec), record_(record), rods_(scene.rods.size()), projection_(std::move(projection)) {}

ProjectionReport RecordedIterations::project(Rod& rod, const SolvePosition& at, double dt, double newton_tolerance) {
  const ProjectionReport report = projection_->project(rod, at, dt, newton_tolerance);
  if (!spec_.record.solves || report.outcome == SolveOutcome::not_run) return report;
  const std::size_t row = solve_row(spec_, rods_, at);
  record_position(at, row, record_);
  record_.newton_residual[row] = report.newton_residual;
  return report;
}

}  // namespace rodsweep
