// Long computations look, now and then, whether anybody still wants their result: a task's time may be over, or its
// sweep stopped. Whoever waits says how to find out, for as long as an Interruptible lives, one at a time on a thread;
// loops that may last (iterations of CG, fronts of a factorisation, sweeps over contacts) say what they have done, and
// look when that has come to about two milliseconds. Without an Interruptible nothing is ever interrupted.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>

namespace rodsweep {

/// What a computation that nobody wants any more ends with. What it was changing is in no state to go on from.
class InterruptedComputation : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted: nobody waits for the result any more"; }
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

/// `work`: what was done since the last call, in nanoseconds, roughly. For places that an exception may not cross: once
/// it was true, check_interrupted() throws as soon as it may.
bool is_interrupted(std::int64_t work) noexcept;

/// Throws InterruptedComputation, or what finding out whether anybody waits threw.
void check_interrupted(std::int64_t work);

}  // namespace rodsweep
