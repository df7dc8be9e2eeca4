#include "solver/linear/interruption.hpp"

#include <utility>

namespace rodsweep {
namespace {

constexpr std::int64_t between_looks = 2'000'000;

struct Waiting {
  const std::function<bool()>* unwanted = nullptr;
  std::int64_t done = 0;
  bool interrupted = false;
  std::exception_ptr failure;  ///< thrown by `unwanted`
};
thread_local Waiting waiting;

}  // namespace

Interruptible::Interruptible(std::function<bool()> unwanted) : unwanted_(std::move(unwanted)) {
  waiting = Waiting{&unwanted_, 0, false, nullptr};
}

Interruptible::~Interruptible() { waiting = Waiting(); }

bool is_interrupted(std::int64_t work) noexcept {
  if (!waiting.unwanted) return false;
  waiting.done += work;
  if (!waiting.interrupted && waiting.done >= between_looks) {
    waiting.done = 0;
    try {
      waiting.interrupted = (*waiting.unwanted)();
    } catch (...) {
      waiting.failure = std::current_exception();
      waiting.interrupted = true;
    }
  }
  return waiting.interrupted;
}

void check_interrupted(std::int64_t work) {
  if (!is_interrupted(work)) return;
  if (waiting.failure) std::rethrow_exception(waiting.failure);
  throw InterruptedComputation();
}

}  // namespace rodsweep
