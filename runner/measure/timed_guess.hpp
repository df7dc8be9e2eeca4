// A guess and its time for one system [s]:
//   seconds = prepare + median of the repeated proposals + accept,
// so that one-time work is counted once, regardless of the repeats.
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

  /// Starts a system and clears earlier times.
  void prepare(const SolvePosition& at);
  /// Not timed, because the first proposal for a system has cold caches.
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0);
  Proposal propose_timed(const LinearSystem& system, const SolvePosition& at, VectorX& x0);
  void accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution);
  Deflation* deflation() { return guess_->deflation(); }

  /// Requires at least one timed proposal.
  double seconds();

 private:
  std::unique_ptr<InitialGuess> guess_;
  TimeSource now_;
  double once_s_ = 0;
  std::vector<double> proposals_s_;
};

}  // namespace rodsweep
