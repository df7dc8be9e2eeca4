// The keys of a scene.
#pragma once

#include "runner/job/key.hpp"

namespace rodsweep {

Key scene_key();

}  // namespace rodsweep
