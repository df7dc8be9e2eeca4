#include "solver/linear/constraint_product.hpp"

#include <algorithm>
#include <cstring>

#include "solver/numbers/lane_records.hpp"
#include "solver/rod/joint_kernels.hpp"

namespace rodsweep {
namespace {

constexpr int W = lane_width;

/// Swaps the off-diagonal halves of every square of 2 s registers and lanes.
template <int s, int... lane>
inline void swap_halves(Lane& low, Lane& high, std::integer_sequence<int, lane...>) {
  const Lane a = low, b = high;
  low = __builtin_shufflevector(a, b, (lane & s ? W + lane - s : lane)...);
  high = __builtin_shufflevector(a, b, (lane & s ? W + lane : lane + s)...);
}

template <int s>
inline void transpose(Lane (&v)[W]) {
  if constexpr (s < W) {
#pragma GCC unroll 8
    for (int i = 0; i < W; ++i)
      if (!(i & s)) swap_halves<s>(v[i], v[i + s], lane_records::Indices());
    transpose<2 * s>(v);
  }
}

/// Six numbers of every joint of a group, and two that are not used.
struct Sextuples {
  Lane lanes[8];

  Triple<Lane> first() const { return {lanes[0], lanes[1], lanes[2]}; }
  Triple<Lane> second() const { return {lanes[3], lanes[4], lanes[5]}; }
};

inline Sextuples joined(const Triple<Lane>& a, const Triple<Lane>& b) {
  return {{a.x, a.y, a.z, b.x, b.y, b.z, Lane{}, Lane{}}};
}

/// From the records of W joints.
template <class RecordOf>
inline Sextuples gathered(const RecordOf& record_of) {
  Sextuples out;
#pragma GCC unroll 4
  for (int p = 0; p < slices; ++p) {
    Lane v[W];
#pragma GCC unroll 8
    for (int i = 0; i < W; ++i) v[i] = slice_of(record_of(i), p);
    transpose<1>(v);
#pragma GCC unroll 8
    for (int i = 0; i < W; ++i) out.lanes[p * W + i] = v[i];
  }
  return out;
}

inline void spread(const Sextuples& from, Lane8 (&records)[W]) {
#pragma GCC unroll 4
  for (int p = 0; p < slices; ++p) {
    Lane v[W];
#pragma GCC unroll 8
    for (int i = 0; i < W; ++i) v[i] = from.lanes[p * W + i];
    transpose<1>(v);
#pragma GCC unroll 8
    for (int i = 0; i < W; ++i) set_slice(records[i], p, v[i]);
  }
}

/// Reads two more doubles than six.
inline Lane8 load8(const double* from) {
  Lane8 out;
  std::memcpy(&out, from, sizeof out);
  return out;
}

}  // namespace

ConstraintProduct::ConstraintProduct(const Rod& rod)
    : mobility_(rod.segments.size()), softness_(6 * rod.joint_count()), at_(rod.segments.size()) {
  const Linearization shaped(rod);
  for (const JointShape<Lane>& shape : shaped.shapes) groups_.push_back({JointTurn<Lane>(), shape});
  kinks_ = shaped.kinks;
  for (const Joint& joint : rod.joints) ends_.push_back({joint.a, joint.b});
}

void ConstraintProduct::update(const Rod& rod, const Linearization& linearization, double inverse_dt2) {
  for (std::size_t g = 0; g < groups_.size(); ++g) groups_[g].turn = linearization.turns[g];
  for (std::size_t s = 0; s < mobility_.size(); ++s) mobility_[s] = motion(rod.segments[s], broadcast(1));
  for (std::size_t k = 0; k < rod.joints.size(); ++k)
    softness_.segment<6>(static_cast<Eigen::Index>(6 * k)) = rod.softness(k, inverse_dt2);
}

void ConstraintProduct::multiply(const double* x, double* y) const {
  find_impulses(x);
  for (std::size_t s = 0; s < at_.size(); ++s) at_[s] *= mobility_[s];
  find_changes(x, y);
}

void ConstraintProduct::find_impulses(const double* x) const {
  std::fill(at_.begin(), at_.end(), Lane8{});
  const int count = static_cast<int>(ends_.size());
  for (int first = 0; first < count; first += W) {
    const Group& group = groups_[at(first / W)];
    const double* const from = x + 6 * first;
    const int here = std::min(W, count - first);
    const Sextuples multipliers = first + W < count
                                      ? gathered([&](int i) { return load8(from + 6 * i); })
                                      : gathered([&](int i) { return i < here ? load6(from + 6 * i) : Lane8{}; });
    const Triples<Lane> half = half_turn(group.turn);
    const auto [a, b] = impulses(group.turn, half, group.shape, multipliers.first(), multipliers.second());
    Lane8 on_a[W], on_b[W];
    spread(joined(a.force, a.torque), on_a);
    spread(joined(b.force, b.torque), on_b);
    const Ends* const ends = ends_.data() + first;
    for (int i = 0; i < here; ++i) {
      at_[at(ends[i].a)] += on_a[i];
      at_[at(ends[i].b)] += on_b[i];
    }
  }
}

void ConstraintProduct::find_changes(const double* x, double* y) const {
  const int count = static_cast<int>(ends_.size());
  for (int first = 0; first < count; first += W) {
    const Group& group = groups_[at(first / W)];
    const Ends* const ends = ends_.data() + first;
    const int here = std::min(W, count - first);
    const auto of = [&](int segment) { return at_[at(segment)]; };
    const Sextuples a = gathered([&](int i) { return of(ends[std::min(i, here - 1)].a); });
    const Sextuples b = gathered([&](int i) { return of(ends[std::min(i, here - 1)].b); });
    const Triples<Lane> half = half_turn(group.turn);
    const JointShape<Lane>& shape = group.shape;
    const Triple<Lane> shift_a = shape.inverse_length * a.first() - cross(shape.arm_a, a.second());
    const Triple<Lane> shift_b = shape.inverse_length * b.first() - cross(shape.arm_b, b.second());
    const Triple<Lane> stretch = transposed_product(half, from_a(shape, shift_a)) - half * from_b(shape, shift_b);
    const Triple<Lane> bend = bend_change(group.turn, shape, a.second(), b.second());
    Lane8 changes[W];
    spread(joined(stretch, bend), changes);
    const double* const softness = softness_.data() + 6 * first;
    const double* const from = x + 6 * first;
    for (int i = 0; i < here; ++i)
      store6(y + 6 * (first + i), changes[i] + load6(softness + 6 * i) * load6(from + 6 * i));
  }
}

}  // namespace rodsweep
