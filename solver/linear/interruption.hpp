// Cancelling of long computations: a task may exceed its time limit, or a run may be stopped. The caller creates an
// Interruptible with a function that returns whether to stop; one may exist per thread at a time. Long loops
// (iterations of CG, fronts of a factorisation, sweeps over contacts) report their work. After some of it they look at the
// clock, and call that function every two milliseconds. Without an Interruptible nothing is interrupted.
//
// Code that cannot report its work, such as a user's, runs within an UnreportedCall. While it lasts, another thread calls
// the function, so what it does must be possible in any one thread at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace rodsweep {

/// Thrown by a cancelled computation. The objects that it was changing must not be used further.
class InterruptedComputation : public std::exception {
 public:
  explicit InterruptedComputation(std::string where = "") : where_(std::move(where)) {}
  const char* what() const noexcept override { return "interrupted: the computation was cancelled"; }
  /// The user's code that was running, "my_guess.py:12 in propose"; else empty.
  const std::string& where() const { return where_; }

 private:
  std::string where_;
};

class Interruptible {
 public:
  using Clock = std::chrono::steady_clock;
  explicit Interruptible(std::function<bool()> unwanted, Clock::time_point (*now)() = Clock::now);
  ~Interruptible();
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;

  struct State;

 private:
  std::unique_ptr<State> state_;
};

/// Lasts as long as a call of code that reports no work. From its first tenth of a second on, another thread asks some
/// 20 times a second whether the computation is wanted. If it is not, that thread calls `interrupt` every second, which
/// should make the call return soon. If it has not a minute later, it is stuck: the other thread asks no more, so that the
/// heartbeats of this rank end.
class UnreportedCall {
 public:
  /// `interrupt` may be null: then the call cannot be ended early.
  explicit UnreportedCall(void (*interrupt)());
  ~UnreportedCall();
  UnreportedCall(const UnreportedCall&) = delete;
  UnreportedCall& operator=(const UnreportedCall&) = delete;

 private:
  Interruptible::State* state_;
};

/// What that thread calls too, each once per call; null: nothing.
struct CallHandlers {
  void (*is_long)() = nullptr;   ///< it has run for a minute, and is wanted
  void (*is_stuck)() = nullptr;  ///< may end the process
};
/// Sets them, for all threads.
void handle_calls(const CallHandlers& handlers) noexcept;

/// `work`: the work done since the last call, in nanoseconds, roughly. For code that must not throw: once this has
/// returned true, the next check_interrupted() throws.
bool is_interrupted(std::int64_t work) noexcept;

/// Throws InterruptedComputation, or any exception of the Interruptible's function.
void check_interrupted(std::int64_t work);

/// What check_interrupted() throws once is_interrupted() has returned true. `where`: the user's code that was running.
[[noreturn]] void throw_interruption(const std::string& where);

}  // namespace rodsweep
