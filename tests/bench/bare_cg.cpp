#include "tests/bench/bare_cg.hpp"

namespace rodsweep {

BareCg::BareCg(const BlockMatrix& a)
    : a_(a), inverse_diagonal_(a.unknowns()), r_(a.unknowns()), z_(r_), p_(r_), w_(r_) {
  for (int row = 0; row < a.block_rows(); ++row)
    for (int i = 0; i < 6; ++i)
      inverse_diagonal_[6 * row + i] = 1 / a.blocks[static_cast<std::size_t>(a.diagonal(row))].column[i][i];
}

double BareCg::run(const VectorX& b, VectorX& x, int iterations) {
  x.setZero();
  r_ = b;
  z_ = inverse_diagonal_.cwiseProduct(r_);
  p_ = z_;
  double rz = r_.dot(z_), norm = r_.norm();
  for (int i = 0; i < iterations; ++i) {
    a_.multiply(p_.data(), w_.data());
    const double alpha = rz / p_.dot(w_);
    x += alpha * p_;
    r_ -= alpha * w_;
    norm = r_.norm();
    z_ = inverse_diagonal_.cwiseProduct(r_);
    const double next = r_.dot(z_);
    p_ = z_ + next / rz * p_;
    rz = next;
  }
  return norm;
}

}  // namespace rodsweep
