#include "solver/petsc_vector.hpp"

#include <Eigen/Core>

#include "solver/petsc_check.hpp"

// The table of vector operations is in PETSc's private header, which Debian installs with the public ones.
#include <petsc/private/vecimpl.h>

namespace rodsweep {
namespace {

using Entries = Eigen::Map<Eigen::VectorXd>;

Entries entries(Vec v) { return Entries(vector_data(v), v->map->n); }

PetscErrorCode dot(Vec x, Vec y, PetscScalar* out) {
  *out = entries(x).dot(entries(y));
  return 0;
}

PetscErrorCode axpy(Vec y, PetscScalar alpha, Vec x) {
  entries(y) += alpha * entries(x);
  return 0;
}

PetscErrorCode aypx(Vec y, PetscScalar beta, Vec x) {
  entries(y) = entries(x) + beta * entries(y);
  return 0;
}

PetscErrorCode pointwise_multiply(Vec w, Vec x, Vec y) {
  entries(w) = entries(x).cwiseProduct(entries(y));
  return 0;
}

PetscErrorCode copy(Vec x, Vec y) {
  if (x != y) entries(y) = entries(x);
  return 0;
}

PetscErrorCode norm(Vec x, NormType type, PetscReal* out);
PetscErrorCode duplicate(Vec v, Vec* out);

/// PETSc's own operations of a sequential vector, for what we don't replace.
struct Original {
  PetscErrorCode (*norm)(Vec, NormType, PetscReal*) = nullptr;
  PetscErrorCode (*duplicate)(Vec, Vec*) = nullptr;
} original;

void install(Vec v) {
  v->ops->dot = v->ops->tdot = v->ops->dot_local = v->ops->tdot_local = dot;
  v->ops->norm = v->ops->norm_local = norm;
  v->ops->axpy = axpy;
  v->ops->aypx = aypx;
  v->ops->pointwisemult = pointwise_multiply;
  v->ops->copy = copy;
  v->ops->duplicate = duplicate;
}

PetscErrorCode norm(Vec x, NormType type, PetscReal* out) {
  if (type != NORM_2) return original.norm(x, type, out);
  *out = entries(x).norm();
  return 0;
}

PetscErrorCode duplicate(Vec v, Vec* out) {
  const PetscErrorCode code = original.duplicate(v, out);
  if (code == 0) install(*out);
  return code;
}

}  // namespace

Vec create_vector(PetscInt size) {
  Vec v = nullptr;
  petsc_check(VecCreateSeq(PETSC_COMM_SELF, size, &v), "VecCreateSeq");
  if (!original.norm) original = {v->ops->norm, v->ops->duplicate};
  install(v);
  return v;
}

double* vector_data(Vec v) { return *static_cast<double**>(v->data); }

VectorView::VectorView(Vec v, double* data) : v_(v) { petsc_check(VecPlaceArray(v, data), "VecPlaceArray"); }
VectorView::~VectorView() { VecResetArray(v_); }

}  // namespace rodsweep
