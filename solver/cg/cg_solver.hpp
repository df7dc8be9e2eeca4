// Conjugate gradients on A x = b with a history of residuals: the interface of two solvers. The unknowns are the
// joints' multipliers (conjugate_gradient.hpp) or the motions of crossings (condensed_cg.hpp).
//
// Convergence: the norm of A's residual relative to that of b (`reference`), also with a guess. One solver per guess
// and rod.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "solver/cg/block_preconditioner.hpp"
#include "solver/cg/deflation.hpp"
#include "solver/linear/linear_system.hpp"
#include "solver/linear/solve_outcome.hpp"

namespace rodsweep {

/// The norm of r = b - A x in the convergence test: its 2-norm, or (r^T P^-1 r)^1/2 with the preconditioner P, which is
/// not available for `condensed`.
enum class Norm { true_residual, natural };

struct CgSettings {
  Preconditioner preconditioner = Preconditioner::jacobi;
  Norm norm = Norm::true_residual;
  int max_iterations = 0;                                              ///< 0: ten times the unknowns, at most 32767
  int fill_levels = default_fill_levels;                               ///< of block_icc and condensed
  std::function<std::unique_ptr<BlockPreconditioner>()> make_given{};  ///< learned, plugin, python
};

/// The limit for a system. Iterations are stored in 16 bits.
int iteration_limit(const CgSettings& settings, int unknowns);

/// The start of a solve.
struct CgStart {
  bool nonzero = false;               ///< from x; else from zero
  const VectorX* residual = nullptr;  ///< b - A x, if it is known

  CgStart(bool is_nonzero, const VectorX* known_residual = nullptr) : nonzero(is_nonzero), residual(known_residual) {}
};

struct CgReport {
  SolveOutcome outcome = SolveOutcome::not_run;
  int iterations = 0;
  int products = 0;  ///< with A
};

class CgSolver {
 public:
  virtual ~CgSolver() = default;

  /// The next solve that iterates rebuilds the preconditioner, within its time. Without this call the old one is kept.
  virtual void matrix_changed() = 0;

  /// Iterates until the norm is at most tolerance * reference. Sets x to the solution.
  /// With `deflation` every preconditioned residual is projected; the first residual must be orthogonal to its space.
  virtual CgReport solve(const VectorX& b, VectorX& x, const CgStart& start, double tolerance, double reference,
                         Deflation* deflation = nullptr) = 0;

  /// The norm of b to pass as `reference`: ||b||_2, or the natural norm.
  virtual double norm_of(const VectorX& b) = 0;

  /// Norms of the last solve's residuals, [0] before the first iteration, if kept.
  virtual void keep_history(bool on) = 0;
  virtual const std::vector<double>& history() const = 0;
};

/// `rod` and `system` must outlive it.
std::unique_ptr<CgSolver> make_cg(const Rod& rod, const LinearSystem& system, const CgSettings& settings);

/// For each tolerance, the first entry of the history at or below tolerance * reference, -1 if not reached.
void iterations_to(const std::vector<double>& history, double reference, const std::vector<double>& tolerances,
                   std::int16_t* out);

}  // namespace rodsweep
