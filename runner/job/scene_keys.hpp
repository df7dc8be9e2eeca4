// Scenes in a job: the keys of `scene`, a table for all scenes of the variant SceneSpec. A scene adds rows for what it
// alone has; where it has the members of other scenes' rows, the names of scenes in refusals, defaults and the schema
// follow.
#pragma once

#include "runner/job/key_table.hpp"
#include "solver/scene/scenes.hpp"

namespace rodsweep {

const KeyTable<SceneSpec>& scene_keys();

Key scene_key();

}  // namespace rodsweep
