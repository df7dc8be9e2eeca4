// A turn about gravity and a shift: what a rod's motion knows nothing of, and encodings that say where a rod is do.
#pragma once

#include "solver/numbers/split_mix.hpp"
#include "solver/rod/rod.hpp"

namespace rodsweep {

struct Turn {
  Quaternion rotation = Quaternion::Identity();
  Vector3 shift = Vector3::Zero();
};

/// By any angle about gravity, about anything where there is none; as far as `reach` [m] along every axis.
Turn random_turn(const Vector3& gravity_m_s2, double reach_m, SplitMix& random);

/// The rod turned about the origin, then shifted; with its velocities.
Rod turned(const Rod& rod, const Turn& turn);

}  // namespace rodsweep
