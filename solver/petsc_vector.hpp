// PETSc vectors over our own memory, with vector kernels built for this processor.
//
// KSPCG spends much of a small system's iteration in dot products and updates, which Debian's PETSc leaves to a
// reference BLAS compiled without wide vectors. create_vector() puts Eigen's kernels into the vector's table of
// operations (and into every duplicate's), so that KSP itself runs on them unchanged.
#pragma once

#include <petscvec.h>

namespace rodsweep {

Vec create_vector(PetscInt size);

/// The entries, without PETSc's access bookkeeping.
double* vector_data(Vec v);

/// Lets `v` use `data` for its lifetime.
class VectorView {
 public:
  VectorView(Vec v, double* data);
  ~VectorView();
  VectorView(const VectorView&) = delete;
  VectorView& operator=(const VectorView&) = delete;

 private:
  Vec v_;
};

}  // namespace rodsweep
