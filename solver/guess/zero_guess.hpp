// The guess zero.
#pragma once

#include "solver/guess/initial_guess.hpp"

namespace rodsweep {

/// Always zero: the denominator of every ratio.
class ZeroGuess : public InitialGuess {
 public:
  Proposal propose(const LinearSystem&, const SolvePosition&, VectorX& x0) override {
    x0.setZero();
    return {};
  }
  void accept(const LinearSystem&, const SolvePosition&, const VectorX&) override {}
};

}  // namespace rodsweep
