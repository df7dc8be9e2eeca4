// PETSc vectors with vector kernels built for this processor.
//
// KSPCG spends much of a small system's iteration in dot products and updates, which Debian's PETSc leaves to a
// reference BLAS compiled without wide vectors, on memory that is not aligned to them. These vectors have kernels over
// whole Lane8s in their table of operations, on memory that starts with a cache line and is padded with zeros to the
// end of one, so that KSP itself runs on them unchanged. Whatever PETSc makes for itself must be of the same kind:
// duplicates are, and so are the vectors of a matrix after use_our_vectors(). A kernel that is given another vector
// returns PETSC_ERR_ARG_WRONG.
#pragma once

#include <petscmat.h>

#include "solver/numbers/types.hpp"

namespace rodsweep {

Vec create_vector(PetscInt size);

/// Lets PETSc make vectors that fit `m`, which has as many rows as columns, of our kind.
void use_our_vectors(Mat m);

/// The entries, without PETSc's access bookkeeping. Who writes says so with entries_changed().
double* vector_data(Vec v);
PetscErrorCode entries_changed(Vec v);

void copy(const VectorX& from, Vec to);
void copy(Vec from, VectorX& to);
void add(Vec from, VectorX& to);

}  // namespace rodsweep
