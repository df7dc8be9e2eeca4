// Guesses around another one, to which they pass all calls that they do not replace.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "solver/guess/initial_guess.hpp"

namespace rodsweep {

class WrappedGuess : public InitialGuess {
 public:
  explicit WrappedGuess(std::unique_ptr<InitialGuess> inner) : inner_(std::move(inner)) {}
  void prepare(const SolvePosition& at) override { inner_->prepare(at); }
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override {
    return inner_->propose(system, at, x0);
  }
  void accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) override {
    inner_->accept(system, at, solution);
  }
  void accept_total(int rod, int step, const VectorX& total) override { inner_->accept_total(rod, step, total); }
  Deflation* deflation() override { return used_ ? inner_->deflation() : nullptr; }

 protected:
  /// Sets r to b - A x0 of a proposal.
  static void find_residual(const LinearSystem& system, const Proposal& of, const VectorX& x0, VectorX& r) {
    if (!of.nonzero) {
      r = system.rhs();
    } else if (of.residual) {
      r = *of.residual;
    } else {
      system.multiply(x0.data(), r.data());
      r = system.rhs() - r;
    }
  }

  std::unique_ptr<InitialGuess> inner_;
  bool used_ = true;  ///< the last proposal is that of the inner guess
};

/// Uses another guess at the first Newton iteration of a step, zero at the others: for guesses trained on first ones.
class FirstGuess : public WrappedGuess {
 public:
  using WrappedGuess::WrappedGuess;
  void prepare(const SolvePosition& at) override {
    if (at.newton == 0) inner_->prepare(at);
  }
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override {
    used_ = at.newton == 0;
    if (used_) return inner_->propose(system, at, x0);
    x0.setZero();
    return {};
  }
  void accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) override {
    if (at.newton == 0) inner_->accept(system, at, solution);
  }
};

/// Uses another guess only if sqrt(r^T D^-1 r) of r = b - A x0 is below `threshold` times that of b, D the diagonal of
/// A (the natural norm of Jacobi-preconditioned CG); else zero.
class GuardedGuess : public WrappedGuess {
 public:
  GuardedGuess(const Scene& scene, std::unique_ptr<InitialGuess> inner, double threshold)
      : WrappedGuess(std::move(inner)), threshold_(threshold), residual_(unknowns_of(scene)) {}
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) override;

 private:
  double threshold_;
  std::vector<VectorX> residual_;  ///< per rod
};

/// Gives another guess a history of whole steps: the sum of a step's increments replaces the solution of its first
/// Newton iteration,
///   x_n = sum_j dlambda_j of step n.
/// In a closed loop the first iteration's solution is inexact, and later iterations correct it: the sum is the best
/// known change of the step. It is complete at the next step's first system, when prepare() passes it to the inner
/// guess (accept_total). The inner guess accepts the solution of every system as without totals, and later iterations
/// keep their own histories.
class TotalsGuess : public WrappedGuess {
 public:
  TotalsGuess(const Scene& scene, std::unique_ptr<InitialGuess> inner);
  void prepare(const SolvePosition& at) override;
  void accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) override;
  void accept_total(int, int, const VectorX&) override {}  // its own sums are more recent

 private:
  struct Total {
    VectorX sum;
    int step = -1;     ///< of the sum
    bool told = true;  ///< whether the inner guess received it
  };
  std::vector<Total> totals_;  ///< per rod
};

}  // namespace rodsweep
