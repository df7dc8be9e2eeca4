// Conjugate gradients on a condensed system (condensation.hpp) by PETSc's KSPCG: struts are eliminated, crossings are
// solved iteratively with an incomplete factor of their matrix (block_icc of block_preconditioner.hpp).
//
// It solves A d = r for the correction of multipliers with residual r. The convergence test uses the norm of A's
// residual, so the accuracy is that of ConjugateGradient. The first iteration is the elimination of struts: residuals
// are known before it (entry 0 of the history), and after every further one. The elimination of stiff struts loses
// digits. So the solve continues from the true residual if that does not meet the tolerance. PETSc must be initialised.
// Throws PetscError if a call fails.
#pragma once

#include <memory>

#include "solver/cg/cg_solver.hpp"

namespace rodsweep {

class CondensedCg : public CgSolver {
 public:
  /// `rod` and `system` must outlive this.
  CondensedCg(const Rod& rod, const LinearSystem& system, const CgSettings& settings = {});
  ~CondensedCg() override;

  void matrix_changed() override;
  double norm_of(const VectorX& b) override { return b.norm(); }

 private:
  /// `deflation` must be null.
  CgReport iterate(const Residual& first, VectorX& x, double tolerance, double reference, int most,
                   Deflation* deflation) override;
  bool drifts() const override { return true; }
  void multiply(const VectorX& x, VectorX& y) override;

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rodsweep
