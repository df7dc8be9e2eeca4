#include "solver/guess/regression_guess.hpp"

#include <algorithm>

namespace rodsweep {

RegressionGuess::RegressionGuess(const Scene& scene, int newton_iterations, int size, double noise)
    : newton_iterations_(newton_iterations), size_(size), noise_(noise), equations_(size), coefficients_(size) {
  for (const Rod& rod : scene.rods) {
    const Eigen::Index unknowns = 6 * rod.joint_count();
    const Matrix empty = Matrix::Zero(unknowns, size);
    History none;
    none.weight = none.right_side = VectorX::Ones(unknowns);
    none.right_sides = none.solutions = empty;
    none.gram = Matrix::Zero(size, size);
    none.products = VectorX::Zero(size);
    histories_.insert(histories_.end(), at(newton_iterations), none);
  }
}

RegressionGuess::History& RegressionGuess::history(const SolvePosition& at) {
  return histories_[static_cast<std::size_t>(at.rod * newton_iterations_ + at.newton)];
}

Proposal RegressionGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  History& h = history(at);
  if (h.last_step != at.step - 1) h.known = 0;
  if (h.known == 0) inverse_root_diagonal(system.matrix(), h.weight);
  h.right_side = h.weight.cwiseProduct(system.rhs());
  h.squared_norm = h.right_side.squaredNorm();
  h.products.head(h.known).noalias() = h.right_sides.leftCols(h.known).transpose() * h.right_side;
  if (h.known == 0) {
    x0.setZero();
    return {};
  }
  const auto by_age = [&](int age) { return (h.newest - age + size_) % size_; };
  for (int i = 0; i < h.known; ++i) {
    equations_.right_side(i) = h.products[by_age(i)];
    for (int k = 0; k < h.known; ++k) equations_.gram(i, k) = h.gram(by_age(i), by_age(k));
  }
  equations_.factorise(h.known, noise_);
  equations_.solve();
  for (int i = 0; i < h.known; ++i) coefficients_[by_age(i)] = equations_.coefficient(i);
  x0.noalias() = h.solutions.leftCols(h.known) * coefficients_.head(h.known);
  return {true, 0};
}

void RegressionGuess::accept(const LinearSystem&, const SolvePosition& at, const VectorX& solution) {
  History& h = history(at);
  h.newest = h.known == 0 ? 0 : (h.newest + 1) % size_;
  h.known = std::min(h.known + 1, size_);
  h.last_step = at.step;
  h.right_sides.col(h.newest) = h.right_side;
  h.solutions.col(h.newest) = solution;
  h.gram.col(h.newest) = h.products;
  h.gram.row(h.newest) = h.gram.col(h.newest).transpose();
  h.gram(h.newest, h.newest) = h.squared_norm;
}

void RegressionGuess::accept_total(int rod, int step, const VectorX& total) {
  History& h = history({step, 0, rod});
  if (h.last_step == step) h.solutions.col(h.newest) = total;
}

}  // namespace rodsweep
