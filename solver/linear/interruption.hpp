// Cancelling of long computations: a task may exceed its time limit, or its sweep may be stopped. The caller creates an
// Interruptible with a function that returns whether to stop; one may exist per thread at a time. Long loops
// (iterations of CG, fronts of a factorisation, sweeps over contacts) report their work, and call that function about
// every two milliseconds of it. Without an Interruptible nothing is interrupted.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>

namespace rodsweep {

/// Thrown by a cancelled computation. The objects that it was changing must not be used further.
class InterruptedComputation : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted: the computation was cancelled"; }
};

class Interruptible {
 public:
  explicit Interruptible(std::function<bool()> unwanted);
  ~Interruptible();
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;

 private:
  std::function<bool()> unwanted_;
};

/// `work`: the work done since the last call, in nanoseconds, roughly. For code that must not throw: once this has
/// returned true, the next check_interrupted() throws.
bool is_interrupted(std::int64_t work) noexcept;

/// Throws InterruptedComputation, or any exception of the Interruptible's function.
void check_interrupted(std::int64_t work);

}  // namespace rodsweep
