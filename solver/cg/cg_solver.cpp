#include "solver/cg/cg_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solver/cg/condensed_cg.hpp"
#include "solver/cg/conjugate_gradient.hpp"

namespace rodsweep {
namespace {

/// CG's updated residual is believed down to this, relative to the first one.
constexpr double believed = 1e-12;

/// Of the tolerance: a true residual up to this is taken for rounding.
constexpr double slack = 1.1;

}  // namespace

CgReport CgSolver::solve(const VectorX& b, VectorX& x, const CgStart& start, double tolerance, double reference,
                         Deflation* deflation) {
  history_.clear();
  CgReport report;
  const auto true_residual = [&] {
    multiply(x, residual_);
    residual_ = b - residual_;
    ++report.products;
    return &residual_;
  };
  const auto end_at = [&](double norm, SolveOutcome outcome) {
    if (keeps_history_) history_.push_back(norm);
    report.outcome = outcome;
    return report;
  };
  if (!start.nonzero) x.setZero(b.size());
  const VectorX* residual = !start.nonzero ? &b : start.residual ? start.residual : true_residual();
  for (bool whole = !start.nonzero;;) {
    const double norm = residual->norm();
    if (!std::isfinite(norm)) {
      report.outcome = SolveOutcome::not_a_number;
      return report;
    }
    if (meets(norm, tolerance, reference)) return end_at(norm, SolveOutcome::converged);
    const int left = max_iterations_ - report.iterations;
    if (left == 0) return end_at(norm, SolveOutcome::iteration_limit);
    const double to = whole ? tolerance : std::max(tolerance, believed * norm / b.norm());
    const std::size_t entry = history_.size();
    const CgReport part = iterate({*residual, norm}, x, to, reference, left, deflation);
    report = {part.outcome, report.iterations + part.iterations, report.products + part.products};
    const bool finished = to == tolerance;
    if (part.outcome != SolveOutcome::converged || (finished && !drifts())) break;
    residual = true_residual();
    const double now = residual->norm();
    if (finished && now <= slack * tolerance * reference) {
      --report.products;  // only a check
      break;
    }
    if (keeps_history_) history_.pop_back();
    if (drifts())
      for (std::size_t i = entry; i < history_.size(); ++i) history_[i] = std::max(history_[i], now);
    if (finished && now > norm / 2) return end_at(now, SolveOutcome::iteration_limit);
    whole = finished || part.iterations == 0;  // no iterations: `to` is met in the natural norm
  }
  if (shows_indefinite(b, x, tolerance, report.outcome)) report.outcome = SolveOutcome::indefinite;
  return report;
}

void CgSolver::keep_history(bool on) {
  keeps_history_ = on;
  history_.clear();
  history_.reserve(on ? at(max_iterations_) + 2 : 0);
}

std::unique_ptr<CgSolver> make_cg(const Rod& rod, const LinearSystem& system, const CgSettings& settings) {
  if (settings.preconditioner == Preconditioner::condensed) return std::make_unique<CondensedCg>(rod, system, settings);
  return std::make_unique<ConjugateGradient>(system, settings);
}

int iteration_limit(const CgSettings& settings, int unknowns) {
  if (settings.max_iterations > 0) return settings.max_iterations;
  return std::min(10 * unknowns, int{std::numeric_limits<std::int16_t>::max()});
}

void iterations_to(const std::vector<double>& history, double reference, const std::vector<double>& tolerances,
                   std::int16_t* out) {
  for (std::size_t t = 0; t < tolerances.size(); ++t) {
    out[t] = -1;
    for (std::size_t i = 0; i < history.size() && out[t] < 0; ++i)
      if (history[i] <= tolerances[t] * reference) out[t] = static_cast<std::int16_t>(i);
  }
}

}  // namespace rodsweep
