// Conjugate gradients on A x = b by PETSc's KSPCG, instrumented: iterations to any tolerance from the residual history.
//
// The operator is BlockMatrix::multiply or that of a system (petsc_operator.hpp). Preconditioners are PETSc's, which
// get a copy of the blocks in its own format where they need entries, or ours (block_preconditioner.hpp); where one of
// ours is not positive definite, no iteration is tried. None is set up for a guess that is good enough (2-norm). Growth
// of the residual is a failure only past 1e30 times `reference`: a history guess may start far above a late, tiny b.
// Products: one for each iteration, one more for the residual of a nonzero guess, if not known. Needs PETSc initialised
// (PetscSession). Throws PetscError when a call fails.
#pragma once

#include <memory>
#include <vector>

#include "solver/linear/block_matrix.hpp"
#include "solver/linear/cg_solver.hpp"

namespace rodsweep {

class ConjugateGradient : public CgSolver {
 public:
  /// Solves with `a`, whose entries may change (say so with matrix_changed()), and which must outlive this.
  ConjugateGradient(const BlockMatrix& a, const CgSettings& settings);
  /// With the matrix of a system, and its product.
  ConjugateGradient(const LinearSystem& system, const CgSettings& settings);
  ~ConjugateGradient() override;
  ConjugateGradient(ConjugateGradient&&) noexcept;
  ConjugateGradient& operator=(ConjugateGradient&&) noexcept;

  void matrix_changed() override;  ///< products always take the entries as they are
  CgReport solve(const VectorX& b, VectorX& x, const CgStart& start, double tolerance, double reference,
                 Deflation* deflation = nullptr) override;
  double norm_of(const VectorX& b) override;
  void keep_history(bool on) override;
  const std::vector<double>& history() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rodsweep
