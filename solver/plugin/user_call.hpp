// A call of a user's code: of a function of a plug-in, or its loading. While it lasts, the task's limits and the rank's
// messages are looked after (UnreportedCall); after it, floating-point arithmetic is as it was before: rounding and
// flushing to zero, which fesetround(), PyTorch or a library compiled with -ffast-math change, would change the results of
// all later tasks.
#pragma once

#include "solver/linear/interruption.hpp"
#include "solver/numbers/arithmetic.hpp"

namespace rodsweep {

class UserCall {
 public:
  /// `name`: of the code, for messages; must outlive this. `interrupt`: see UnreportedCall.
  explicit UserCall(const char* name, void (*interrupt)() = nullptr);
  /// Ends a process that the code forked: only the code of the fork may run in it.
  ~UserCall();
  UserCall(const UserCall&) = delete;
  UserCall& operator=(const UserCall&) = delete;

 private:
  UnreportedCall unreported_;
  Arithmetic before_;
};

/// The name of the user's code that this process is in, or null. For signal handlers and other threads.
const char* user_code() noexcept;

}  // namespace rodsweep
