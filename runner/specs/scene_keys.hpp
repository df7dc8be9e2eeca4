// The keys of `scene` in a job: one table for all scenes of the variant SceneSpec. A new scene adds rows only for its
// own members. If it has members of existing rows, scene names in errors, defaults and the schema are derived
// automatically.
#pragma once

#include <vector>

#include "runner/keys/key_table.hpp"
#include "solver/scene/scene.hpp"
#include "solver/scene/scenes.hpp"
#include "solver/scene/wind.hpp"

namespace rodsweep {

const KeyTable<SceneSpec>& scene_keys();

Key scene_key();

// The keys of the parts of a scene in a job: `section`, `tip_motion`, `wind`, `contact`, `obstacles`, `loads`,
// `motions`, `gravity_changes`.

KeyTable<SectionShape> section_keys();
KeyTable<TipMotion> tip_motion_keys();
KeyTable<WindParameters> wind_keys();
KeyTable<ContactSettings> contact_keys();
Key obstacles_key();

/// Throws JobError if a half-space has no direction.
void read_value(const KeyValue& list, std::vector<Obstacle>& obstacles);

Key loads_key();
Key motions_key();
Key gravity_changes_key();
void read_value(const KeyValue& list, std::vector<double>& numbers);
void read_value(const KeyValue& list, std::vector<PrescribedLoad>& loads);
void read_value(const KeyValue& list, std::vector<PrescribedMotion>& motions);
void read_value(const KeyValue& list, std::vector<GravityChange>& changes);
void read_value(const KeyValue& list, std::vector<Vector3>& points);

}  // namespace rodsweep
