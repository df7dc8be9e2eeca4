// Conjugate gradients on A x = b with a history of residuals: the interface of two solvers. The unknowns are the
// joints' multipliers (conjugate_gradient.hpp) or the motions of crossings (condensed_cg.hpp).
//
// Convergence: the norm of A's residual relative to that of b (`reference`), also with a guess. One solver per guess
// and rod. CG updates its residual in each iteration, with rounding errors of the size of the largest residual. So once
// the update is 1e-12 of the first residual, CG starts again from the true one: this happens if a guess starts far above
// b (residual replacement: van der Vorst & Ye 2000, SIAM J. Sci. Comput. 22). If rounding keeps the true
// residual above the tolerance, the outcome is `iteration_limit`. A preconditioner of the user's is examined where
// convergence could be an effect of its not being positive definite.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "solver/cg/block_preconditioner.hpp"
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

/// The projection of deflated CG around its preconditioner M (Saad, Yeung, Erhel & Guyomarc'h 2000, SIAM J. Sci. Comput.
/// 21): the solution in a space V is exact, and M is applied to the rest,
///   z = P M^-1 P^T r + Q r,   Q = V E^-1 V^T,   E = V^T A V,   P = I - Q A.
/// If the first residual is orthogonal to V, P^T r and Q r differ from r and 0 only by rounding. Without these terms the
/// rounding may grow: z = P M^-1 r ignores it, and z = P M^-1 r + Q r (A-DEF2) removes alpha times it, with CG's step
/// alpha. This variant is symmetric (BNN in Tang, Nabben, Vuik & Erlangga 2009, J. Sci. Comput. 39).
class Deflation {
 public:
  virtual ~Deflation() = default;
  /// r <- P^T r, then z <- P z + Q r with that r; as many entries as A has rows. Allocates nothing.
  virtual void reduce(double* r) = 0;
  virtual void complete(double* z) = 0;
};

class CgSolver {
 public:
  CgSolver(int max_iterations, int unknowns) : max_iterations_(max_iterations), residual_(VectorX::Zero(unknowns)) {}
  virtual ~CgSolver() = default;
  CgSolver(CgSolver&&) = default;

  /// The next solve that iterates rebuilds the preconditioner, within its time. Without this call the old one is kept.
  virtual void matrix_changed() = 0;

  /// Iterates until the norm is at most tolerance * reference. Sets x to the solution.
  /// With `deflation` every preconditioned residual is projected; the first residual must be orthogonal to its space.
  CgReport solve(const VectorX& b, VectorX& x, const CgStart& start, double tolerance, double reference,
                 Deflation* deflation = nullptr);

  /// The norm of b to pass as `reference`: ||b||_2, or the natural norm.
  virtual double norm_of(const VectorX& b) = 0;

  /// Norms of the last solve's residuals, [0] before the first iteration, if kept.
  virtual void keep_history(bool on);
  const std::vector<double>& history() const { return history_; }

 protected:
  /// The residual of x with its 2-norm.
  struct Residual {
    const VectorX& entries;
    double norm;
  };
  /// Adds to x the correction for `first`, its residual, in at most `most` iterations. Appends norms to the history, if
  /// kept: that of `first`, and one for each iteration.
  virtual CgReport iterate(const Residual& first, VectorX& x, double tolerance, double reference, int most,
                           Deflation* deflation) = 0;
  /// Whether a residual of this 2-norm needs no iteration.
  virtual bool meets(double norm, double tolerance, double reference) const { return norm <= tolerance * reference; }
  /// Whether norms of iterate() may have large errors, so that convergence is checked on b - A x.
  virtual bool drifts() const { return false; }
  /// y = A x
  virtual void multiply(const VectorX& x, VectorX& y) = 0;
  /// Whether the residual of x, after a solve to `tolerance`, shows that a preconditioner of the user's is not positive
  /// definite.
  virtual bool shows_indefinite(const VectorX& /*b*/, const VectorX& /*x*/, double /*tolerance*/, SolveOutcome) {
    return false;
  }

  int max_iterations_;
  bool keeps_history_ = false;
  std::vector<double> history_;
  VectorX residual_;  ///< b - A x
};

/// `rod` and `system` must outlive it.
std::unique_ptr<CgSolver> make_cg(const Rod& rod, const LinearSystem& system, const CgSettings& settings);

/// For each tolerance, the first entry of the history at or below tolerance * reference, -1 if not reached.
void iterations_to(const std::vector<double>& history, double reference, const std::vector<double>& tolerances,
                   std::int16_t* out);

}  // namespace rodsweep
