// Guesses around another one, to which they pass all calls that they do not replace.
#pragma once

#include <memory>
#include <utility>

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

}  // namespace rodsweep
