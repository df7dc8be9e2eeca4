// PETSc's objects with owners, and KSPCG: its set-up, and its end as a report. Included by sources only.
#pragma once

#include <petscksp.h>

#include "solver/cg/cg_solver.hpp"
#include "solver/cg/petsc_kernels.hpp"

namespace rodsweep {

/// Owns an object and stands for it in calls of PETSc. A destructor cannot report errors; PETSc prints them.
template <class Object, PetscErrorCode (*destroy)(Object*)>
class PetscHandle {
 public:
  explicit PetscHandle(Object object = nullptr) : object_(object) {}
  ~PetscHandle() { destroy(&object_); }
  PetscHandle(const PetscHandle&) = delete;
  PetscHandle& operator=(const PetscHandle&) = delete;
  void reset(Object object) {
    destroy(&object_);
    object_ = object;
  }
  operator Object() const { return object_; }

 private:
  Object object_;
};
using MatHandle = PetscHandle<Mat, MatDestroy>;
using VecHandle = PetscHandle<Vec, VecDestroy>;
using PcHandle = PetscHandle<PC, PCDestroy>;
using KspHandle = PetscHandle<KSP, KSPDestroy>;

using ConvergenceTest = PetscErrorCode(KSP, PetscInt, PetscReal, KSPConvergedReason*, void*);
using PcApplication = PetscErrorCode(PC, Vec, Vec);

/// Creates KSPCG and returns its preconditioner, which is not set. `context`: of the test. `entries`: for PETSc's
/// preconditioners.
inline PC create_cg(KspHandle& ksp, KSPNormType norm, Mat product, Mat entries, ConvergenceTest* test, void* context) {
  KSP made = nullptr;
  petsc_check(KSPCreate(PETSC_COMM_SELF, &made), "KSPCreate");
  ksp.reset(made);
  petsc_check(KSPSetType(ksp, KSPCG), "KSPSetType");
  petsc_check(KSPSetNormType(ksp, norm), "KSPSetNormType");
  petsc_check(KSPSetOperators(ksp, product, entries), "KSPSetOperators");
  petsc_check(KSPSetConvergenceTest(ksp, test, context, nullptr), "KSPSetConvergenceTest");
  PC pc = nullptr;
  petsc_check(KSPGetPC(ksp, &pc), "KSPGetPC");
  return pc;
}

/// Makes a preconditioner one of ours.
inline void set_shell(PC pc, PcApplication* apply, void* context) {
  petsc_check(PCSetType(pc, PCSHELL), "PCSetType");
  petsc_check(PCShellSetContext(pc, context), "PCShellSetContext");
  petsc_check(PCShellSetApply(pc, apply), "PCShellSetApply");
}

/// Only our tests of convergence return KSP_CONVERGED_RTOL. KSPCG itself says KSP_CONVERGED_ATOL if r.z is 0 for a
/// residual that is not: the preconditioner is not positive definite.
inline SolveOutcome outcome_of(KSPConvergedReason reason) {
  switch (reason) {
    case KSP_CONVERGED_RTOL: return SolveOutcome::converged;
    case KSP_DIVERGED_ITS: return SolveOutcome::iteration_limit;
    case KSP_DIVERGED_NANORINF: return SolveOutcome::not_a_number;
    case KSP_CONVERGED_ATOL:
    case KSP_DIVERGED_INDEFINITE_MAT:
    case KSP_DIVERGED_INDEFINITE_PC:
    case KSP_DIVERGED_PC_FAILED: return SolveOutcome::indefinite;
    default: return SolveOutcome::diverged;
  }
}

/// How the last solve ended, without its products.
inline CgReport report_of(KSP ksp) {
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  PetscInt iterations = 0;
  petsc_check(KSPGetConvergedReason(ksp, &reason), "KSPGetConvergedReason");
  petsc_check(KSPGetIterationNumber(ksp, &iterations), "KSPGetIterationNumber");
  return {outcome_of(reason), static_cast<int>(iterations), 0};
}

}  // namespace rodsweep
