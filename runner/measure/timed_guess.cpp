#include "runner/measure/timed_guess.hpp"

#include "runner/measure/median.hpp"

namespace rodsweep {

void TimedGuess::prepare(const SolvePosition& at) {
  proposals_s_.clear();
  const Stopwatch watch(now_);
  guess_->prepare(at);
  once_s_ = watch.seconds();
}

Proposal TimedGuess::propose(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  return guess_->propose(system, at, x0);
}

Proposal TimedGuess::propose_timed(const LinearSystem& system, const SolvePosition& at, VectorX& x0) {
  const Stopwatch watch(now_);
  const Proposal proposal = guess_->propose(system, at, x0);
  proposals_s_.push_back(watch.seconds());
  return proposal;
}

void TimedGuess::accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) {
  const Stopwatch watch(now_);
  guess_->accept(system, at, solution);
  once_s_ += watch.seconds();
}

double TimedGuess::seconds() { return once_s_ + median(proposals_s_); }

}  // namespace rodsweep
