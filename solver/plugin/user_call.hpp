// A call of a user's code: of a function of a plug-in, or its loading. While it lasts, the task's limits and the rank's
// messages are looked after (UnreportedCall); after it, floating-point arithmetic is as it was before: rounding and
// flushing to zero, which fesetround(), PyTorch or a library compiled with -ffast-math change, would change the results of
// all later tasks.
#pragma once

#include <cfenv>

#include "solver/linear/interruption.hpp"

namespace rodsweep {

/// The modes of this thread's floating-point arithmetic: rounding, flushing of tiny numbers to zero, traps.
class Arithmetic {
 public:
  /// Those at construction.
  Arithmetic() { read(); }
  /// Sets them again. On x86 both are a tenth of the time that fegetenv() and fesetenv() take.
  void restore() const {
#if defined(__SSE2__)
    const Arithmetic now;
    constexpr unsigned flags = 0x3F;  // of past operations
    if (((now.sse_ ^ sse_) & ~flags) != 0) __builtin_ia32_ldmxcsr(sse_);
    if (now.x87_ != x87_) __asm__ volatile("fldcw %0" : : "m"(x87_));
#else
    std::fesetenv(&all_);
#endif
  }

 private:
#if defined(__SSE2__)
  void read() {
    sse_ = __builtin_ia32_stmxcsr();
    __asm__ volatile("fnstcw %0" : "=m"(x87_));
  }
  unsigned sse_ = 0;
  unsigned short x87_ = 0;
#else
  void read() { std::fegetenv(&all_); }
  std::fenv_t all_;
#endif
};

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
