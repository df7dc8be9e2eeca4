// A BlockMatrix as a PETSc matrix that has only a product, with or without the blocks, and a diagonal.
//
// It is its own matrix class, not a MATSHELL. A MATSHELL looks up its context by name and checks for scalings and
// shifts in every product. On short rods that costs as much as the product itself.
#pragma once

#include <petscmat.h>

#include <cstdint>

#include "solver/linear/block_matrix.hpp"
#include "solver/linear/constraint_product.hpp"

namespace rodsweep {

/// The data of the matrix; must outlive it.
struct BlockOperator {
  const BlockMatrix& a;
  const ConstraintProduct* product = nullptr;  ///< of the same matrix; null: use its blocks
  int products = 0;                            ///< made so far

  void multiply(const double* x, double* y) const { product ? product->multiply(x, y) : a.multiply(x, y); }
};

/// Approximate time of a CG iteration in nanoseconds, for is_interrupted().
inline std::int64_t work_of_iteration(const BlockMatrix& a) { return 10 * static_cast<std::int64_t>(a.blocks.size()); }

/// A matrix with the product of `op`. Call MatAssemblyBegin() and MatAssemblyEnd() when entries change.
Mat create_operator(BlockOperator& op);

}  // namespace rodsweep
