// The question that a running task asks between its time steps, and now and then within them.
#pragma once

#include <functional>

namespace rodsweep {

/// True abandons the task; what it has so far must then be thrown away.
using StopRequested = std::function<bool()>;

}  // namespace rodsweep
