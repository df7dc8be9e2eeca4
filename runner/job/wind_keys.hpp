// The wind of a scene in a job: its keys, and what they describe.
#pragma once

#include <optional>

#include "runner/job/key.hpp"
#include "runner/job/sweep_space.hpp"
#include "solver/scene/wind.hpp"

namespace rodsweep {

Key wind_key();

/// At a parameter point; nothing where there is "none".
std::optional<WindParameters> wind_parameters(const Point& point);

}  // namespace rodsweep
