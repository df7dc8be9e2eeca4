// Copies vectors (x, y, z) and quaternions (w, x, y, z) of a rod's state to and from rows, one per segment, bit by bit.
#pragma once

#include <vector>

#include "solver/numbers/types.hpp"

namespace rodsweep {

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

inline void load(const double* rows, std::vector<Vector3>& vectors) {
  for (Vector3& v : vectors) {
    v = Vector3::Map(rows);
    rows += 3;
  }
}

inline void load(const double* rows, std::vector<Quaternion>& quaternions) {
  for (Quaternion& q : quaternions) {
    q = Quaternion(rows[0], rows[1], rows[2], rows[3]);
    rows += 4;
  }
}

}  // namespace rodsweep
