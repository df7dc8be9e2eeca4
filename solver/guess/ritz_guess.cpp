#include "solver/guess/ritz_guess.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace rodsweep {
namespace {

/// Eigenvalues of V^T M V, scaled to a unit diagonal, below this belong to combinations that are rounding.
constexpr double smallest_mass = 1e-8;

}  // namespace

RitzGuess::RitzGuess(const Scene& scene, std::unique_ptr<InitialGuess> inner, int size, int collected, int lag_steps)
    : WrappedGuess(std::move(inner)),
      size_(size),
      most_collected_(collected),
      lag_steps_(lag_steps),
      order_(size),
      projection_(size),
      gram_(size + collected, size + collected),
      mass_(size + collected, size + collected),
      combinations_(size + collected, size + collected),
      eigen_(size + collected),
      dropped_(at(size + collected)),
      coefficients_(VectorX::Zero(size + collected)) {
  std::iota(order_.begin(), order_.end(), 0);
  for (const Rod& rod : scene.rods) {
    const int n = 6 * rod.joint_count();
    const StoredVectors none(n, size);
    const Basis basis{StoredVectors(n, size + collected), Eigen::MatrixXd::Zero(n, size + collected), {}};
    spaces_.push_back(
        {none, none, 0, basis, basis, false, Eigen::MatrixXd::Zero(n, size), VectorX::Zero(n), VectorX::Zero(n), 0});
    for (Basis* of : {&spaces_.back().begun, &spaces_.back().basis}) of->values.reserve(at(size));
  }
}

Proposal RitzGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  Space& space = spaces_[static_cast<std::size_t>(at.rod)];
  space_ = &space;
  matrix_ = &system.matrix();
  collecting_ = at.step >= space.next_step;
  collected_ = 0;
  if (std::exchange(space.changed, false)) space.basis = space.begun;
  Proposal proposal = inner_->propose(system, at, x0);
  if (space.known == 0) return proposal;

  proposal.products = proposal.start_products() + space.known;
  find_residual(system, proposal, x0, space.residual);
  projection_.project(*matrix_, space.residual, space.ritz, order_, space.known, space.scratch);
  projection_.deflate(*matrix_, space.ritz, space.products);
  projection_.subtract_product(space.residual);
  x0 += space.scratch;
  proposal.nonzero = true;
  proposal.residual = &space.residual;
  return proposal;
}

void RitzGuess::reduce(double* r) {
  Space& space = *space_;
  if (space.known > 0) projection_.reduce(r);
  if (!collecting_) return;
  if (collected_ == most_collected_) rayleigh_ritz(space, *matrix_);
  space.basis.images.col(size_ + collected_) = Eigen::Map<const VectorX>(r, space.basis.images.rows());
}

void RitzGuess::complete(double* z) {
  Space& space = *space_;
  if (collecting_) {
    space.changed = true;
    space.scratch = Eigen::Map<const VectorX>(z, space.scratch.size());
    space.basis.vectors.set(size_ + collected_++, space.scratch);
  }
  if (space.known > 0) projection_.complete(z);
}

void RitzGuess::accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) {
  inner_->accept(system, at, solution);
  if (collected_ == 0) return;
  Space& space = spaces_[static_cast<std::size_t>(at.rod)];
  if (!rayleigh_ritz(space, system.matrix())) return;
  space.begun = space.basis;
  space.changed = false;
  space.known = static_cast<int>(space.begun.values.size());
  for (int k = 0; k < space.known; ++k) {
    space.scratch = space.combined.col(k);
    space.ritz.set(k, space.scratch);
  }
  space.next_step = at.step + lag_steps_;
}

bool RitzGuess::rayleigh_ritz(Space& space, const BlockMatrix& a) {
  space.basis.vectors.project(a, space.residual, gram_, coefficients_);
  const bool finite = orthonormalise(space);
  collected_ = 0;
  if (!finite) return false;
  mass_.noalias() = gram_.lazyProduct(combinations_);
  gram_.noalias() = combinations_.transpose().lazyProduct(mass_);
  if (!gram_.allFinite()) return false;
  // Dropped combinations are zero. Their eigenvalue is the largest, so that they come last.
  const double largest = 2 * gram_.trace();
  for (int i = 0; i < gram_.rows(); ++i)
    if (dropped_[at(i)]) gram_(i, i) = largest;
  eigen_.compute(gram_);
  mass_.noalias() = combinations_.lazyProduct(eigen_.eigenvectors());
  const int spanned = static_cast<int>(std::count(dropped_.begin(), dropped_.end(), false));
  const int kept = std::min(size_, spanned);
  space.basis.values.assign(eigen_.eigenvalues().begin(), eigen_.eigenvalues().begin() + kept);
  restart(space, kept);
  return true;
}

bool RitzGuess::orthonormalise(Space& space) {
  const int known = static_cast<int>(space.basis.values.size());
  const auto used = [&](int i) { return i < known || (i >= size_ && i < size_ + collected_); };
  const int most = static_cast<int>(mass_.rows());
  combinations_.setZero();
  for (int k = 0; k < most; ++k) {
    if (!used(k)) continue;
    space.basis.vectors.dots(space.basis.images.col(k).data(), coefficients_);
    for (int i = 0; i < most; ++i)
      if (used(i)) combinations_(i, k) = coefficients_[i];
  }
  for (int i = 0; i < most; ++i) {
    const double square = combinations_(i, i);
    coefficients_[i] = square > 0 ? 1 / std::sqrt(square) : 0;
  }
  mass_ = 0.5 * (combinations_ + combinations_.transpose());
  mass_ = coefficients_.asDiagonal() * mass_ * coefficients_.asDiagonal();
  if (!mass_.allFinite()) return false;
  eigen_.compute(mass_);
  for (int i = 0; i < most; ++i) {
    const double value = eigen_.eigenvalues()[i];
    dropped_[at(i)] = value < smallest_mass;
    const double scale = value < smallest_mass ? 0 : 1 / std::sqrt(value);
    combinations_.col(i) = scale * coefficients_.cwiseProduct(eigen_.eigenvectors().col(i));
  }
  return true;
}

/// The first vectors of V become V C, and those of M V become M V C, C the first columns of mass_.
void RitzGuess::restart(Space& space, int kept) {
  Eigen::MatrixXd& images = space.basis.images;
  for (int k = 0; k < kept; ++k) {
    coefficients_ = mass_.col(k);
    space.basis.vectors.combine(coefficients_, space.scratch);
    space.combined.col(k) = space.scratch;
  }
  for (int k = 0; k < kept; ++k) {
    space.scratch = space.combined.col(k);
    space.basis.vectors.set(k, space.scratch);
  }
  for (int row = 0; row < images.rows(); ++row) {
    coefficients_.noalias() = mass_.transpose().lazyProduct(images.row(row).transpose());
    images.row(row).head(kept) = coefficients_.head(kept);
  }
}

}  // namespace rodsweep
