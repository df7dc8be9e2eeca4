#include "solver/guess/regression_guess.hpp"

namespace rodsweep {

RegressionGuess::RegressionGuess(const Scene& scene, int newton_iterations, int size, double noise)
    : HistoryGuess(newton_iterations),
      noise_(noise),
      order_(Eigen::VectorXi::Zero(size)),
      equations_(size),
      coefficients_(size) {
  for (const Rod& rod : scene.rods) {
    const VectorX ones = VectorX::Ones(6 * rod.joint_count());
    const Eigen::MatrixXd empty = Eigen::MatrixXd::Zero(ones.size(), size);
    add_rod({{size}, ones, empty, empty, Eigen::MatrixXd::Zero(size, size), ones, VectorX::Zero(size)});
  }
}

Proposal RegressionGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  SolvedSystems& h = history(at);
  h.known = h.usable(at.step);
  if (h.known == 0) inverse_root_diagonal(system.matrix(), h.weight);
  h.right_side = h.weight.cwiseProduct(system.rhs());
  h.squared_norm = h.right_side.squaredNorm();
  h.products.head(h.known).noalias() = h.right_sides.leftCols(h.known).transpose() * h.right_side;
  if (h.known == 0) {
    x0.setZero();
    return {};
  }
  h.put_order(order_);
  equations_.factorise(h.gram, order_, h.known, noise_);
  coefficients_ = h.products;
  equations_.solve(order_, coefficients_);
  x0.noalias() = h.solutions.leftCols(h.known) * coefficients_.head(h.known);
  return {true, 0};
}

void RegressionGuess::accept(const LinearSystem&, const SolvePosition& at, const VectorX& solution) {
  SolvedSystems& h = history(at);
  h.add(at.step);
  h.right_sides.col(h.newest) = h.right_side;
  h.keep(solution);
  h.gram.col(h.newest) = h.products;
  h.gram.row(h.newest) = h.gram.col(h.newest).transpose();
  h.gram(h.newest, h.newest) = h.squared_norm;
}

}  // namespace rodsweep
