// One Newton iteration of the time step on one rod, behind one interface.
//
// Projection moves a rod towards its constraints. LinearProjection assembles A dlambda = b, calls a LinearSolve and
// applies the solution: the direct solve, CG, and the paired evaluation that tries many guesses on the same system.
// Virtual calls are per solve, never per segment.
#pragma once

#include <optional>
#include <vector>

#include "solver/factor/direct_factor.hpp"
#include "solver/linear/linear_system.hpp"
#include "solver/linear/solve_outcome.hpp"
#include "solver/scene/scene.hpp"

namespace rodsweep {

/// Zeros: a vector of unknowns for every rod.
std::vector<VectorX> unknowns_of(const Scene& scene);

/// The place of a solve in a simulation.
struct SolvePosition {
  int step = 0;    ///< time step, from 0
  int newton = 0;  ///< Newton iteration, from 0
  int rod = 0;     ///< rod of the scene
};

struct ProjectionReport {
  SolveOutcome outcome = SolveOutcome::not_run;
  double newton_residual = 0;    ///< max |C + alpha~ lambda| before the projection
  double momentum_residual = 0;  ///< of the balance, if it is kept
};

class Projection {
 public:
  virtual ~Projection() = default;
  /// Projects unless the residual is below `newton_tolerance` (outcome not_run).
  virtual ProjectionReport project(Rod& rod, const SolvePosition& at, double dt, double newton_tolerance) = 0;
  /// Whether Newton's iteration continues until momentum is in balance as well (momentum_balance.hpp). Returns whether
  /// this projection supports that.
  virtual bool keep_balance(bool) { return false; }
};

class LinearSolve {
 public:
  virtual ~LinearSolve() = default;
  /// Solves the assembled system. `assemble_s`: wall time that its assembly took [s]. Non-convergence is an outcome.
  virtual SolveOutcome solve(const LinearSystem& system, const SolvePosition& at, double assemble_s,
                             VectorX& delta_lambda) = 0;
};

class LinearProjection : public Projection {
 public:
  /// With a `momentum_tolerance` (for the residual of the balance of momentum), the projection can keep the balance.
  LinearProjection(const Scene& scene, LinearSolve& solve, std::optional<double> momentum_tolerance = {});
  /// If the balance is kept, not_run also requires the momentum tolerance.
  ProjectionReport project(Rod& rod, const SolvePosition& at, double dt, double newton_tolerance) override;
  bool keep_balance(bool wanted) override { return keeps_balance_ = wanted && momentum_tolerance_; }

  const LinearSystem& system(int rod) const { return systems_[at(rod)]; }

 private:
  std::vector<LinearSystem> systems_;
  std::vector<VectorX> delta_lambda_;
  LinearSolve& solve_;
  std::optional<double> momentum_tolerance_;
  bool keeps_balance_ = false;
};

/// Deul et al.: the exact solution by block elimination (direct_factor.hpp).
class DirectSolve : public LinearSolve {
 public:
  /// For systems assembled from the rods of `scene`, which must outlive this.
  explicit DirectSolve(const Scene& scene);
  SolveOutcome solve(const LinearSystem& system, const SolvePosition& at, double assemble_s,
                     VectorX& delta_lambda) override;

 private:
  const Scene& scene_;
  std::vector<DirectFactor> factors_;
};

}  // namespace rodsweep
