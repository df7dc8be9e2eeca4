// Systems for tests of CG, and a solve with its report, solution and history.
#pragma once

#include <vector>

#include "solver/cg/conjugate_gradient.hpp"
#include "solver/factor/block_factor.hpp"
#include "solver/linear/linear_system.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test {

inline constexpr Preconditioner preconditioners[] = {
    Preconditioner::none, Preconditioner::jacobi,    Preconditioner::point_block_jacobi,
    Preconditioner::icc,  Preconditioner::block_icc, Preconditioner::cholesky};

inline const char* name(Preconditioner p) {
  static const char* const names[] = {"none", "jacobi", "point_block_jacobi", "icc", "block_icc", "cholesky"};
  return names[static_cast<std::size_t>(p)];
}

/// Calls `visit` with the settings of each preconditioner in each norm.
template <class Visit>
void each_solver(const Visit& visit) {
  for (const Preconditioner p : preconditioners)
    for (const Norm norm : {Norm::true_residual, Norm::natural}) {
      INFO(name(p) << (norm == Norm::natural ? ", natural norm" : ""));
      visit(CgSettings{p, norm, 0});
    }
}

/// A Newton system of a rod in motion, and its solution.
struct Case {
  Rod rod;
  LinearSystem system;
  VectorX exact;

  explicit Case(const Rod& r) : rod(r), system(assembled(rod)), exact(VectorX::Zero(6 * rod.joint_count())) {
    BlockFactor factor(system.matrix(), root_to_leaf_order(rod));
    REQUIRE(factor.solve(system.matrix(), system.rhs(), exact) == SolveOutcome::converged);
  }
  const BlockMatrix& a() const { return system.matrix(); }
  const VectorX& b() const { return system.rhs(); }
};

/// A moving chain after an unconstrained motion of 0.02 s, so that its constraints are violated.
inline Case moving_chain(int segments = 12) {
  Rod rod = moving_scene(segments).rods.front();
  for (int s = 0; s < rod.segment_count(); ++s)
    if (!rod.segments[s].is_static) rod.position[s] += 0.02 * rod.velocity[s];
  rod.lambda.setZero();
  return Case(rod);
}

struct Run {
  CgReport report;
  VectorX x;
  std::vector<double> history;
};

/// Solves from `guess`, or from zero without one; `residual` is the residual of the guess, if known.
inline Run run(CgSolver& cg, const VectorX& b, double tolerance, const VectorX* guess = nullptr,
               const VectorX* residual = nullptr) {
  Run out{{}, guess ? *guess : VectorX(VectorX::Zero(b.size())), {}};
  cg.keep_history(true);
  out.report = cg.solve(b, out.x, {guess != nullptr, residual}, tolerance, cg.norm_of(b));
  out.history = cg.history();
  return out;
}

inline Run run(const BlockMatrix& a, const CgSettings& settings, const VectorX& b, double tolerance) {
  ConjugateGradient cg(a, settings);
  return run(cg, b, tolerance);
}

}  // namespace rodsweep::test
