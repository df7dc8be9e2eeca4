// The keys of `scene` in a job: one table for all scenes of the variant SceneSpec. A new scene adds rows only for its
// own members. If it has members of existing rows, scene names in errors, defaults and the schema are derived
// automatically.
#pragma once

#include "runner/keys/key_table.hpp"
#include "solver/scene/scenes.hpp"

namespace rodsweep {

const KeyTable<SceneSpec>& scene_keys();

Key scene_key();

}  // namespace rodsweep
