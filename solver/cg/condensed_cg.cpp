#include "solver/cg/condensed_cg.hpp"

#include <petscksp.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "solver/cg/ksp_outcome.hpp"
#include "solver/cg/petsc_check.hpp"
#include "solver/cg/petsc_operator.hpp"
#include "solver/cg/petsc_vector.hpp"
#include "solver/factor/condensation.hpp"
#include "solver/linear/interruption.hpp"

namespace rodsweep {

struct CondensedCg::Impl {
  const Rod& rod;
  const LinearSystem& system;
  Condensation condensation;
  std::unique_ptr<BlockPreconditioner> preconditioner;
  BlockOperator op;
  int max_iterations;
  bool stale = true, positive = true;
  VectorX g, d, residual;
  Mat product = nullptr;
  KSP ksp = nullptr;
  Vec rhs = nullptr, y = nullptr;
  double goal = 0, norm = 0;
  bool keeps_history = false;
  std::vector<double> history;

  Impl(const Rod& r, const LinearSystem& of, const CgSettings& settings)
      : rod(r),
        system(of),
        condensation(r),
        preconditioner(block_preconditioner(Preconditioner::block_icc, condensation.matrix(), settings.fill_levels)),
        op{condensation.matrix()},
        max_iterations(iteration_limit(settings, of.matrix().unknowns())),
        g(VectorX::Zero(op.a.unknowns())),
        d(VectorX::Zero(of.matrix().unknowns())),
        residual(d) {
    if (op.a.block_rows() == 0) return;
    product = create_operator(op);
    rhs = create_vector(op.a.unknowns());
    y = create_vector(op.a.unknowns());
    petsc_check(KSPCreate(PETSC_COMM_SELF, &ksp), "KSPCreate");
    petsc_check(KSPSetType(ksp, KSPCG), "KSPSetType");
    petsc_check(KSPSetNormType(ksp, KSP_NORM_NATURAL), "KSPSetNormType");
    PC pc = nullptr;
    petsc_check(KSPGetPC(ksp, &pc), "KSPGetPC");
    petsc_check(PCSetType(pc, PCSHELL), "PCSetType");
    petsc_check(PCShellSetContext(pc, this), "PCShellSetContext");
    petsc_check(PCShellSetApply(pc, apply), "PCShellSetApply");
    petsc_check(KSPSetOperators(ksp, product, product), "KSPSetOperators");
    petsc_check(KSPSetTolerances(ksp, 0, 0, PETSC_DEFAULT, max_iterations - 1), "KSPSetTolerances");
    petsc_check(KSPSetConvergenceTest(ksp, test, this, nullptr), "KSPSetConvergenceTest");
  }
  ~Impl() {
    KSPDestroy(&ksp);
    MatDestroy(&product);
    VecDestroy(&y);
    VecDestroy(&rhs);
  }

  /// KSPCG applies it to each of its residuals before the convergence test.
  static PetscErrorCode apply(PC pc, Vec p, Vec z) noexcept {
    void* context = nullptr;
    if (const PetscErrorCode error = PCShellGetContext(pc, &context)) return error;
    Impl& self = *static_cast<Impl*>(context);
    self.norm = self.condensation.residual_norm(vector_data(p));
    self.preconditioner->apply(vector_data(p), vector_data(z));
    return entries_changed(z);
  }
  static PetscErrorCode test(KSP, PetscInt, PetscReal natural, KSPConvergedReason* reason, void* context) noexcept {
    Impl& self = *static_cast<Impl*>(context);
    if (self.keeps_history) self.history.push_back(self.norm);
    *reason = KSP_CONVERGED_ITERATING;
    if (!std::isfinite(natural) || !std::isfinite(self.norm))
      *reason = KSP_DIVERGED_NANORINF;
    else if (self.norm <= self.goal)
      *reason = KSP_CONVERGED_RTOL;
    else if (is_interrupted(work_of_iteration(self.op.a)))
      *reason = KSP_DIVERGED_BREAKDOWN;
    return 0;
  }

  /// Assembles the system and, if stale, the preconditioner. Returns false if either is not positive definite.
  bool refresh() {
    const bool condensed = condensation.assemble(rod, system.linearization(), system.dt());
    if (std::exchange(stale, false)) positive = preconditioner->set_up(op.a);
    return condensed && positive;
  }
};

CondensedCg::CondensedCg(const Rod& rod, const LinearSystem& system, const CgSettings& settings)
    : impl_(std::make_unique<Impl>(rod, system, settings)) {}
CondensedCg::~CondensedCg() = default;

void CondensedCg::matrix_changed() { impl_->stale = true; }

CgReport CondensedCg::solve(const VectorX& b, VectorX& x, const CgStart& start, double tolerance, double reference,
                            Deflation* deflation) {
  if (deflation) throw std::logic_error("CondensedCg: deflation is not supported");
  Impl& s = *impl_;
  s.history.clear();
  CgReport report{SolveOutcome::converged, 0, 0};
  const bool known = start.nonzero && start.residual;
  if (start.nonzero && !known) {
    s.system.multiply(x.data(), s.residual.data());
    s.residual = b - s.residual;
    report.products = 1;
  } else {
    s.residual = known ? *start.residual : b;
  }
  s.goal = tolerance * reference;
  const double first = s.residual.norm();
  if (s.keeps_history) s.history.push_back(first);
  if (!start.nonzero) x.setZero(b.size());
  if (!std::isfinite(first)) return {SolveOutcome::not_a_number, 0, report.products};
  if (first <= s.goal) return report;

  if (!s.refresh()) return {SolveOutcome::indefinite, 0, report.products};
  s.condensation.condense(s.residual, s.g);
  report.iterations = 1;
  if (!s.ksp) {
    s.condensation.expand(s.residual, nullptr, s.d);
    if (s.keeps_history) s.history.push_back(0);
    x += s.d;
    return report;
  }
  copy(s.g, s.rhs);
  petsc_check(KSPSolve(s.ksp, s.rhs, s.y), "KSPSolve");
  check_interrupted(0);
  s.condensation.expand(s.residual, vector_data(s.y), s.d);
  x += s.d;
  PetscInt iterations = 0;
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  petsc_check(KSPGetIterationNumber(s.ksp, &iterations), "KSPGetIterationNumber");
  petsc_check(KSPGetConvergedReason(s.ksp, &reason), "KSPGetConvergedReason");
  report.iterations += static_cast<int>(iterations);
  report.outcome = outcome_of(reason);
  return report;
}

void CondensedCg::keep_history(bool on) {
  impl_->keeps_history = on;
  impl_->history.clear();
  impl_->history.reserve(on ? static_cast<std::size_t>(impl_->max_iterations) + 2 : 0);
}

const std::vector<double>& CondensedCg::history() const { return impl_->history; }

}  // namespace rodsweep
