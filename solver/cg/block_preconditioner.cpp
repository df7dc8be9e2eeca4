#include "solver/cg/block_preconditioner.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <vector>

#include "solver/factor/block_factor.hpp"
#include "solver/factor/elimination_order.hpp"
#include "solver/factor/incomplete_factor.hpp"

namespace rodsweep {
namespace {

/// The inverses of the diagonal blocks, by Cholesky.
class PointBlocks : public BlockPreconditioner {
 public:
  explicit PointBlocks(const BlockMatrix& pattern) : inverse_(at(pattern.block_rows())) {}

  bool set_up(const BlockMatrix& a) override {
    for (int row = 0; row < a.block_rows(); ++row) {
      const Block6& block = a.blocks[at(a.diagonal(row))];
      Matrix6 entries;
      for (int c = 0; c < 6; ++c) store6(entries.col(c).data(), block.column[c]);
      const Eigen::LLT<Matrix6> factor(entries);
      if (factor.info() != Eigen::Success) return false;
      Matrix6 inverse = Matrix6::Identity();
      factor.solveInPlace(inverse);
      for (int c = 0; c < 6; ++c) inverse_[at(row)].column[c] = load6(inverse.col(c).data());
    }
    return true;
  }

  void apply(const double* r, double* z) override {
    for (const Block6& block : inverse_) {
      Lane8 even{}, odd{};
      for (int c = 0; c < 6; c += 2) {
        even += block.column[c] * r[c];
        odd += block.column[c + 1] * r[c + 1];
      }
      store6(z, even + odd);
      r += 6;
      z += 6;
    }
  }

 private:
  std::vector<Block6> inverse_;
};

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
