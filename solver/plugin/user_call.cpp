#include "solver/plugin/user_call.hpp"

#include <pthread.h>

#include <atomic>
#include <cstdlib>

namespace rodsweep {
namespace {

std::atomic<const char*> code{nullptr};
std::atomic<bool> is_fork{false};

[[maybe_unused]] const int at_fork = pthread_atfork(nullptr, nullptr, [] { is_fork = true; });

}  // namespace

UserCall::UserCall(const char* name, void (*interrupt)()) : unreported_(interrupt) { code = name; }

UserCall::~UserCall() {
  if (is_fork) std::_Exit(EXIT_FAILURE);
  before_.restore();
  code = nullptr;
}

const char* user_code() noexcept { return code; }

}  // namespace rodsweep
