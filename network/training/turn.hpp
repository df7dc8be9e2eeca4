// A turn about gravity and a shift, which do not affect the motion of a rod but some encodings.
#pragma once

#include "solver/numbers/split_mix.hpp"
#include "solver/rod/rod.hpp"

namespace rodsweep {

struct Turn {
  Quaternion rotation = Quaternion::Identity();
  Vector3 shift = Vector3::Zero();
};

/// A random angle about gravity, or about a random axis without gravity; a shift of at most `reach` [m] along every axis.
Turn random_turn(const Vector3& gravity_m_s2, double reach_m, SplitMix& random);

/// The rod turned about the origin, then shifted; with its velocities.
Rod turned(const Rod& rod, const Turn& turn);

}  // namespace rodsweep
