// Wind in a job: the keys of `scene.wind`.
#pragma once

#include "runner/job/key_table.hpp"
#include "solver/scene/wind.hpp"

namespace rodsweep {

KeyTable<WindParameters> wind_keys();

}  // namespace rodsweep
