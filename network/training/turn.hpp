// A rotation about gravity and a shift. They do not change a rod's motion, but they change some encodings.
#pragma once

#include "solver/numbers/counter_random.hpp"
#include "solver/rod/rod.hpp"

namespace rodsweep {

struct Turn {
  Quaternion rotation = Quaternion::Identity();
  Vector3 shift = Vector3::Zero();
};

/// A random angle about gravity, or about a random axis without gravity; a shift of at most `reach_m` along each axis.
Turn random_turn(const Vector3& gravity_m_s2, double reach_m, SplitMix& random);

/// The rod rotated about the origin, then shifted, with rotated velocities.
Rod turned(const Rod& rod, const Turn& turn);

}  // namespace rodsweep
