// A rod's constants and its state in flat arrays, for files and plug-ins.
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

// Copies vectors (x, y, z) and quaternions (w, x, y, z) of a rod's state to and from rows, one per segment, bit by bit.

inline void store(const std::vector<Vector3>& vectors, double* rows) {
  for (const Vector3& v : vectors) {
    Vector3::Map(rows) = v;
    rows += 3;
  }
}

inline void store(const std::vector<Quaternion>& quaternions, double* rows) {
  for (const Quaternion& q : quaternions) {
    rows[0] = q.w(), rows[1] = q.x(), rows[2] = q.y(), rows[3] = q.z();
    rows += 4;
  }
}

inline void load(const double* rows, std::size_t count, std::vector<Vector3>& vectors) {
  vectors.resize(count);
  for (Vector3& v : vectors) {
    v = Vector3::Map(rows);
    rows += 3;
  }
}

inline void load(const double* rows, std::size_t count, std::vector<Quaternion>& quaternions) {
  quaternions.resize(count);
  for (Quaternion& q : quaternions) {
    q = Quaternion(rows[0], rows[1], rows[2], rows[3]);
    rows += 4;
  }
}

}  // namespace rodsweep
