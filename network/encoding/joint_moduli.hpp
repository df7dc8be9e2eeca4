// The elastic moduli of a joint from its compliance, for features.
#pragma once

#include "solver/rod/rod.hpp"

namespace rodsweep {

/// Young's and torsion modulus [Pa] behind the bend-twist compliance (l / EI, l / GJ), at most 1e15.
Eigen::Vector2d joint_moduli(const Rod& rod, const Joint& joint);

}  // namespace rodsweep
