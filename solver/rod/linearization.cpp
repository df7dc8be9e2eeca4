#include "solver/rod/linearization.hpp"

#include <algorithm>
#include <array>

#include "solver/numbers/lane_records.hpp"
#include "solver/numbers/lanes.hpp"

namespace rodsweep {
namespace {

/// A Jacobian by columns of its parts, for any number type.
template <class T>
struct JacobianParts {
  Triple<T> shift_a[3], shift_b[3];    // of dC_s/du
  Triple<T> across_a[3], across_b[3];  // of dC_s/dphi
  Triple<T> bend_a[3], bend_b[3];      // of dC_b/dphi
};

/// The columns of -M [v]x.
template <class T>
inline void product_with_cross(const Triple<T> (&m)[3], const Triple<T>& v, Triple<T> (&column)[3]) {
  column[0] = v.y * m[2] - v.z * m[1];
  column[1] = v.z * m[0] - v.x * m[2];
  column[2] = v.x * m[1] - v.y * m[0];
}

/// The columns of [v]x + w I.
template <class T>
inline void put_bend(const Quad<T>& e, const T& w, Triple<T> (&column)[3]) {
  column[0] = {w, e.z, -e.y};
  column[1] = {-e.z, w, e.x};
  column[2] = {e.y, -e.x, w};
}

/// Multiplies a matrix, by its columns, with P^T.
template <class T>
inline void turn_columns(const Triples<T>& p, Triple<T> (&column)[3]) {
  const Triple<T> x = column[0], y = column[1], z = column[2];
  column[0] = p.x.x * x + p.y.x * y + p.z.x * z;
  column[1] = p.x.y * x + p.y.y * y + p.z.y * z;
  column[2] = p.x.z * x + p.y.z * y + p.z.z * z;
}

template <class T>
inline JacobianParts<T> parts_of(const JointTurn<T>& turn, const Triples<T>& half, const JointShape<T>& shape) {
  JacobianParts<T> out;
  Triple<T> of_b[3] = {half.x, half.y, half.z};  // H P_b^T, and H^T P_a^T
  Triple<T> of_a[3] = {{half.x.x, half.y.x, half.z.x}, {half.x.y, half.y.y, half.z.y}, {half.x.z, half.y.z, half.z.z}};
  put_bend(turn.e, -turn.e.w, out.bend_a);
  put_bend(turn.e, turn.e.w, out.bend_b);
  if (shape.kink) {
    turn_columns(shape.kink->axes_a, of_a);
    turn_columns(shape.kink->axes_a, out.bend_a);
    turn_columns(shape.kink->axes_b, of_b);
    turn_columns(shape.kink->axes_b, out.bend_b);
  }
  const T minus = -shape.inverse_length;
  for (int c = 0; c < 3; ++c) {
    out.shift_a[c] = shape.inverse_length * of_a[c];
    out.shift_b[c] = minus * of_b[c];
  }
  product_with_cross(of_a, shape.arm_a, out.across_a);
  product_with_cross(of_b, -shape.arm_b, out.across_b);
  return out;
}

inline void write(const Triple<double> (&column)[3], Lane4 (&to)[3]) {
  for (int c = 0; c < 3; ++c) to[c] = Lane4{column[c].x, column[c].y, column[c].z, 0};
}
inline void write(const Triple<double> (&upper)[3], const Triple<double> (&lower)[3], Lane8 (&to)[3]) {
  for (int c = 0; c < 3; ++c)
    to[c] = Lane8{upper[c].x, upper[c].y, upper[c].z, lower[c].x, lower[c].y, lower[c].z, 0, 0};
}

constexpr std::ptrdiff_t stride = sizeof(JointJacobian) / sizeof(double);

/// Writes as many joints as there are lanes; `to` belongs to the first.
inline void write(const LaneVector (&column)[3], Lane4 (&to)[3]) {
  for (int c = 0; c < 3; ++c)
    scatter({column[c].x, column[c].y, column[c].z, Lane{}}, reinterpret_cast<double*>(&to[c]), stride);
}
inline void write(const LaneVector (&upper)[3], const LaneVector (&lower)[3], Lane8 (&to)[3]) {
  for (int c = 0; c < 3; ++c) {
    double* column = reinterpret_cast<double*>(&to[c]);
    scatter({upper[c].x, upper[c].y, upper[c].z, lower[c].x}, column, stride);
    scatter({lower[c].y, lower[c].z, Lane{}, Lane{}}, column + 4, stride);
  }
}

template <class T>
inline void write(const JacobianParts<T>& parts, JointJacobian& to) {
  write(parts.across_a, parts.bend_a, to.rotation_a);
  write(parts.across_b, parts.bend_b, to.rotation_b);
  write(parts.shift_a, to.shift_a);
  write(parts.shift_b, to.shift_b);
}

inline Triple<double> numbers(const Vector3& v) { return {v.x(), v.y(), v.z()}; }
inline Quad<double> numbers(const Quaternion& q) { return {q.w(), q.x(), q.y(), q.z()}; }

inline const Quaternion& orientation_of_a(const Rod& rod, const Joint& joint) { return rod.orientation[at(joint.a)]; }
inline const Quaternion& orientation_of_b(const Rod& rod, const Joint& joint) { return rod.orientation[at(joint.b)]; }
inline Vector3 apart(const Rod& rod, const Joint& joint) {
  return rod.position[at(joint.a)] - rod.position[at(joint.b)];
}

struct SingleShape : JointShape<double> {
  explicit SingleShape(const Joint& joint)
      : JointShape<double>{numbers(joint.arm_a / joint.length), numbers(joint.arm_b / joint.length), 1 / joint.length,
                           nullptr} {
    if (!joint.is_kinked()) return;
    own = {numbers(joint.frame_a), numbers(joint.frame_b), {}, {}};
    own.set_axes();
    kink = &own;
  }
  SingleShape(const SingleShape&) = delete;
  SingleShape& operator=(const SingleShape&) = delete;

  JointKink<double> own;
};

JointTurn<double> turn_of(const Rod& rod, const Joint& joint, const JointShape<double>& shape) {
  return joint_turn(numbers(orientation_of_a(rod, joint)), numbers(orientation_of_b(rod, joint)), shape);
}

/// The constants of as many joints as a register has lanes. If any of them is not straight, `kinks` gets its frames.
JointShape<Lane> joint_shape(const std::array<const Joint*, lane_width>& of, JointKinks& kinks) {
  bool kinked = false;
  Quaternion frame_a[lane_width], frame_b[lane_width];
  Vector3 arm_a[lane_width], arm_b[lane_width];
  JointShape<Lane> shape{};
  for (std::size_t lane = 0; lane < lane_width; ++lane) {
    const Joint& joint = *of[lane];
    kinked |= joint.is_kinked();
    frame_a[lane] = joint.frame_a;
    frame_b[lane] = joint.frame_b;
    arm_a[lane] = joint.arm_a / joint.length;
    arm_b[lane] = joint.arm_b / joint.length;
    shape.inverse_length[lane] = 1 / joint.length;
  }
  shape.arm_a = load(arm_a, lane_width);
  shape.arm_b = load(arm_b, lane_width);
  if (kinked) {
    auto kink = std::make_shared<JointKink<Lane>>();
    kink->frame_a = load(frame_a, lane_width);
    kink->frame_b = load(frame_b, lane_width);
    kink->set_axes();
    shape.kink = kink.get();
    kinks.push_back(std::move(kink));
  }
  return shape;
}

}  // namespace

Linearization::Linearization(const Rod& rod) : constraint(VectorX::Zero(6 * rod.joint_count())) {
  const std::size_t count = rod.joints.size();
  const std::size_t groups = (count + lane_width - 1) / lane_width;
  shapes.reserve(groups);
  joints.reserve(groups * lane_width);
  for (std::size_t first = 0; first < count; first += lane_width) {
    std::array<const Joint*, lane_width> group{};
    for (std::size_t lane = 0; lane < lane_width; ++lane) {
      group[lane] = &rod.joints[std::min(first + lane, count - 1)];
      JointJacobian& jacobian = joints.emplace_back();
      jacobian.inverse_length = 1 / group[lane]->length;
      jacobian.straight = !group[lane]->is_kinked();
    }
    shapes.push_back(joint_shape(group, kinks));
    turns.emplace_back();
  }
}

TurnFromRest turn_from_rest(const Rod& rod, const Joint& joint) {
  const Quad<double> e = turn_of(rod, joint, SingleShape(joint)).e;
  return {Quaternion(e.w, e.x, e.y, e.z), orientation_of_a(rod, joint) * joint.frame_a};
}

Vector3 to_world(const Rod& rod, const Joint& joint, const Vector3& in_joint_frame) {
  const SingleShape shape(joint);
  const Triple<double> own = to_a(shape, half_turn(turn_of(rod, joint, shape)) * numbers(in_joint_frame));
  return orientation_of_a(rod, joint) * Vector3(own.x, own.y, own.z);
}

Vector3 from_world(const Rod& rod, const Joint& joint, const Vector3& in_world) {
  const SingleShape shape(joint);
  const Vector3 own = orientation_of_a(rod, joint).conjugate() * in_world;
  const Triple<double> out = transposed_product(half_turn(turn_of(rod, joint, shape)), from_a(shape, numbers(own)));
  return {out.x, out.y, out.z};
}

void linearize(const Rod& rod, const Joint& joint, JointJacobian& jacobian, double* constraint) {
  const SingleShape shape(joint);
  const JointTurn<double> turn = turn_of(rod, joint, shape);
  const Triples<double> half = half_turn(turn);
  const Triple<double> gap =
      stretch(half, numbers(orientation_of_a(rod, joint)), numbers(shape.inverse_length * apart(rod, joint)), shape);
  const Triple<double> bent = bend(turn);
  int row = 0;
  for (const double value : {gap.x, gap.y, gap.z, bent.x, bent.y, bent.z}) constraint[row++] = value;
  write(parts_of(turn, half, shape), jacobian);
  jacobian.inverse_length = shape.inverse_length;
  jacobian.straight = !shape.kink;
}

void linearize(const Rod& rod, Linearization& out) {
  const std::size_t count = rod.joints.size();
  std::size_t first = 0;
  for (const JointShape<Lane>& shape : out.shapes) {
    const std::size_t here = std::min<std::size_t>(lane_width, count - first);
    Quaternion of_a[lane_width], of_b[lane_width];
    Vector3 gaps[lane_width];
    for (std::size_t lane = 0; lane < lane_width; ++lane) {
      const Joint& joint = rod.joints[first + std::min(lane, here - 1)];
      of_a[lane] = orientation_of_a(rod, joint);
      of_b[lane] = orientation_of_b(rod, joint);
      gaps[lane] = apart(rod, joint);
    }
    const LaneQuaternion a = load(of_a, lane_width);
    const JointTurn<Lane> turn = joint_turn(a, load(of_b, lane_width), shape);
    out.turns[first / lane_width] = turn;
    const LaneMatrix half = half_turn(turn);
    const LaneVector gap = stretch(half, a, shape.inverse_length * load(gaps, lane_width), shape);
    const LaneVector bent = bend(turn);
    const Lane constraint[6] = {gap.x, gap.y, gap.z, bent.x, bent.y, bent.z};
    double* of_joint = out.constraint.data() + 6 * first;
    for (std::size_t lane = 0; lane < here; ++lane)
      for (const Lane& row : constraint) *of_joint++ = entry(row, static_cast<int>(lane));
    write(parts_of(turn, half, shape), out.joints[first]);
    first += lane_width;
  }
}

}  // namespace rodsweep
