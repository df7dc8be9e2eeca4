// Conjugate gradients on A x = b by PETSc's KSPCG, instrumented: iterations to any tolerance from the residual history.
//
// The operator is BlockMatrix::multiply or that of a system (petsc_operator.hpp). Preconditioners are PETSc's, which
// get a copy of the blocks in its own format where they need entries, or ours (block_preconditioner.hpp); where one of
// ours is not positive definite, no solve is tried. Convergence: the norm of the residual relative to that of b
// (`reference`), also with a nonzero guess; growth is a failure only past 1e30 times that: a history guess may start
// far above a late, tiny b. One solver per guess and rod. Needs PETSc initialised (PetscSession). Throws PetscError
// when a call fails.
#pragma once

#include <memory>
#include <vector>

#include "solver/linear/block_matrix.hpp"
#include "solver/linear/block_preconditioner.hpp"
#include "solver/linear/deflation.hpp"
#include "solver/linear/linear_system.hpp"
#include "solver/linear/solve_outcome.hpp"

namespace rodsweep {

/// The norm of r = b - A x that decides convergence: its 2-norm, or (r^T P^-1 r)^1/2 with the preconditioner P.
enum class Norm { true_residual, natural };

struct CgSettings {
  Preconditioner preconditioner = Preconditioner::jacobi;
  Norm norm = Norm::true_residual;
  int max_iterations = 0;                 ///< 0: ten times the number of unknowns
  int fill_levels = default_fill_levels;  ///< of block_icc
};

/// What a solve starts from.
struct CgStart {
  bool nonzero = false;               ///< from x; else from zero
  const VectorX* residual = nullptr;  ///< b - A x, where somebody knows it

  CgStart(bool is_nonzero, const VectorX* known_residual = nullptr) : nonzero(is_nonzero), residual(known_residual) {}
};

struct CgReport {
  SolveOutcome outcome = SolveOutcome::not_run;
  int iterations = 0;
  int products = 0;  ///< with A: one for each iteration, one more for the residual of a nonzero guess, if not known
};

class ConjugateGradient {
 public:
  /// Solves with `a`, whose entries may change (say so with matrix_changed()), and which must outlive this.
  ConjugateGradient(const BlockMatrix& a, const CgSettings& settings);
  /// With the matrix of a system, and its product.
  ConjugateGradient(const LinearSystem& system, const CgSettings& settings);
  ~ConjugateGradient();
  ConjugateGradient(ConjugateGradient&&) noexcept;
  ConjugateGradient& operator=(ConjugateGradient&&) noexcept;

  /// The preconditioner is rebuilt in the next solve (and its time counted there). Without it the old one is kept;
  /// products always take the entries as they are.
  void matrix_changed();

  /// Until the norm is below tolerance * reference. x receives the solution.
  /// With `deflation` every preconditioned residual is projected; the first residual has no part in its space then.
  CgReport solve(const VectorX& b, VectorX& x, const CgStart& start, double tolerance, double reference,
                 Deflation* deflation = nullptr);

  /// The norm of b in which `reference` is to be given: ||b||_2, or the natural one.
  double norm_of(const VectorX& b);

  /// Norms of the residual, [0] before the first iteration; of the last solve, if it was kept.
  void keep_history(bool on);
  const std::vector<double>& history() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// For each tolerance, the first entry of the history at or below tolerance * reference, -1 where there is none.
void iterations_to(const std::vector<double>& history, double reference, const std::vector<double>& tolerances,
                   std::int16_t* out);

}  // namespace rodsweep
