// Conjugate gradients on A x = b, instrumented: what their kinds have in common, those on the joints' multipliers
// (conjugate_gradient.hpp) and those on the motions of crossings (condensed_cg.hpp).
//
// Convergence: the norm of A's residual relative to that of b (`reference`), also with a nonzero guess. One solver per
// guess and rod.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "solver/linear/block_preconditioner.hpp"
#include "solver/linear/deflation.hpp"
#include "solver/linear/linear_system.hpp"
#include "solver/linear/solve_outcome.hpp"

namespace rodsweep {

/// The norm of r = b - A x that decides convergence: its 2-norm, or (r^T P^-1 r)^1/2 with the preconditioner P, which
/// `condensed` has not.
enum class Norm { true_residual, natural };

struct CgSettings {
  Preconditioner preconditioner = Preconditioner::jacobi;
  Norm norm = Norm::true_residual;
  int max_iterations = 0;                 ///< 0: ten times the number of unknowns
  int fill_levels = default_fill_levels;  ///< of block_icc and condensed
};

/// Of a system with so many unknowns; iterations are stored in 16 bits.
int iteration_limit(const CgSettings& settings, int unknowns);

/// What a solve starts from.
struct CgStart {
  bool nonzero = false;               ///< from x; else from zero
  const VectorX* residual = nullptr;  ///< b - A x, where somebody knows it

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

  /// The preconditioner is rebuilt in the next solve that iterates (and its time counted there); else the old is kept.
  virtual void matrix_changed() = 0;

  /// Until the norm is below tolerance * reference. x receives the solution.
  /// With `deflation` every preconditioned residual is projected; the first residual has no part in its space then.
  virtual CgReport solve(const VectorX& b, VectorX& x, const CgStart& start, double tolerance, double reference,
                         Deflation* deflation = nullptr) = 0;

  /// The norm of b in which `reference` is to be given: ||b||_2, or the natural one.
  virtual double norm_of(const VectorX& b) = 0;

  /// Norms of the residual, [0] before the first iteration; of the last solve, if it was kept.
  virtual void keep_history(bool on) = 0;
  virtual const std::vector<double>& history() const = 0;
};

/// `rod` and `system` must outlive it.
std::unique_ptr<CgSolver> make_cg(const Rod& rod, const LinearSystem& system, const CgSettings& settings);

/// For each tolerance, the first entry of the history at or below tolerance * reference, -1 where there is none.
void iterations_to(const std::vector<double>& history, double reference, const std::vector<double>& tolerances,
                   std::int16_t* out);

}  // namespace rodsweep
