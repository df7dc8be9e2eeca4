// PETSc vectors and a PETSc matrix with vector kernels built for this processor, and the check of PETSc calls. Included
// by sources only: the solver's headers do not include PETSc.
//
// On small systems KSPCG spends much of an iteration in dot products and updates. Debian's PETSc uses a reference BLAS
// for them, compiled without wide vectors, on unaligned memory. These vectors replace the operations by kernels over
// whole Lane8s, on memory that is aligned to cache lines and padded with zeros; KSP itself is unchanged. All vectors of
// a solve must be of this kind: duplicates are, and so are the vectors of a matrix after use_our_vectors(). A kernel
// returns PETSC_ERR_ARG_WRONG for any other vector.
//
// The matrix is a BlockMatrix of which PETSc sees only a product, with or without the blocks, and a diagonal. It is its
// own matrix class, not a MATSHELL. A MATSHELL looks up its context by name and checks for scalings and shifts in every
// product. On short rods that costs as much as the product itself.
//
// All that rodsweep uses of PETSc's private headers is in the source of this header. Tried with PETSc 3.18, 3.22, 3.25.
#pragma once

#include <petscmat.h>

#include <cstdint>
#include <new>
#include <string>

#include "solver/cg/petsc_session.hpp"
#include "solver/linear/block_matrix.hpp"
#include "solver/linear/constraint_product.hpp"

namespace rodsweep {

/// Throws, so callbacks from PETSc must not use it: an exception must not cross C frames, and callbacks are noexcept.
inline void petsc_check(PetscErrorCode code, const char* call) {
  if (code == 0) return;
  if (code == PETSC_ERR_MEM) throw std::bad_alloc();
  const char* text = nullptr;
  PetscErrorMessage(code, &text, nullptr);
  throw PetscError(std::string(call) + " failed with PETSc error " + std::to_string(code) +
                   (text ? std::string(": ") + text : ""));
}

Vec create_vector(PetscInt size);

/// Makes PETSc create vectors of this kind for `m`, a square matrix.
void use_our_vectors(Mat m);

/// The entries, without PETSc's access bookkeeping. Call entries_changed() after writing.
double* vector_data(Vec v);
PetscErrorCode entries_changed(Vec v);
PetscErrorCode entries_changed(Mat m);

void copy(const VectorX& from, Vec to);
void add(Vec from, VectorX& to);

/// The data of the matrix; must outlive it.
struct BlockOperator {
  const BlockMatrix& a;
  const ConstraintProduct* product = nullptr;  ///< of the same matrix; null: use its blocks
  int products = 0;                            ///< made so far

  void multiply(const double* x, double* y) const { product ? product->multiply(x, y) : a.multiply(x, y); }
};

/// Approximate time of a CG iteration in nanoseconds, for is_interrupted().
inline std::int64_t work_of_iteration(const BlockMatrix& a) { return 10 * static_cast<std::int64_t>(a.blocks.size()); }

/// A matrix with the product of `op`. Call entries_changed() when they change.
Mat create_operator(BlockOperator& op);

}  // namespace rodsweep
