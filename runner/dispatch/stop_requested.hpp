// The function that a running task polls between time steps and within them.
#pragma once

#include <functional>

namespace rodsweep {

/// True: abandon the task and discard its results.
using StopRequested = std::function<bool()>;

}  // namespace rodsweep
