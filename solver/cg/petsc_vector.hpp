// PETSc vectors with vector kernels built for this processor.
//
// On small systems KSPCG spends much of an iteration in dot products and updates. Debian's PETSc uses a reference BLAS
// for them, compiled without wide vectors, on unaligned memory. These vectors replace the operations by kernels over
// whole Lane8s, on memory that is aligned to cache lines and padded with zeros; KSP itself is unchanged. All vectors of
// a solve must be of this kind: duplicates are, and so are the vectors of a matrix after use_our_vectors(). A kernel
// returns PETSC_ERR_ARG_WRONG for any other vector.
#pragma once

#include <petscmat.h>

#include "solver/numbers/types.hpp"

namespace rodsweep {

Vec create_vector(PetscInt size);

/// Makes PETSc create vectors of this kind for `m`, a square matrix.
void use_our_vectors(Mat m);

/// The entries, without PETSc's access bookkeeping. Call entries_changed() after writing.
double* vector_data(Vec v);
PetscErrorCode entries_changed(Vec v);

void copy(const VectorX& from, Vec to);
void add(Vec from, VectorX& to);

}  // namespace rodsweep
