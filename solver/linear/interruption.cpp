#include "solver/linear/interruption.hpp"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

namespace rodsweep {
namespace {

using namespace std::chrono_literals;
using TimePoint = Interruptible::Clock::time_point;

// Reading a clock takes as long as a tenth of an iteration of CG on a short rod. Work is an estimate, which may be
// wrong by two orders of magnitude.
constexpr std::int64_t work_between_looks = 50'000;
constexpr auto between_questions = 2ms;

constexpr auto between_checks = 50ms;  ///< of a call by the other thread
constexpr auto between_interrupts = 1s, long_after = 60s, stuck_after = 60s;

std::atomic<void (*)()> long_handler{nullptr}, stuck_handler{nullptr};

void run(void (*handler)()) {
  if (handler) handler();
}

}  // namespace

struct Interruptible::State {
  State(std::function<bool()> f, TimePoint (*clock)()) : unwanted(std::move(f)), now(clock), asked(clock()) {}

  std::function<bool()> unwanted;
  TimePoint (*now)();
  TimePoint asked;
  std::int64_t work = 0;
  bool interrupted = false;
  std::exception_ptr failure;  ///< thrown by `unwanted`

  struct Call {
    void (*interrupt)() = nullptr;
    std::optional<TimePoint> seen, unwanted_since, told;
    bool is_long = false, is_stuck = false;
  };
  Call call;
  /// All above belongs to the thread that computes, and while it is `checked` to the other one. Calls may be as short as
  /// a tenth of a microsecond, so this is no mutex.
  enum class Phase { no_call, in_call, checked };
  std::atomic<Phase> phase{Phase::no_call};

  std::mutex mutex;  ///< of `ending`
  std::condition_variable end;
  bool ending = false;
  std::thread other;

  bool change(Phase from, Phase to) { return phase.compare_exchange_strong(from, to); }

  void ask() noexcept {
    asked = now();
    try {
      if (unwanted()) interrupted = true;
    } catch (...) {
      failure = std::current_exception();
      interrupted = true;
    }
  }

  /// Run by the other thread.
  void watch() {
    std::unique_lock lock(mutex);
    while (!end.wait_for(lock, between_checks, [this] { return ending; })) {
      if (!change(Phase::in_call, Phase::checked)) continue;
      if (!call.is_stuck) check();
      phase = Phase::in_call;
    }
  }

  void check() {
    if (!call.seen) {
      call.seen = now();
      return;
    }
    if (!failure) ask();
    const TimePoint time = now();
    if (!interrupted) {
      if (time - *call.seen >= long_after && !std::exchange(call.is_long, true)) run(long_handler);
      return;
    }
    if (!call.unwanted_since) call.unwanted_since = time;
    if (call.interrupt && (!call.told || time - *call.told >= between_interrupts)) {
      call.told = time;
      call.interrupt();
    }
    if (time - *call.unwanted_since < stuck_after) return;
    call.is_stuck = true;
    run(stuck_handler);
  }
};

namespace {

thread_local Interruptible::State* current = nullptr;

}  // namespace

Interruptible::Interruptible(std::function<bool()> unwanted, Clock::time_point (*now)())
    : state_(std::make_unique<State>(std::move(unwanted), now)) {
  current = state_.get();
}

Interruptible::~Interruptible() {
  current = nullptr;
  if (!state_->other.joinable()) return;
  {
    const std::lock_guard lock(state_->mutex);
    state_->ending = true;
  }
  state_->end.notify_one();
  state_->other.join();
}

UnreportedCall::UnreportedCall(void (*interrupt)()) : state_(current) {
  if (!state_) return;
  if (!state_->other.joinable()) state_->other = std::thread([state = state_] { state->watch(); });
  state_->call = {};
  state_->call.interrupt = interrupt;
  state_->phase.store(Interruptible::State::Phase::in_call, std::memory_order_release);
}

UnreportedCall::~UnreportedCall() {
  if (!state_) return;
  using Phase = Interruptible::State::Phase;
  while (!state_->change(Phase::in_call, Phase::no_call)) std::this_thread::sleep_for(100us);
  state_->work = work_between_looks;
}

void handle_calls(const CallHandlers& handlers) noexcept {
  long_handler = handlers.is_long;
  stuck_handler = handlers.is_stuck;
}

bool is_interrupted(std::int64_t work) noexcept {
  if (!current) return false;
  Interruptible::State& state = *current;
  state.work += work;
  if (state.interrupted || state.work < work_between_looks) return state.interrupted;
  state.work = 0;
  if (state.now() - state.asked >= between_questions) state.ask();
  return state.interrupted;
}

void check_interrupted(std::int64_t work) {
  if (is_interrupted(work)) throw_interruption("");
}

void throw_interruption(const std::string& where) {
  if (current->failure) std::rethrow_exception(current->failure);
  throw InterruptedComputation(where);
}

}  // namespace rodsweep
