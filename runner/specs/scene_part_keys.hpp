// The keys of the parts of a scene in a job: `section`, `tip_motion`, `wind`, `contact`, `obstacles`, `loads`,
// `motions`, `gravity_changes`.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "runner/keys/key_table.hpp"
#include "solver/scene/scene.hpp"
#include "solver/scene/scenes.hpp"
#include "solver/scene/wind.hpp"

namespace rodsweep {

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
