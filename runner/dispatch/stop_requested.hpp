// The question that a running task asks between its time steps.
#pragma once

#include <functional>

namespace rodsweep {

/// True abandons the task; what it has so far must then be thrown away.
using StopRequested = std::function<bool()>;

}  // namespace rodsweep
