#include "solver/cg/conjugate_gradient.hpp"

#include <petscksp.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "solver/cg/ksp_outcome.hpp"
#include "solver/cg/petsc_check.hpp"
#include "solver/cg/petsc_operator.hpp"
#include "solver/cg/petsc_vector.hpp"
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
    case Preconditioner::point_block_jacobi: return PCPBJACOBI;
    case Preconditioner::icc: return PCICC;
    case Preconditioner::block_icc:
    case Preconditioner::cholesky:
    case Preconditioner::lagged_cholesky:
    case Preconditioner::learned:
    case Preconditioner::plugin:
    case Preconditioner::python: return PCSHELL;
    case Preconditioner::condensed: break;  // see make_cg()
  }
  return PCNONE;
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
  Vec reduced = nullptr;
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
  Mat product = nullptr;
  Mat entries = nullptr;  ///< copy of the blocks for PETSc's preconditioners that need them; else null
  KSP ksp = nullptr;
  Shell own;
  PC plain = nullptr, shell = nullptr;  ///< the preconditioner; with projections, once used
  Projected projected;
  Vec b = nullptr, x = nullptr, scratch = nullptr;
  VectorX residual;
  Target target;
  bool stale = true;  ///< the preconditioner belongs to older entries
  std::vector<PetscReal> history_buffer;
  std::vector<double> history;

  Impl(const BlockMatrix& matrix, const ConstraintProduct* without_blocks, const CgSettings& s);
  ~Impl() { destroy(); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void create();
  void destroy();
  void create_entries(bool symmetric);
  void copy_entries();
  void refresh();
  void use(Deflation* deflation);
  void check_applications();
  const VectorX& first_residual(const VectorX& rhs, const VectorX& guess, const CgStart& start);
  CgReport without_iterations(SolveOutcome outcome, double norm);
};

ConjugateGradient::Impl::Impl(const BlockMatrix& matrix, const ConstraintProduct* without_blocks, const CgSettings& s)
    : a(matrix), op{matrix, without_blocks}, settings(s) {
  settings.max_iterations = iteration_limit(settings, a.unknowns());
  try {
    create();
  } catch (...) {  // if out of memory, later tasks need this memory
    destroy();
    throw;
  }
}

void ConjugateGradient::Impl::create() {
  const PetscInt n = a.unknowns();
  product = create_operator(op);
  b = create_vector(n);
  x = create_vector(n);
  scratch = create_vector(n);
  residual.setZero(n);

  if (settings.preconditioner == Preconditioner::point_block_jacobi) create_entries(false);
  if (settings.preconditioner == Preconditioner::icc) create_entries(true);
  own.preconditioner = settings.make_given ? settings.make_given()
                                           : block_preconditioner(settings.preconditioner, a, settings.fill_levels);

  petsc_check(KSPCreate(PETSC_COMM_SELF, &ksp), "KSPCreate");
  petsc_check(KSPSetType(ksp, KSPCG), "KSPSetType");
  petsc_check(KSPSetNormType(ksp, settings.norm == Norm::natural ? KSP_NORM_NATURAL : KSP_NORM_UNPRECONDITIONED),
              "KSPSetNormType");
  petsc_check(KSPGetPC(ksp, &plain), "KSPGetPC");
  petsc_check(PetscObjectReference(reinterpret_cast<PetscObject>(plain)), "PetscObjectReference");
  petsc_check(PCSetType(plain, pc_type(settings.preconditioner)), "PCSetType");
  if (own.preconditioner) {
    petsc_check(PCShellSetContext(plain, &own), "PCShellSetContext");
    petsc_check(PCShellSetApply(plain, apply_shell), "PCShellSetApply");
  }
  petsc_check(KSPSetOperators(ksp, product, entries ? entries : product), "KSPSetOperators");
  petsc_check(KSPSetTolerances(ksp, 0, 0, PETSC_DEFAULT, settings.max_iterations), "KSPSetTolerances");
  petsc_check(KSPSetConvergenceTest(ksp, test_convergence, &target, nullptr), "KSPSetConvergenceTest");
}

void ConjugateGradient::Impl::destroy() {
  // A destructor cannot report errors; PETSc prints them.
  KSPDestroy(&ksp);
  PCDestroy(&shell);
  PCDestroy(&plain);
  MatDestroy(&entries);
  MatDestroy(&product);
  VecDestroy(&projected.reduced);
  VecDestroy(&scratch);
  VecDestroy(&x);
  VecDestroy(&b);
}

void ConjugateGradient::Impl::create_entries(bool symmetric) {
  std::vector<PetscInt> start{0}, columns;
  for (int row = 0; row < a.block_rows(); ++row) {
    for (int k = a.row_begin(row); k < a.row_end(row); ++k)
      if (!symmetric || a.column(k) >= row) columns.push_back(a.column(k));
    start.push_back(static_cast<PetscInt>(columns.size()));
  }
  const PetscInt n = a.unknowns();
  petsc_check(MatCreate(PETSC_COMM_SELF, &entries), "MatCreate");
  petsc_check(MatSetSizes(entries, n, n, n, n), "MatSetSizes");
  petsc_check(MatSetType(entries, symmetric ? MATSEQSBAIJ : MATSEQBAIJ), "MatSetType");
  if (symmetric)
    petsc_check(MatSeqSBAIJSetPreallocationCSR(entries, 6, start.data(), columns.data(), nullptr),
                "MatSeqSBAIJSetPreallocationCSR");
  else
    petsc_check(MatSeqBAIJSetPreallocationCSR(entries, 6, start.data(), columns.data(), nullptr),
                "MatSeqBAIJSetPreallocationCSR");
  use_our_vectors(entries);
}

void ConjugateGradient::Impl::refresh() {
  if (!stale) return;
  stale = false;
  if (own.preconditioner) own.positive = own.preconditioner->set_up(a);
  if (entries) copy_entries();
  // Tells PETSc that the entries are new; without it the old preconditioner is kept silently.
  Mat changed = entries ? entries : product;
  petsc_check(MatAssemblyBegin(changed, MAT_FINAL_ASSEMBLY), "MatAssemblyBegin");
  petsc_check(MatAssemblyEnd(changed, MAT_FINAL_ASSEMBLY), "MatAssemblyEnd");
}

void ConjugateGradient::Impl::use(Deflation* deflation) {
  if (deflation && !shell) {
    projected.reduced = create_vector(a.unknowns());
    petsc_check(PCCreate(PETSC_COMM_SELF, &shell), "PCCreate");
    petsc_check(PCSetType(shell, PCSHELL), "PCSetType");
    petsc_check(PCSetOperators(shell, product, product), "PCSetOperators");
    petsc_check(PCShellSetContext(shell, &projected), "PCShellSetContext");
    petsc_check(PCShellSetApply(shell, apply_projected), "PCShellSetApply");
  }
  if (shell && (deflation != nullptr) != (projected.deflation != nullptr))
    petsc_check(KSPSetPC(ksp, deflation ? shell : plain), "KSPSetPC");
  projected.inner = plain;
  projected.deflation = deflation;
}

/// Throws what an application of the preconditioner threw.
void ConjugateGradient::Impl::check_applications() {
  if (own.failure) std::rethrow_exception(std::exchange(own.failure, nullptr));
}

/// b - A x, with a product if it is not known.
const VectorX& ConjugateGradient::Impl::first_residual(const VectorX& rhs, const VectorX& guess, const CgStart& start) {
  if (!start.nonzero) return rhs;
  if (start.residual) return *start.residual;
  copy(guess, x);
  op.multiply(vector_data(x), vector_data(scratch));
  ++op.products;
  residual = rhs - Eigen::Map<const VectorX>(vector_data(scratch), rhs.size());
  return residual;
}

CgReport ConjugateGradient::Impl::without_iterations(SolveOutcome outcome, double norm) {
  history.clear();
  if (!history_buffer.empty() && std::isfinite(norm)) history.push_back(norm);
  return {outcome, 0, op.products};
}

void ConjugateGradient::Impl::copy_entries() {
  // PETSc's blocks: column-major, unpadded, in block-row order; the symmetric format holds the upper blocks.
  const bool symmetric = settings.preconditioner == Preconditioner::icc;
  PetscScalar* out = nullptr;
  petsc_check(symmetric ? MatSeqSBAIJGetArray(entries, &out) : MatSeqBAIJGetArray(entries, &out), "MatSeqBAIJGetArray");
  PetscScalar* at = out;
  for (int row = 0; row < a.block_rows(); ++row)
    for (int k = a.row_begin(row); k < a.row_end(row); ++k) {
      if (symmetric && a.column(k) < row) continue;
      for (const Lane8& column : a.blocks[static_cast<std::size_t>(k)].column)
        store6(std::exchange(at, at + 6), column);
    }
  petsc_check(symmetric ? MatSeqSBAIJRestoreArray(entries, &out) : MatSeqBAIJRestoreArray(entries, &out),
              "MatSeqBAIJRestoreArray");
}

ConjugateGradient::ConjugateGradient(const BlockMatrix& a, const CgSettings& settings)
    : impl_(std::make_unique<Impl>(a, nullptr, settings)) {}
ConjugateGradient::ConjugateGradient(const LinearSystem& system, const CgSettings& settings)
    : impl_(std::make_unique<Impl>(system.matrix(), system.product(), settings)) {}
ConjugateGradient::~ConjugateGradient() = default;
ConjugateGradient::ConjugateGradient(ConjugateGradient&&) noexcept = default;
ConjugateGradient& ConjugateGradient::operator=(ConjugateGradient&&) noexcept = default;

void ConjugateGradient::matrix_changed() { impl_->stale = true; }

CgReport ConjugateGradient::solve(const VectorX& b, VectorX& x, const CgStart& start, double tolerance,
                                  double reference, Deflation* deflation) {
  Impl& s = *impl_;
  s.op.products = 0;
  const VectorX& first = s.first_residual(b, x, start);
  const double norm = first.norm();
  if (!start.nonzero) x.setZero(b.size());
  if (!std::isfinite(norm)) return s.without_iterations(SolveOutcome::not_a_number, norm);
  // A guess within the tolerance needs no preconditioner.
  if (s.settings.norm == Norm::true_residual && norm <= tolerance * reference)
    return s.without_iterations(SolveOutcome::converged, norm);
  s.refresh();
  if (!s.own.positive) return s.without_iterations(SolveOutcome::indefinite, norm);
  s.use(deflation);
  s.target = {tolerance, reference, work_of_iteration(s.a)};
  copy(first, s.b);
  petsc_check(KSPSolve(s.ksp, s.b, s.x), "KSPSolve");
  s.check_applications();
  check_interrupted(0);
  add(s.x, x);

  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  PetscInt iterations = 0;
  petsc_check(KSPGetConvergedReason(s.ksp, &reason), "KSPGetConvergedReason");
  petsc_check(KSPGetIterationNumber(s.ksp, &iterations), "KSPGetIterationNumber");
  if (!s.history_buffer.empty()) {
    const PetscReal* norms = nullptr;
    PetscInt count = 0;
    petsc_check(KSPGetResidualHistory(s.ksp, &norms, &count), "KSPGetResidualHistory");
    s.history.assign(norms, norms + count);
  }
  return {outcome_of(reason), static_cast<int>(iterations), s.op.products};
}

double ConjugateGradient::norm_of(const VectorX& b) {
  Impl& s = *impl_;
  if (s.settings.norm == Norm::true_residual) return b.norm();
  s.refresh();
  if (!s.own.positive) return std::numeric_limits<double>::quiet_NaN();
  copy(b, s.b);
  PetscScalar square = 0;
  s.use(nullptr);
  petsc_check(KSPSetUp(s.ksp), "KSPSetUp");
  petsc_check(PCApply(s.plain, s.b, s.scratch), "PCApply");
  s.check_applications();
  petsc_check(VecDot(s.b, s.scratch, &square), "VecDot");
  return std::sqrt(square);
}

void ConjugateGradient::keep_history(bool on) {
  Impl& s = *impl_;
  s.history.clear();
  s.history.reserve(on ? static_cast<std::size_t>(s.settings.max_iterations) + 1 : 0);
  s.history_buffer.resize(on ? static_cast<std::size_t>(s.settings.max_iterations) + 1 : 0);
  petsc_check(KSPSetResidualHistory(s.ksp, on ? s.history_buffer.data() : nullptr,
                                    static_cast<PetscInt>(s.history_buffer.size()), PETSC_TRUE),
              "KSPSetResidualHistory");
}

const std::vector<double>& ConjugateGradient::history() const { return impl_->history; }

}  // namespace rodsweep
