#include "solver/cg/conjugate_gradient.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <utility>

#include "solver/cg/petsc_kernels.hpp"
#include "solver/cg/petsc_ksp.hpp"
#include "solver/linear/interruption.hpp"

namespace rodsweep {
namespace {

constexpr double divergence_limit = 1e30;

/// The target of the convergence test.
struct Target {
  double tolerance = 0;
  double reference = 0;
  std::int64_t work = 0;  ///< of an iteration, for is_interrupted()
};

PetscErrorCode test_convergence(KSP, PetscInt, PetscReal norm, KSPConvergedReason* reason, void* context) noexcept {
  const Target& target = *static_cast<const Target*>(context);
  *reason = KSP_CONVERGED_ITERATING;
  if (!std::isfinite(norm))
    *reason = KSP_DIVERGED_NANORINF;
  else if (norm <= target.tolerance * target.reference)
    *reason = KSP_CONVERGED_RTOL;
  else if (norm > divergence_limit * target.reference)
    *reason = KSP_DIVERGED_DTOL;
  else if (is_interrupted(target.work))
    *reason = KSP_DIVERGED_BREAKDOWN;
  return 0;
}

PCType pc_type(Preconditioner p) {
  switch (p) {
    case Preconditioner::none: return PCNONE;
    case Preconditioner::jacobi: return PCJACOBI;
    case Preconditioner::icc: return PCICC;
    default: return PCSHELL;
  }
}

/// A preconditioner that is not PETSc's.
struct Shell {
  std::unique_ptr<BlockPreconditioner> preconditioner;  ///< null: PETSc's
  bool positive = true;                                 ///< at the last set-up
  std::exception_ptr failure;                           ///< of its application: PETSc's frames pass no exceptions
};

PetscErrorCode apply_shell(PC pc, Vec r, Vec z) noexcept {
  void* context = nullptr;
  if (const PetscErrorCode error = PCShellGetContext(pc, &context)) return error;
  Shell& shell = *static_cast<Shell*>(context);
  try {
    shell.preconditioner->apply(vector_data(r), vector_data(z));
  } catch (...) {
    shell.failure = std::current_exception();
    PetscInt size = 0;
    if (const PetscErrorCode error = VecGetLocalSize(z, &size)) return error;
    std::fill_n(vector_data(z), size, std::numeric_limits<double>::quiet_NaN());  // ends KSPSolve
  }
  return entries_changed(z);
}

/// A preconditioner with a projection around it.
struct Projected {
  PC inner = nullptr;
  Deflation* deflation = nullptr;
  VecHandle reduced;
};

PetscErrorCode apply_projected(PC pc, Vec r, Vec z) noexcept {
  void* context = nullptr;
  if (const PetscErrorCode error = PCShellGetContext(pc, &context)) return error;
  const Projected& projected = *static_cast<const Projected*>(context);
  if (const PetscErrorCode error = VecCopy(r, projected.reduced)) return error;
  projected.deflation->reduce(vector_data(projected.reduced));
  if (const PetscErrorCode error = entries_changed(projected.reduced)) return error;
  if (const PetscErrorCode error = PCApply(projected.inner, projected.reduced, z)) return error;
  projected.deflation->complete(vector_data(z));
  return entries_changed(z);
}

}  // namespace

struct ConjugateGradient::Impl {
  const BlockMatrix& a;
  BlockOperator op;
  CgSettings settings;
  VecHandle b, x, scratch;
  MatHandle product;
  MatHandle entries;  ///< copy of the upper blocks for PETSc's icc; else null
  Shell own;
  Projected projected;
  PcHandle plain, shell;  ///< the preconditioner; with projections, once used
  KspHandle ksp;
  Target target;
  int most = 0;       ///< PETSc's limit of iterations
  bool stale = true;  ///< the preconditioner belongs to older entries
  std::vector<PetscReal> history_buffer;

  Impl(const BlockMatrix& matrix, const ConstraintProduct* without_blocks, const CgSettings& s)
      : a(matrix),
        op{matrix, without_blocks},
        settings(s),
        b(create_vector(a.unknowns())),
        x(create_vector(a.unknowns())),
        scratch(create_vector(a.unknowns())),
        product(create_operator(op)) {
    if (settings.preconditioner == Preconditioner::icc) create_entries();
    own.preconditioner = settings.make_given ? settings.make_given()
                                             : block_preconditioner(settings.preconditioner, a, settings.fill_levels);

    const PC pc = create_cg(ksp, settings.norm == Norm::natural ? KSP_NORM_NATURAL : KSP_NORM_UNPRECONDITIONED, product,
                            entries ? entries : product, test_convergence, &target);
    petsc_check(PetscObjectReference(reinterpret_cast<PetscObject>(pc)), "PetscObjectReference");
    plain.reset(pc);
    petsc_check(PCSetType(plain, pc_type(settings.preconditioner)), "PCSetType");
    if (own.preconditioner) set_shell(plain, apply_shell, &own);
  }

  void create_entries() {
    std::vector<PetscInt> start{0}, columns;
    for (int row = 0; row < a.block_rows(); ++row) {
      for (int k = a.diagonal(row); k < a.row_end(row); ++k) columns.push_back(a.column(k));
      start.push_back(static_cast<PetscInt>(columns.size()));
    }
    const PetscInt n = a.unknowns();
    Mat made = nullptr;
    petsc_check(MatCreate(PETSC_COMM_SELF, &made), "MatCreate");
    entries.reset(made);
    petsc_check(MatSetSizes(entries, n, n, n, n), "MatSetSizes");
    petsc_check(MatSetType(entries, MATSEQSBAIJ), "MatSetType");
    petsc_check(MatSeqSBAIJSetPreallocationCSR(entries, 6, start.data(), columns.data(), nullptr),
                "MatSeqSBAIJSetPreallocationCSR");
    use_our_vectors(entries);
  }

  void refresh() {
    if (!stale) return;
    stale = false;
    own.positive = !own.preconditioner || own.preconditioner->set_up(a);
    if (entries) copy_entries();
    // Without it PETSc keeps the old preconditioner silently.
    petsc_check(entries_changed(entries ? entries : product), "PetscObjectStateIncrease");
  }

  void use(Deflation* deflation) {
    if (deflation && !shell) {
      projected.reduced.reset(create_vector(a.unknowns()));
      PC made = nullptr;
      petsc_check(PCCreate(PETSC_COMM_SELF, &made), "PCCreate");
      shell.reset(made);
      petsc_check(PCSetOperators(shell, product, product), "PCSetOperators");
      set_shell(shell, apply_projected, &projected);
    }
    if (shell && (deflation != nullptr) != (projected.deflation != nullptr))
      petsc_check(KSPSetPC(ksp, deflation ? shell : plain), "KSPSetPC");
    projected.inner = plain;
    projected.deflation = deflation;
  }

  /// Throws what an application of the preconditioner threw.
  void check_applications() {
    if (own.failure) std::rethrow_exception(std::exchange(own.failure, nullptr));
  }

  void limit_iterations(int most_iterations) {
    if (std::exchange(most, most_iterations) == most_iterations) return;
    petsc_check(KSPSetTolerances(ksp, 0, 0, PETSC_DEFAULT, most), "KSPSetTolerances");
  }

  /// Sets `scratch` to z = P^-1 r and returns r.z.
  double precondition(const VectorX& r) {
    copy(r, b);
    use(nullptr);
    petsc_check(KSPSetUp(ksp), "KSPSetUp");
    petsc_check(PCApply(plain, b, scratch), "PCApply");
    check_applications();
    PetscScalar product_with_z = 0;
    petsc_check(VecDot(b, scratch, &product_with_z), "VecDot");
    return product_with_z;
  }

  void copy_entries() {
    // PETSc's blocks of the upper triangle: column-major, unpadded, in block-row order.
    PetscScalar* out = nullptr;
    petsc_check(MatSeqSBAIJGetArray(entries, &out), "MatSeqSBAIJGetArray");
    PetscScalar* next = out;
    for (int row = 0; row < a.block_rows(); ++row)
      for (int k = a.diagonal(row); k < a.row_end(row); ++k)
        for (const Lane8& column : a.blocks[at(k)].column) store6(std::exchange(next, next + 6), column);
    petsc_check(MatSeqSBAIJRestoreArray(entries, &out), "MatSeqSBAIJRestoreArray");
  }

  bool is_of_the_user() const {
    return settings.preconditioner == Preconditioner::plugin || settings.preconditioner == Preconditioner::python;
  }
};

ConjugateGradient::ConjugateGradient(const BlockMatrix& a, const CgSettings& settings)
    : CgSolver(iteration_limit(settings, a.unknowns()), a.unknowns()),
      impl_(std::make_unique<Impl>(a, nullptr, settings)) {}
ConjugateGradient::ConjugateGradient(const LinearSystem& system, const CgSettings& settings)
    : CgSolver(iteration_limit(settings, system.matrix().unknowns()), system.matrix().unknowns()),
      impl_(std::make_unique<Impl>(system.matrix(), system.product(), settings)) {}
ConjugateGradient::~ConjugateGradient() = default;
ConjugateGradient::ConjugateGradient(ConjugateGradient&&) noexcept = default;

void ConjugateGradient::matrix_changed() { impl_->stale = true; }

void ConjugateGradient::multiply(const VectorX& x, VectorX& y) { impl_->op.multiply(x.data(), y.data()); }

/// The natural norm is known after an application of the preconditioner only.
bool ConjugateGradient::meets(double norm, double tolerance, double reference) const {
  return impl_->settings.norm == Norm::true_residual && CgSolver::meets(norm, tolerance, reference);
}

CgReport ConjugateGradient::iterate(const Residual& first, VectorX& x, double tolerance, double reference, int most,
                                    Deflation* deflation) {
  Impl& s = *impl_;
  s.refresh();
  if (!s.own.positive) {
    if (keeps_history_) history_.push_back(first.norm);
    return {SolveOutcome::indefinite, 0, 0};
  }
  s.use(deflation);
  s.limit_iterations(most);
  s.target = {tolerance, reference, work_of_iteration(s.a)};
  s.op.products = 0;
  copy(first.entries, s.b);
  petsc_check(KSPSolve(s.ksp, s.b, s.x), "KSPSolve");
  s.check_applications();
  check_interrupted(0);
  add(s.x, x);
  if (keeps_history_) {
    const PetscReal* norms = nullptr;
    PetscInt count = 0;
    petsc_check(KSPGetResidualHistory(s.ksp, &norms, &count), "KSPGetResidualHistory");
    history_.insert(history_.end(), norms, norms + count);
  }
  CgReport report = report_of(s.ksp);
  report.products = s.op.products;
  return report;
}

/// A preconditioner P that is zero on a part of r leaves that part, and its natural norm does not see it. In the 2-norm
/// only the limit of iterations ends such a solve. Otherwise ||r|| / ||b|| is at most (condition of P)^1/2 times the
/// ratio in the natural norm.
bool ConjugateGradient::shows_indefinite(const VectorX& b, const VectorX& x, double tolerance, SolveOutcome outcome) {
  Impl& s = *impl_;
  if (!s.is_of_the_user()) return false;
  const bool converged = outcome == SolveOutcome::converged && s.settings.norm == Norm::natural;
  if (!converged && outcome != SolveOutcome::iteration_limit) return false;
  constexpr double most_condition = 1e12, rounding = 1e-8;
  multiply(x, residual_);
  residual_ = b - residual_;
  if (converged && residual_.norm() > std::sqrt(most_condition) * tolerance * b.norm()) return true;
  s.precondition(residual_);
  const double smallest = rounding * residual_.lpNorm<Eigen::Infinity>();
  const double* z = vector_data(s.scratch);
  for (Eigen::Index i = 0; i < residual_.size(); ++i)
    if (std::abs(residual_[i]) > smallest && z[i] == 0) return true;
  return false;
}

double ConjugateGradient::norm_of(const VectorX& b) {
  Impl& s = *impl_;
  if (s.settings.norm == Norm::true_residual) return b.norm();
  s.refresh();
  if (!s.own.positive) return std::numeric_limits<double>::quiet_NaN();
  const double square = s.precondition(b);
  if (s.is_of_the_user()) s.own.positive = square > 0 || b.isZero(0);
  return s.own.positive ? std::sqrt(square) : std::numeric_limits<double>::quiet_NaN();
}

void ConjugateGradient::keep_history(bool on) {
  CgSolver::keep_history(on);
  Impl& s = *impl_;
  s.history_buffer.resize(on ? at(max_iterations_) + 1 : 0);
  petsc_check(KSPSetResidualHistory(s.ksp, on ? s.history_buffer.data() : nullptr,
                                    static_cast<PetscInt>(s.history_buffer.size()), PETSC_TRUE),
              "KSPSetResidualHistory");
}

}  // namespace rodsweep
