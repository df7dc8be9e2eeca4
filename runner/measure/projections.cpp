#include "runner/measure/projections.hpp"

#include <utility>

#include "network/guess/end_to_end.hpp"
#include "network/guess/state_network.hpp"
#include "runner/measure/measured_solve.hpp"
#include "runner/measure/shared_inputs.hpp"
#include "solver/step/gauss_seidel.hpp"

namespace rodsweep {
namespace {

/// A network that replaces the solve. Its rows of /solves describe its input system, without iterations; its time is
/// part of the step's time.
class LoggedIncrements : public IncrementSource {
 public:
  LoggedIncrements(const Scene& scene, const TaskSpec& spec, TaskRecord& record)
      : spec_(spec),
        record_(record),
        rods_(scene.rods.size()),
        network_(shared_model(spec.solve.model), scene, spec.time.newton_iterations) {}

  bool predict(const Rod& rod, const LinearSystem& system, const SolvePosition& at, VectorX& delta_lambda,
               std::vector<Lane8>& moves) override {
    if (spec_.output.solves) log_system(system, rod, at, solve_row(spec_, rods_, at), record_);
    return network_.predict(rod, system, at, delta_lambda, moves);
  }

 private:
  const TaskSpec& spec_;
  TaskRecord& record_;
  std::size_t rods_;
  CopingNetIncrements network_;
};

/// Gauss-Seidel: each iteration has a row of /solves with the residual before it. There is no linear system, and its
/// time is part of the step's time.
class LoggedIterations : public Projection {
 public:
  LoggedIterations(const Scene& scene, const TaskSpec& spec, TaskRecord& record,
                   std::unique_ptr<GaussSeidelProjection> projection)
      : spec_(spec), record_(record), rods_(scene.rods.size()), projection_(std::move(projection)) {}

  ProjectionReport project(Rod& rod, const SolvePosition& at, double dt, double newton_tolerance) override {
    const ProjectionReport report = projection_->project(rod, at, dt, newton_tolerance);
    if (!spec_.output.solves || report.outcome == SolveOutcome::not_run) return report;
    const std::size_t row = solve_row(spec_, rods_, at);
    log_position(at, row, record_);
    record_.solves.newton_residual[row] = report.newton_residual;
    return report;
  }

 private:
  const TaskSpec& spec_;
  TaskRecord& record_;
  std::size_t rods_;
  std::unique_ptr<GaussSeidelProjection> projection_;
};

}  // namespace

std::unique_ptr<Projection> make_projection(const Scene& scene, const TaskSpec& spec, TaskRecord& record,
                                            LinearSolve& solve) {
  switch (spec.solve.method) {
    case Method::direct:
    case Method::cg: break;
    case Method::end_to_end:
      return std::make_unique<EndToEndProjection>(scene, std::make_unique<LoggedIncrements>(scene, spec, record));
    case Method::state_network:
      return std::make_unique<StateNetworkProjection>(scene, shared_model(spec.solve.model), spec.time.step_s);
    case Method::pbd:
      return std::make_unique<LoggedIterations>(scene, spec, record,
                                                std::make_unique<PbdProjection>(scene, spec.solve.stiffness));
    case Method::xpbd:
      return std::make_unique<LoggedIterations>(scene, spec, record, std::make_unique<XpbdProjection>(scene));
  }
  const TimeSpec& time = spec.time;
  return std::make_unique<LinearProjection>(scene, solve,
                                            time.balance ? std::optional(time.momentum_tolerance) : std::nullopt);
}

const char* projection_failed(Method method) {
  if (is_gauss_seidel(method)) return "Gauss-Seidel ended as ";
  return is_network(method) ? "the network's answer is " : "the linear solve ended as ";
}

}  // namespace rodsweep
