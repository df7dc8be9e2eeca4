#include "solver/rod/momentum_balance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solver/numbers/lane_records.hpp"
#include "solver/rod/joint_kernels.hpp"

namespace rodsweep {
namespace {

constexpr double slightest = 1e-6;  ///< of a segment's length: smaller motions do not count as loads

/// |force|^2 in lane 0 and |torque|^2 over a squared length in lane 3; the other lanes are not larger.
Lane8 squared_sizes(const Lane8& wrench, double inverse_squared_length) {
  const double i = inverse_squared_length;
  const Lane8 squares = wrench * wrench * Lane8{1, 1, 1, i, i, i, 0, 0};
  return squares + __builtin_shufflevector(squares, squares, 1, 6, 6, 4, 6, 6, 6, 6) +
         __builtin_shufflevector(squares, squares, 2, 6, 6, 5, 6, 6, 6, 6);
}

Lane8 larger_of(const Lane8& a, const Lane8& b) { return a < b ? b : a; }
double largest(const Lane8& squared_sizes) { return std::sqrt(std::max(squared_sizes[0], squared_sizes[3])); }

/// M (p - p*) of all segments.
void put_inertial_impulses(const Rod& rod, MomentumBalance& out) {
  constexpr std::ptrdiff_t stride = sizeof(Lane8) / sizeof(double);
  std::size_t s = 0;
  for (const LaneInertia& inertia : out.inertia) {
    const int count = rod.segment_count() - static_cast<int>(s);
    const LaneQuaternion orientation = load(&rod.orientation[s], count);
    const LaneVector moved = load(&rod.position[s], count) - load(&rod.free_position[s], count);
    const LaneVector force = conjugate(orientation) * (inertia.mass * moved);
    const LaneQuaternion d = relative(load(&rod.free_orientation[s], count), orientation);
    const Lane scale = 2 / d.w, across = inertia.transverse * scale;
    const LaneVector torque = {across * d.x, across * d.y, inertia.axial * scale * d.z};
    double* defect = reinterpret_cast<double*>(&out.defect[s]);
    scatter({force.x, force.y, force.z, torque.x}, defect, stride);
    scatter({torque.y, torque.z, Lane{}, Lane{}}, defect + 4, stride);
    s += lane_width;
  }
}

void subtract_outer_impulses(const Rod& rod, MomentumBalance& out) {
  if (!rod.has_outer_impulses()) return;
  for (std::size_t s = 0; s < rod.segments.size(); ++s) {
    const Vector6 outer = rod.outer_impulse(s);
    const Vector3 force = rod.orientation[s].conjugate() * Vector3(outer.head<3>());
    const Vector3 torque = rod.orientation[s].conjugate() * Vector3(outer.tail<3>());
    out.defect[s] -= Lane8{force.x(), force.y(), force.z(), torque.x(), torque.y(), torque.z(), 0, 0};
  }
}

/// Subtracts the joints' impulses. Returns the largest.
double subtract_joints(const Rod& rod, const Linearization& at, MomentumBalance& out) {
  std::fill(out.pull.begin(), out.pull.end(), Lane4{});
  Lane8 carried{};
  for (std::size_t k = 0; k < rod.joints.size(); ++k) {
    const Joint& joint = rod.joints[k];
    const auto a = static_cast<std::size_t>(joint.a), b = static_cast<std::size_t>(joint.b);
    Lane8 on_a, on_b;
    impulses(at.joints[k], load6(rod.lambda.data() + 6 * k), on_a, on_b);
    out.defect[a] -= on_a;
    out.defect[b] -= on_b;
    const Lane4 force_a = __builtin_shufflevector(on_a, on_a, 0, 1, 2, 6);
    const Lane4 force_b = __builtin_shufflevector(on_b, on_b, 0, 1, 2, 6);
    out.pull[a] += force_a * Lane4{joint.arm_a.x(), joint.arm_a.y(), joint.arm_a.z(), 0};
    out.pull[b] += force_b * Lane4{joint.arm_b.x(), joint.arm_b.y(), joint.arm_b.z(), 0};
    const double scale = at.joints[k].inverse_length * at.joints[k].inverse_length;
    carried = larger_of(carried, larger_of(squared_sizes(on_a, scale), squared_sizes(on_b, scale)));
  }
  return largest(carried);
}

/// M + K across the axis of a segment; `pull` is the sum of f.r over its joints.
double stiffened(double inertia, double pull) {
  constexpr double least_turning = 0.5;  // share of the inertia that remains under compression
  return inertia + std::max(pull, (least_turning - 1) * inertia);
}

}  // namespace

MomentumBalance::MomentumBalance(const Rod& rod) : pull(rod.segments.size()), least(0) {
  const std::size_t count = rod.segments.size();
  for (std::size_t first = 0; first < count; first += lane_width) {
    LaneInertia& group = inertia.emplace_back();
    for (std::size_t lane = 0; lane < lane_width; ++lane) {
      const Segment& segment = rod.segments[std::min(first + lane, count - 1)];
      group.mass[lane] = segment.mass;
      group.transverse[lane] = segment.inertia_transverse;
      group.axial[lane] = segment.inertia_axial;
    }
  }
  defect.resize(inertia.size() * lane_width);
  for (const Segment& segment : rod.segments) {
    inverse_squared_length.push_back(segment.is_static ? 0 : 1 / (segment.length_m * segment.length_m));
    if (!segment.is_static) least = std::max(least, slightest * segment.mass * segment.length_m);
  }
}

void balance_momentum(const Rod& rod, const Linearization& at, MomentumBalance& out) {
  put_inertial_impulses(rod, out);
  subtract_outer_impulses(rod, out);
  const double greatest = subtract_joints(rod, at, out);
  Lane8 lacking{}, sum{};
  for (std::size_t s = 0; s < rod.segments.size(); ++s) {
    Lane8& defect = out.defect[s];
    if (rod.segments[s].is_static) defect = Lane8{};
    lacking = larger_of(lacking, squared_sizes(defect, out.inverse_squared_length[s]));
    sum += defect;
  }
  if (rod.joints.empty()) {
    out.residual = 0;
    return;
  }
  const bool finite = std::isfinite(sum[0] + sum[1] + sum[2] + sum[3] + sum[4] + sum[5]);
  out.residual = finite ? largest(lacking) / std::max(greatest, out.least) : std::numeric_limits<double>::quiet_NaN();
}

void stiffen(Rod& rod, const MomentumBalance& balance) {
  for (std::size_t s = 0; s < rod.segments.size(); ++s) {
    Segment& segment = rod.segments[s];
    if (segment.is_static) continue;
    const Lane4& pull = balance.pull[s];
    segment.turn_mobility = 1 / stiffened(segment.inertia_transverse, pull[0] + pull[1] + pull[2]);
  }
}

void unstiffen(Rod& rod) {
  for (Segment& segment : rod.segments) segment.turn_mobility = segment.inverse_inertia_transverse;
}

}  // namespace rodsweep
