// A guess from its spec, and its time for one system [s]:
//   seconds = prepare + median of the repeated proposals + accept,
// so that one-time work is counted once, regardless of the repeats.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "runner/specs/task_spec.hpp"
#include "solver/guess/initial_guess.hpp"
#include "solver/step/stopwatch.hpp"

namespace rodsweep {

/// Constructs a guess, in guesses.cpp.
std::unique_ptr<InitialGuess> make_guess(const GuessSpec& guess, const TaskSpec& task, const Scene& scene);

/// The median of repeated timings; the upper one if the count is even, so that the result is a measured time. Reorders `values`.
inline double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

class TimedGuess {
 public:
  explicit TimedGuess(std::unique_ptr<InitialGuess> guess, TimeSource now = std::chrono::steady_clock::now)
      : guess_(std::move(guess)), now_(now) {}

  /// Starts a system and clears earlier times.
  void prepare(const SolvePosition& at) {
    proposals_s_.clear();
    const Stopwatch watch(now_);
    guess_->prepare(at);
    once_s_ = watch.seconds();
  }
  /// Not timed, because the first proposal for a system has cold caches.
  Proposal propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
    return guess_->propose(system, at, x0);
  }
  Proposal propose_timed(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
    const Stopwatch watch(now_);
    const Proposal proposal = guess_->propose(system, at, x0);
    proposals_s_.push_back(watch.seconds());
    return proposal;
  }
  void accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) {
    const Stopwatch watch(now_);
    guess_->accept(system, at, solution);
    once_s_ += watch.seconds();
  }
  Deflation* deflation() { return guess_->deflation(); }

  /// Requires at least one timed proposal.
  double seconds() { return once_s_ + median(proposals_s_); }

 private:
  std::unique_ptr<InitialGuess> guess_;
  TimeSource now_;
  double once_s_ = 0;
  std::vector<double> proposals_s_;
};

}  // namespace rodsweep
