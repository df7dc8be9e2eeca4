#include "solver/guess/subspace_guess.hpp"

#include <cmath>

namespace rodsweep {
namespace {

constexpr double smallest_pivot = 1e-12;  // of energies scaled to 1: what is below is rounding error

}  // namespace

SubspaceGuess::SubspaceGuess(const Scene& scene, int newton_iterations, int size, Window window)
    : newton_iterations_(newton_iterations),
      size_(size),
      window_(window),
      factor_(size, size),
      pivot_(size),
      scale_(size),
      coefficients_(size) {
  for (const Rod& rod : scene.rods) {
    const Matrix empty = Matrix::Zero(6 * rod.joint_count(), size);
    products_.push_back(empty);
    histories_.insert(histories_.end(), static_cast<std::size_t>(newton_iterations), History{empty});
  }
}

SubspaceGuess::History& SubspaceGuess::history(const SolvePosition& at) {
  return histories_[static_cast<std::size_t>(at.rod * newton_iterations_ + at.newton)];
}

Proposal SubspaceGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  const History& h = history(at);
  x0.setZero();
  if (h.last_step != at.step - 1 || h.known == 0) return {};
  Matrix& products = products_[static_cast<std::size_t>(at.rod)];
  for (int i = 0; i < h.known; ++i) system.matrix().multiply(h.solutions.col(i).data(), products.col(i).data());

  // L D L^T of the energies, rows in the order of age; a dropped solution has pivot 0.
  const auto by_age = [&](int age) { return (h.newest - age + size_) % size_; };
  for (int i = 0; i < h.known; ++i) {
    const auto solution = h.solutions.col(by_age(i));
    const double energy = solution.dot(products.col(by_age(i)));
    scale_[i] = energy > 0 ? 1 / std::sqrt(energy) : 0;
    pivot_[i] = energy > 0 ? 1 : 0;
    coefficients_[i] = scale_[i] * solution.dot(system.rhs());
    for (int k = 0; k < i; ++k) {
      double sum = scale_[i] * scale_[k] * solution.dot(products.col(by_age(k)));
      for (int m = 0; m < k; ++m) sum -= factor_(i, m) * factor_(k, m) * pivot_[m];
      factor_(i, k) = pivot_[k] > 0 ? sum / pivot_[k] : 0;
      pivot_[i] -= factor_(i, k) * factor_(i, k) * pivot_[k];
      coefficients_[i] -= factor_(i, k) * coefficients_[k];
    }
    if (!(pivot_[i] > smallest_pivot)) pivot_[i] = coefficients_[i] = 0;
  }
  for (int i = h.known - 1; i >= 0; --i) {
    if (pivot_[i] == 0) continue;
    coefficients_[i] /= pivot_[i];
    for (int k = i + 1; k < h.known; ++k) coefficients_[i] -= factor_(k, i) * coefficients_[k];
    x0 += scale_[i] * coefficients_[i] * h.solutions.col(by_age(i));
  }
  return {true, h.known};
}

void SubspaceGuess::accept(const SolvePosition& at, const VectorX& solution) {
  History& h = history(at);
  const bool again = h.last_step != at.step - 1 || (window_ == Window::restarted && h.known == size_);
  if (again) h.known = 0;
  h.newest = again ? 0 : (h.newest + 1) % size_;
  h.known = std::min(h.known + 1, size_);
  h.last_step = at.step;
  h.solutions.col(h.newest) = solution;
}

}  // namespace rodsweep
