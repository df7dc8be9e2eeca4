#include "runner/command/process_end.hpp"

#include <atomic>
#include <cstdlib>

namespace rodsweep {
namespace {

std::atomic<bool> is_ending{false};

}  // namespace

void process_ends() noexcept { is_ending = true; }

bool process_is_ending() noexcept { return is_ending; }

void leave(ExitCode code) {
  process_ends();
  std::_Exit(static_cast<int>(code));
}

}  // namespace rodsweep
