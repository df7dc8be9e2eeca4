#include "solver/cg/condensed_cg.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "solver/cg/petsc_kernels.hpp"
#include "solver/cg/petsc_ksp.hpp"
#include "solver/factor/condensation.hpp"
#include "solver/linear/interruption.hpp"

namespace rodsweep {

struct CondensedCg::Impl {
  const Rod& rod;
  const LinearSystem& system;
  Condensation condensation;
  std::unique_ptr<BlockPreconditioner> preconditioner;
  BlockOperator op;
  bool stale = true, positive = true;
  VectorX g, d;
  MatHandle product;
  VecHandle rhs, y;
  KspHandle ksp;  ///< null: no crossings
  double goal = 0, norm = 0;
  std::vector<double>* history = nullptr;  ///< null: not kept

  Impl(const Rod& r, const LinearSystem& of, const CgSettings& settings)
      : rod(r),
        system(of),
        condensation(r),
        preconditioner(block_preconditioner(Preconditioner::block_icc, condensation.matrix(), settings.fill_levels)),
        op{condensation.matrix()},
        g(VectorX::Zero(op.a.unknowns())),
        d(VectorX::Zero(of.matrix().unknowns())) {
    if (op.a.block_rows() == 0) return;
    product.reset(create_operator(op));
    rhs.reset(create_vector(op.a.unknowns()));
    y.reset(create_vector(op.a.unknowns()));
    set_shell(create_cg(ksp, KSP_NORM_NATURAL, product, product, test, this), apply, this);
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
    if (self.history) self.history->push_back(self.norm);
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
    : CgSolver(iteration_limit(settings, system.matrix().unknowns()), system.matrix().unknowns()),
      impl_(std::make_unique<Impl>(rod, system, settings)) {}
CondensedCg::~CondensedCg() = default;

void CondensedCg::matrix_changed() { impl_->stale = true; }

void CondensedCg::multiply(const VectorX& x, VectorX& y) { impl_->system.multiply(x.data(), y.data()); }

CgReport CondensedCg::iterate(const Residual& first, VectorX& x, double tolerance, double reference, int most,
                              Deflation* deflation) {
  if (deflation) throw std::logic_error("CondensedCg: deflation is not supported");
  Impl& s = *impl_;
  s.goal = tolerance * reference;
  s.history = keeps_history_ ? &history_ : nullptr;
  if (s.history) s.history->push_back(first.norm);
  if (!s.refresh()) return {SolveOutcome::indefinite, 0, 0};
  s.condensation.condense(first.entries, s.g);
  if (!s.ksp) {
    s.condensation.expand(first.entries, nullptr, s.d);
    if (s.history) s.history->push_back(0);
    x += s.d;
    return {SolveOutcome::converged, 1, 0};
  }
  copy(s.g, s.rhs);
  petsc_check(KSPSetTolerances(s.ksp, 0, 0, PETSC_DEFAULT, most - 1), "KSPSetTolerances");
  petsc_check(KSPSolve(s.ksp, s.rhs, s.y), "KSPSolve");
  check_interrupted(0);
  s.condensation.expand(first.entries, vector_data(s.y), s.d);
  x += s.d;
  CgReport report = report_of(s.ksp);
  ++report.iterations;
  return report;
}

}  // namespace rodsweep
