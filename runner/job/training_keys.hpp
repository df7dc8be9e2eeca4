// The keys that jobs of kind "train" have beside those of all jobs: a part of the table of runner/job/job_keys.hpp.
#pragma once

#include <vector>

#include "runner/job/key.hpp"

namespace rodsweep {

/// `data`, `validation_simulations`, `network`, `training`; none may be swept.
std::vector<Key> training_keys();

/// `network` alone: what a model file holds of it too.
Key network_key();

}  // namespace rodsweep
