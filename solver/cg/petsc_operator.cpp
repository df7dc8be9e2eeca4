#include "solver/cg/petsc_operator.hpp"

#include "solver/cg/petsc_check.hpp"
#include "solver/cg/petsc_vector.hpp"

// A matrix class is defined through PETSc's private header, which Debian installs with the public ones.
#include <petsc/private/matimpl.h>

namespace rodsweep {
namespace {

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

PetscErrorCode create(Mat m) noexcept {
  m->ops->mult = multiply;
  m->ops->getdiagonal = extract_diagonal;
  m->assembled = m->preallocated = PETSC_TRUE;
  return PetscObjectChangeTypeName(reinterpret_cast<PetscObject>(m), class_name);
}

}  // namespace

Mat create_operator(BlockOperator& op) {
  const PetscInt n = op.a.unknowns();
  Mat m = nullptr;
  petsc_check(MatRegister(class_name, create), "MatRegister");
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
