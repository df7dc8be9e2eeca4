#include "solver/cg/block_preconditioner.hpp"

#include <algorithm>

#include "solver/factor/block_factor.hpp"
#include "solver/factor/elimination_order.hpp"
#include "solver/factor/incomplete_factor.hpp"

namespace rodsweep {
namespace {

class Incomplete : public BlockPreconditioner {
 public:
  Incomplete(const BlockMatrix& pattern, int levels) : factor_(pattern, breadth_first_order(pattern), levels) {}
  bool set_up(const BlockMatrix& a) override { return factor_.factorise(a); }
  void apply(const double* r, double* z) override { factor_.apply(r, z); }

 private:
  IncompleteFactor factor_;
};

class Complete : public BlockPreconditioner {
 public:
  explicit Complete(const BlockMatrix& pattern)
      : factor_(pattern, given_order(pattern)), x_(VectorX::Zero(pattern.unknowns())) {}
  bool set_up(const BlockMatrix& a) override { return factor_.factorise(a); }
  void apply(const double* r, double* z) override {
    std::copy_n(r, x_.size(), x_.data());
    factor_.substitute(x_);
    std::copy_n(x_.data(), x_.size(), z);
  }

 private:
  BlockFactor factor_;
  VectorX x_;
};

/// The factors of the diagonal blocks.
class PointBlocks : public BlockPreconditioner {
 public:
  explicit PointBlocks(const BlockMatrix& pattern) : blocks_(pattern.block_rows(), {}), factor_(blocks_) {}
  bool set_up(const BlockMatrix& a) override {
    for (int row = 0; row < a.block_rows(); ++row) blocks_.blocks[at(row)] = a.blocks[at(a.diagonal(row))];
    return factor_.set_up(blocks_);
  }
  void apply(const double* r, double* z) override { factor_.apply(r, z); }

 private:
  BlockMatrix blocks_;
  Complete factor_;
};

}  // namespace

std::unique_ptr<BlockPreconditioner> block_preconditioner(Preconditioner kind, const BlockMatrix& pattern,
                                                          int fill_levels) {
  if (kind == Preconditioner::point_block_jacobi) return std::make_unique<PointBlocks>(pattern);
  if (kind == Preconditioner::block_icc) return std::make_unique<Incomplete>(pattern, fill_levels);
  if (kind == Preconditioner::cholesky || kind == Preconditioner::lagged_cholesky)
    return std::make_unique<Complete>(pattern);
  return nullptr;
}

}  // namespace rodsweep
