#include "solver/numbers/rotation.hpp"

namespace rodsweep {

Quaternion turn_between(const Vector3& from, const Vector3& to) { return Quaternion::FromTwoVectors(from, to); }

}  // namespace rodsweep
