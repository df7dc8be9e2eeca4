// A rod's constants in flat arrays, for files and plug-ins.
#pragma once

#include <cstdint>
#include <vector>

#include "solver/rod/rod.hpp"

namespace rodsweep {

struct RodArrays {
  std::vector<std::int32_t> joint_segments;         ///< [joints, 2]
  std::vector<double> compliance;                   ///< [joints, 6] [1/J]
  std::vector<double> length_m, radius_m, mass_kg;  ///< [segments]

  RodArrays() = default;
  explicit RodArrays(const Rod& rod) {
    for (const Joint& joint : rod.joints) {
      joint_segments.insert(joint_segments.end(), {joint.a, joint.b});
      compliance.insert(compliance.end(), joint.compliance.begin(), joint.compliance.end());
    }
    for (const Segment& segment : rod.segments) {
      length_m.push_back(segment.length_m);
      radius_m.push_back(segment.radius_m);
      mass_kg.push_back(segment.mass);
    }
  }
};

}  // namespace rodsweep
