#include "solver/rod/momentum_balance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solver/rod/joint_kernels.hpp"

namespace rodsweep {
namespace {

constexpr double slightest = 1e-6;     ///< of a segment's length: joints that move theirs by less carry nothing
constexpr double least_turning = 0.5;  ///< of the inertia that M + K keeps under compression

struct Size {
  double squared_force = 0, squared_torque = 0;  ///< the largest, torques over lengths
};

void enlarge(Size& size, const Lane8& impulse, double inverse_squared_length) {
  const Lane8 squares = impulse * impulse;
  size.squared_force = std::fmax(size.squared_force, squares[0] + squares[1] + squares[2]);
  size.squared_torque = std::fmax(size.squared_torque, (squares[3] + squares[4] + squares[5]) * inverse_squared_length);
}

/// M (p - p*) - f_c.
Lane8 defect_without_joints(const Rod& rod, std::size_t s) {
  const Segment& segment = rod.segments[s];
  const Quaternion& q = rod.orientation[s];
  const Vector6& contact = rod.contact_impulse[s];
  const Quaternion d = rod.free_orientation[s].conjugate() * q;
  const Vector3 principal(segment.inertia_transverse, segment.inertia_transverse, segment.inertia_axial);
  const Vector3 force =
      q.conjugate() * Vector3(segment.mass * (rod.position[s] - rod.free_position[s]) - contact.head<3>());
  const Vector3 torque = (2 / d.w()) * principal.cwiseProduct(d.vec()) - q.conjugate() * Vector3(contact.tail<3>());
  return Lane8{force.x(), force.y(), force.z(), torque.x(), torque.y(), torque.z(), 0, 0};
}

}  // namespace

MomentumBalance::MomentumBalance(const Rod& rod) : defect(rod.segments.size()), tension(rod.segments.size()) {}

void balance_momentum(const Rod& rod, const Linearization& at, MomentumBalance& out) {
  for (std::size_t s = 0; s < rod.segments.size(); ++s) {
    out.tension[s] = 0;
    out.defect[s] = defect_without_joints(rod, s);
  }
  Size carried;
  for (std::size_t k = 0; k < rod.joints.size(); ++k) {
    const Joint& joint = rod.joints[k];
    Lane8 on_a, on_b;
    impulses(at.joints[k], load6(rod.lambda.data() + 6 * k), on_a, on_b);
    const auto a = static_cast<std::size_t>(joint.a), b = static_cast<std::size_t>(joint.b);
    out.defect[a] -= on_a;
    out.defect[b] -= on_b;
    out.tension[a] += on_a[0] * joint.arm_a.x() + on_a[1] * joint.arm_a.y() + on_a[2] * joint.arm_a.z();
    out.tension[b] += on_b[0] * joint.arm_b.x() + on_b[1] * joint.arm_b.y() + on_b[2] * joint.arm_b.z();
    const double inverse_squared_length = 1 / (joint.length * joint.length);
    enlarge(carried, on_a, inverse_squared_length);
    enlarge(carried, on_b, inverse_squared_length);
  }
  if (rod.joints.empty()) {
    out.residual = 0;
    return;
  }

  Size lacking;
  double least = 0, sum = 0;
  for (std::size_t s = 0; s < rod.segments.size(); ++s) {
    const Segment& segment = rod.segments[s];
    if (segment.is_static) {
      out.defect[s] = Lane8{};
      continue;
    }
    enlarge(lacking, out.defect[s], 1 / (segment.length_m * segment.length_m));
    least = std::max(least, slightest * segment.mass * segment.length_m);
    for (int lane = 0; lane < 6; ++lane) sum += out.defect[s][lane];
  }
  const double greatest = std::sqrt(std::max(carried.squared_force, carried.squared_torque));
  out.residual = std::isfinite(sum)
                     ? std::sqrt(std::max(lacking.squared_force, lacking.squared_torque)) / std::max(greatest, least)
                     : std::numeric_limits<double>::quiet_NaN();
}

void stiffen(Rod& rod, const MomentumBalance& balance) {
  for (std::size_t s = 0; s < rod.segments.size(); ++s) {
    Segment& segment = rod.segments[s];
    if (segment.is_static) continue;
    const double inertia = segment.inertia_transverse;
    segment.turn_mobility = 1 / (inertia + std::max(balance.tension[s], (least_turning - 1) * inertia));
  }
}

void unstiffen(Rod& rod) {
  for (Segment& segment : rod.segments) segment.turn_mobility = segment.inverse_inertia_transverse;
}

}  // namespace rodsweep
