// The deck's two test scenes: a bending rod and a hanging helix, from a handful of parameters.
//
// Bending rod: straight and at rest, its first end at the origin, pointing along +x raised by `initial_angle_deg`
// towards +y; gravity bends it. Helix: joints on the curve (R cos t, -H t / (2 pi windings), R sin t), t in [0, 2 pi
// windings], so its axis is vertical (y) and it hangs from its first segment; the rest shape is the initial shape.
//
// Clamps: `segment` holds the whole first segment (free length L - L/N); `wall` adds a static segment of zero length at
// the first end and a first joint of half length, an exact clamp; `free` holds nothing.
// Throws SceneError when a scene cannot be built (bounds are in the message).
#pragma once

#include <optional>
#include <variant>

#include "solver/scene.hpp"
#include "solver/types.hpp"

namespace rodsweep {

enum class Clamp { segment, wall, free };

/// What the two scenes share. SI units.
struct RodParameters {
  int segments = 30;
  double radius_m = 0.05;
  double density_kg_m3 = 1000;
  double youngs_modulus_pa = 1e5;
  double torsion_modulus_pa = 1e6;
  Clamp clamp = Clamp::segment;
  Vector3 gravity_m_s2{0, -9.81, 0};
  double damping_per_s = 0;
  Vector3 tip_force_n{0, 0, 0};
  /// Compliance of the three stretch-shear rows [1/J]; empty: "inextensible", see inextensible_compliance().
  std::optional<double> stretch_compliance_per_j;
};

struct BendingRod : RodParameters {
  double length_m = 2;
  double initial_angle_deg = 0;
};

struct Helix : RodParameters {
  double helix_radius_m = 0.5;
  double helix_height_m = 0.5;
  double windings = 2.5;
};

using SceneSpec = std::variant<BendingRod, Helix>;

Scene build_scene(const SceneSpec& spec);

/// Number of segments (graph nodes) and joints of the scene without building it: what a plan needs.
int segment_count(const SceneSpec& spec);

}  // namespace rodsweep
