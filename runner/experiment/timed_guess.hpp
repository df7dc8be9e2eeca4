// A guess, and what it costs at one system [s]:
//   seconds = prepare + median of the repeated proposals + accept,
// so that what is done once is counted once, however often it proposes.
#pragma once

#include <memory>
#include <vector>

#include "solver/guess/initial_guess.hpp"
#include "solver/step/stopwatch.hpp"

namespace rodsweep {

class TimedGuess {
 public:
  explicit TimedGuess(std::unique_ptr<InitialGuess> guess, TimeSource now = std::chrono::steady_clock::now)
      : guess_(std::move(guess)), now_(now) {}

  /// Begins a system: earlier times are forgotten.
  void prepare(const SolvePosition& at);
  /// Not timed: the first proposal for a system finds it in no cache.
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0);
  void propose_timed(const LinearSystem& system, const SolvePosition& at, VectorX& x0);
  void accept(const SolvePosition& at, const VectorX& solution);
  Deflation* deflation() { return guess_->deflation(); }

  /// At least one proposal was timed.
  double seconds();

 private:
  std::unique_ptr<InitialGuess> guess_;
  TimeSource now_;
  double once_s_ = 0;
  std::vector<double> proposals_s_;
};

}  // namespace rodsweep
