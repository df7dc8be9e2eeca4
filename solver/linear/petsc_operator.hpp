// A BlockMatrix as a PETSc matrix that is nothing but its product, perhaps made without the blocks, and its diagonal.
//
// It is a matrix class of its own rather than a MATSHELL, which looks up its context by name and asks for scalings and
// shifts in every product: as much work as the product itself on short rods.
#pragma once

#include <petscmat.h>

#include <cstdint>

#include "solver/linear/block_matrix.hpp"
#include "solver/linear/constraint_product.hpp"

namespace rodsweep {

/// What the matrix stands for; outlives it.
struct BlockOperator {
  const BlockMatrix& a;
  const ConstraintProduct* product = nullptr;  ///< with the same matrix; null: by its blocks
  int products = 0;                            ///< made so far

  void multiply(const double* x, double* y) const { product ? product->multiply(x, y) : a.multiply(x, y); }
};

/// Nanoseconds that an iteration of CG takes, roughly, for is_interrupted().
inline std::int64_t work_of_iteration(const BlockMatrix& a) { return 10 * static_cast<std::int64_t>(a.blocks.size()); }

/// A matrix whose product is that of `op`. Changed entries are told by MatAssemblyBegin() and MatAssemblyEnd().
Mat create_operator(BlockOperator& op);

}  // namespace rodsweep
