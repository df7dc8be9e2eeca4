// Conjugate gradients on A x = b by PETSc's KSPCG. The history of residuals gives the iterations to any tolerance.
//
// The operator is BlockMatrix::multiply or that of a system (petsc_kernels.hpp). Preconditioners are PETSc's, with a
// copy of the blocks in its format if they need entries, or ours (block_preconditioner.hpp). If one of ours is not
// positive definite, no iteration is made. None is set up if the guess already meets the tolerance (2-norm). The solve
// diverges only above 1e30 times `reference`: a guess from history may start far above a small b. Products: one for
// each iteration, one more for the residual of a nonzero guess, if not known, and for each that replaces CG's. PETSc must
// be initialised (PetscSession).
// Throws PetscError if a call fails.
#pragma once

#include <memory>

#include "solver/cg/cg_solver.hpp"
#include "solver/linear/block_matrix.hpp"

namespace rodsweep {

class ConjugateGradient : public CgSolver {
 public:
  /// Solves with `a`, which must outlive this. Call matrix_changed() when its entries change.
  ConjugateGradient(const BlockMatrix& a, const CgSettings& settings);
  /// With the matrix of a system, and its product.
  ConjugateGradient(const LinearSystem& system, const CgSettings& settings);
  ~ConjugateGradient() override;
  ConjugateGradient(ConjugateGradient&&) noexcept;

  void matrix_changed() override;  ///< products always use the current entries
  double norm_of(const VectorX& b) override;
  void keep_history(bool on) override;

 private:
  CgReport iterate(const Residual& first, VectorX& x, double tolerance, double reference, int most,
                   Deflation* deflation) override;
  bool meets(double norm, double tolerance, double reference) const override;
  void multiply(const VectorX& x, VectorX& y) override;
  bool shows_indefinite(const VectorX& b, const VectorX& x, double tolerance, SolveOutcome outcome) override;

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rodsweep
