// Preconditioners of CG built from our block kernels, behind one interface.
#pragma once

#include <memory>

#include "solver/linear/block_matrix.hpp"

namespace rodsweep {

/// none; jacobi: the diagonal; point_block_jacobi: the 6x6 diagonal blocks; icc: incomplete Cholesky without fill, by
/// PETSc, joints in the rod's order (exact on an unbranched chain); block_icc: incomplete with `fill_levels` of fill,
/// in reverse Cuthill-McKee order and single precision (incomplete_factor.hpp); cholesky: complete (block_factor.hpp);
/// lagged_cholesky: the same, reused by the caller for some steps; condensed: struts by elimination, the matrix of
/// their ends by block_icc (condensed_cg.hpp); learned, plugin, python: made by the caller
/// (CgSettings::make_given).
enum class Preconditioner {
  none,
  jacobi,
  point_block_jacobi,
  icc,
  block_icc,
  cholesky,
  lagged_cholesky,
  condensed,
  learned,
  plugin,
  python
};

/// Default of block_icc and condensed.
inline constexpr int default_fill_levels = 3;

class BlockPreconditioner {
 public:
  virtual ~BlockPreconditioner() = default;
  /// Sets up for a matrix with the pattern of construction. Returns false if it is not positive definite. May throw.
  virtual bool set_up(const BlockMatrix& a) = 0;
  /// z = P^-1 r. Allocates nothing. May throw.
  virtual void apply(const double* r, double* z) = 0;
};

/// Null for preconditioners of PETSc or of the caller.
std::unique_ptr<BlockPreconditioner> block_preconditioner(Preconditioner kind, const BlockMatrix& pattern,
                                                          int fill_levels);

}  // namespace rodsweep
