#include "solver/cg/petsc_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

// The table of vector operations and the matrix class need PETSc's private headers, which Debian installs with the public
// ones.
#include <petsc/private/matimpl.h>
#include <petsc/private/vecimpl.h>

namespace rodsweep {
namespace {

PetscInt lane_count(Vec v) { return (v->map->n + 7) / 8; }

Lane8* lanes(Vec v) { return reinterpret_cast<Lane8*>(vector_data(v)); }

PetscErrorCode dot(Vec x, Vec y, PetscScalar* out) noexcept;

template <class... Vecs>
bool ours(Vecs... vectors) {
  return (... && (vectors->ops->dot == dot && reinterpret_cast<std::uintptr_t>(lanes(vectors)) % alignof(Lane8) == 0));
}

double product(Vec x, Vec y) {
  const Lane8 *a = lanes(x), *b = lanes(y);
  const PetscInt count = lane_count(x);
  Lane8 sums[4]{};  // enough to hide the latency of an addition
  PetscInt i = 0;
  for (; i + 4 <= count; i += 4)
#pragma GCC unroll 4
    for (int j = 0; j < 4; ++j) sums[j] += a[i + j] * b[i + j];
  for (; i < count; ++i) sums[0] += a[i] * b[i];
  return sum((sums[0] + sums[1]) + (sums[2] + sums[3]));
}

PetscErrorCode dot(Vec x, Vec y, PetscScalar* out) noexcept {
  if (!ours(x, y)) return PETSC_ERR_ARG_WRONG;
  *out = product(x, y);
  return 0;
}

PetscErrorCode (*other_norm)(Vec, NormType, PetscReal*) = nullptr;  ///< PETSc's own

PetscErrorCode norm(Vec x, NormType type, PetscReal* out) noexcept {
  if (type != NORM_2) return other_norm(x, type, out);
  *out = std::sqrt(product(x, x));
  return 0;
}

PetscErrorCode axpy(Vec y, PetscScalar alpha, Vec x) noexcept {
  if (!ours(x, y)) return PETSC_ERR_ARG_WRONG;
  Lane8* const to = lanes(y);
  const Lane8* const from = lanes(x);
  for (PetscInt i = 0, count = lane_count(y); i < count; ++i) to[i] += alpha * from[i];
  return 0;
}

PetscErrorCode aypx(Vec y, PetscScalar beta, Vec x) noexcept {
  if (!ours(x, y)) return PETSC_ERR_ARG_WRONG;
  Lane8* const to = lanes(y);
  const Lane8* const from = lanes(x);
  for (PetscInt i = 0, count = lane_count(y); i < count; ++i) to[i] = from[i] + beta * to[i];
  return 0;
}

PetscErrorCode pointwise_multiply(Vec w, Vec x, Vec y) noexcept {
  if (!ours(w, x, y)) return PETSC_ERR_ARG_WRONG;
  Lane8* const to = lanes(w);
  const Lane8 *const a = lanes(x), *const b = lanes(y);
  for (PetscInt i = 0, count = lane_count(w); i < count; ++i) to[i] = a[i] * b[i];
  return 0;
}

PetscErrorCode copy_entries(Vec x, Vec y) noexcept {
  std::copy_n(vector_data(x), x->map->n, vector_data(y));
  return 0;
}

PetscErrorCode (*other_destroy)(Vec) = nullptr;  ///< PETSc's own

PetscErrorCode destroy(Vec v) noexcept {
  double* const memory = vector_data(v);
  const PetscErrorCode code = other_destroy(v);
  std::free(memory);
  return code;
}

PetscErrorCode create(PetscInt size, Vec* out) noexcept;

PetscErrorCode duplicate(Vec v, Vec* out) noexcept { return create(v->map->n, out); }

/// PETSc 3.22 and newer would put all of them in one block of memory, where they are not aligned.
PetscErrorCode duplicate_vectors(Vec v, PetscInt count, Vec* out[]) noexcept {
  if (const PetscErrorCode code = PetscMalloc1(count, out)) return code;
  for (PetscInt i = 0; i < count; ++i)
    if (const PetscErrorCode code = duplicate(v, *out + i)) return code;
  return 0;
}

PetscErrorCode create_vectors(Mat m, Vec* right, Vec* left) noexcept {
  PetscInt rows = 0;
  PetscErrorCode code = MatGetLocalSize(m, &rows, nullptr);
  if (right && code == 0) code = create(rows, right);
  if (left && code == 0) code = create(rows, left);
  return code;
}

PetscErrorCode create(PetscInt size, Vec* out) noexcept {
  const std::size_t count = at(size) / 8 + 1;
  Lane8* const memory = static_cast<Lane8*>(std::aligned_alloc(alignof(Lane8), count * sizeof(Lane8)));
  if (!memory) return PETSC_ERR_MEM;
  std::fill_n(memory, count, Lane8{});
  if (const PetscErrorCode code =
          VecCreateSeqWithArray(PETSC_COMM_SELF, 1, size, reinterpret_cast<double*>(memory), out)) {
    std::free(memory);
    return code;
  }

  _VecOps& ops = *(*out)->ops;
  other_norm = ops.norm;
  other_destroy = ops.destroy;
  ops.destroy = destroy;
  ops.dot = ops.tdot = ops.dot_local = ops.tdot_local = dot;
  ops.norm = ops.norm_local = norm;
  ops.axpy = axpy;
  ops.aypx = aypx;
  ops.pointwisemult = pointwise_multiply;
  ops.copy = copy_entries;
  ops.duplicate = duplicate;
  ops.duplicatevecs = duplicate_vectors;
  return 0;
}

constexpr char class_name[] = "rodsweep_blocks";

PetscErrorCode multiply(Mat m, Vec x, Vec y) noexcept {
  BlockOperator& op = *static_cast<BlockOperator*>(m->data);
  op.multiply(vector_data(x), vector_data(y));
  ++op.products;
  return entries_changed(y);
}

PetscErrorCode extract_diagonal(Mat m, Vec diagonal) noexcept {
  const BlockMatrix& a = static_cast<BlockOperator*>(m->data)->a;
  double* out = vector_data(diagonal);
  for (int row = 0; row < a.block_rows(); ++row)
    for (int i = 0; i < 6; ++i) out[6 * row + i] = a.diagonal_entry(row, i);
  return entries_changed(diagonal);
}

PetscErrorCode create_class(Mat m) noexcept {
  m->ops->mult = multiply;
  m->ops->getdiagonal = extract_diagonal;
  m->assembled = m->preallocated = PETSC_TRUE;
  return PetscObjectChangeTypeName(reinterpret_cast<PetscObject>(m), class_name);
}

}  // namespace

Vec create_vector(PetscInt size) {
  Vec v = nullptr;
  petsc_check(create(size, &v), "VecCreateSeqWithArray");
  return v;
}

void use_our_vectors(Mat m) {
  petsc_check(MatSetOperation(m, MATOP_CREATE_VECS, reinterpret_cast<void (*)()>(create_vectors)), "MatSetOperation");
}

double* vector_data(Vec v) { return *static_cast<double**>(v->data); }

PetscErrorCode entries_changed(Vec v) { return PetscObjectStateIncrease(reinterpret_cast<PetscObject>(v)); }
PetscErrorCode entries_changed(Mat m) { return PetscObjectStateIncrease(reinterpret_cast<PetscObject>(m)); }

void copy(const VectorX& from, Vec to) {
  std::copy_n(from.data(), from.size(), vector_data(to));
  petsc_check(entries_changed(to), "PetscObjectStateIncrease");
}

void add(Vec from, VectorX& to) { to += Eigen::Map<const VectorX>(vector_data(from), to.size()); }

Mat create_operator(BlockOperator& op) {
  const PetscInt n = op.a.unknowns();
  Mat m = nullptr;
  petsc_check(MatRegister(class_name, create_class), "MatRegister");
  petsc_check(MatCreate(PETSC_COMM_SELF, &m), "MatCreate");
  petsc_check(MatSetSizes(m, n, n, n, n), "MatSetSizes");
  petsc_check(MatSetType(m, class_name), "MatSetType");
  petsc_check(MatSetUp(m), "MatSetUp");
  petsc_check(MatSetOption(m, MAT_SYMMETRIC, PETSC_TRUE), "MatSetOption");
  use_our_vectors(m);
  m->data = &op;
  return m;
}

}  // namespace rodsweep
