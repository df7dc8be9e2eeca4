#include "solver/contact/rod_response.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "solver/rod/joint_kernels.hpp"

namespace rodsweep {
namespace {

constexpr double stale = 0.1;  ///< [rad]

/// The columns of a rotation, twice.
void store_columns(const Matrix3& rotation, Lane8 (&out)[3]) {
  for (int c = 0; c < 3; ++c) {
    const Vector3 v = rotation.col(c);
    out[c] = Lane8{v.x(), v.y(), v.z(), v.x(), v.y(), v.z(), 0, 0};
  }
}

/// Both vectors of a motion, or of a force and a torque, rotated.
Lane8 turned(const Lane8 (&rotation)[3], const Lane8& v) {
  return rotation[0] * __builtin_shufflevector(v, v, 0, 0, 0, 3, 3, 3, 6, 6) +
         rotation[1] * __builtin_shufflevector(v, v, 1, 1, 1, 4, 4, 4, 6, 6) +
         rotation[2] * __builtin_shufflevector(v, v, 2, 2, 2, 5, 5, 5, 6, 6);
}

/// J of one side, six rows by the segment's u and phi.
Eigen::Matrix<double, 6, 6> dense(const JointSide& side) {
  Eigen::Matrix<double, 6, 6> j;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 6; ++r) {
      j(r, c) = r < 3 ? entry(side.shift[c], r) : 0;
      j(r, 3 + c) = entry(side.rotation[c], r);
    }
  return j;
}

Block6 transposed(const Block6& block) {
  Block6 out{};
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c) out.column[r][c] = block.column[c][r];
  return out;
}

}  // namespace

RodResponse::RodResponse(const Rod& rod)
    : system_(rod),
      factor_(rod),
      change_(6 * rod.joint_count()),
      multipliers_(6 * rod.joint_count()),
      own_(rod.segments.size()),
      sides_(joints_by_segment(rod)),
      orientation_(rod.segments.size()),
      turns_(rod.segments.size()) {}

void RodResponse::assemble(const Rod& rod, double dt) {
  multipliers_.setZero();
  loaded_ = -1;
  for (std::size_t s = 0; s < turns_.size(); ++s) {
    orientation_[s] = rod.orientation[s];
    const Matrix3 rotation = orientation_[s].toRotationMatrix();
    store_columns(rotation, turns_[s].to_world);
    store_columns(rotation.transpose(), turns_[s].to_own);
  }
  system_.assemble(rod, dt);
  factor_.factorise(rod, system_);
}

bool RodResponse::is_stale(const Rod& rod) const {
  constexpr double least = 1 - stale * stale / 8;  // cos(stale / 2)
  for (std::size_t s = 0; s < orientation_.size(); ++s)
    if (!(std::abs(orientation_[s].dot(rod.orientation[s])) >= least)) return true;
  return false;
}

Lane8 RodResponse::free_motion(const Rod& rod, int segment, const Lane8& wrench) const {
  const auto s = at(segment);
  return turned(turns_[s].to_world, motion(rod.segments[s], turned(turns_[s].to_own, wrench)));
}

void RodResponse::respond(const Rod& rod, Lane8* motion) {
  const Linearization& linearization = system_.linearization();
  for (std::size_t s = 0; s < own_.size(); ++s) own_[s] = turned(turns_[s].to_own, motion[s]);
  for (std::size_t k = 0; k < rod.joints.size(); ++k) {
    const Joint& joint = rod.joints[k];
    store6(change_.data() + 6 * k, constraint_change(linearization.joints[k], own_[at(joint.a)], own_[at(joint.b)]));
  }
  factor_.substitute(change_);
  multipliers_ -= change_;
  system_.displacements(rod, change_, taken_back_);
  for (std::size_t s = 0; s < own_.size(); ++s) motion[s] -= turned(turns_[s].to_world, taken_back_[s]);
}

void RodResponse::load(const Rod& rod, int segment) {
  loaded_ = segment;
  const auto s = at(segment);
  const Matrix3 turn = orientation_[s].toRotationMatrix();
  if (CondensedFactor* factor = factor_.condensed_factor()) {
    Lane8 force[6]{};  // R^T
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) force[r][c] = force[3 + r][3 + c] = turn(c, r);
    return factor->load(segment, force);
  }
  columns_.assign(6 * rod.joints.size(), Lane8{});
  Eigen::Matrix<double, 6, 6> free;  // M^-1 R^T
  for (int c = 0; c < 6; ++c) {
    const Lane8 column = motion(rod.segments[s], turned(turns_[s].to_own, unit_lane[c]));
    for (int r = 0; r < 6; ++r) free(r, c) = column[r];
  }
  for (const JointEnd& side : sides_[s]) {
    const Eigen::Matrix<double, 6, 6> block = dense({system_.linearization().joints[at(side.joint)], side.is_b}) * free;
    for (int r = 0; r < 6; ++r)
      for (int c = 0; c < 6; ++c) columns_[at(6 * side.joint + r)][c] += block(r, c);
  }
  factor_.whole_factor()->substitute(columns_);
}

Block6 RodResponse::compliance(const Rod& rod, int of) {
  const auto s = at(of);
  const Segment& segment = rod.segments[s];
  const Matrix3 turn = orientation_[s].toRotationMatrix();
  Lane8 row[6]{};  // of H R^T
  if (CondensedFactor* factor = factor_.condensed_factor()) {
    factor->motion_of(of, row);
  } else {
    for (const JointEnd& side : sides_[s]) {
      const JointSide jacobian(system_.linearization().joints[at(side.joint)], side.is_b);
      const Lane8* const x = columns_.data() + 6 * static_cast<std::ptrdiff_t>(side.joint);
      for (int j = 0; j < 3; ++j) {
        for (int r = 0; r < 3; ++r) row[j] -= entry(jacobian.shift[j], r) * x[r];
        for (int r = 0; r < 6; ++r) row[3 + j] -= entry(jacobian.rotation[j], r) * x[r];
      }
    }
    const double inverse[6] = {segment.inverse_mass,  segment.inverse_mass,  segment.inverse_mass,
                               segment.turn_mobility, segment.turn_mobility, segment.inverse_inertia_axial};
    for (int r = 0; r < 6; ++r) {
      row[r] *= inverse[r];
      if (of == loaded_)
        for (int c = 0; c < 3; ++c) row[r][r < 3 ? c : 3 + c] += inverse[r] * turn(c, r % 3);
    }
  }
  Block6 out{};
  for (int half = 0; half < 2; ++half)
    for (int r = 0; r < 3; ++r) {
      Lane8 sum{};
      for (int k = 0; k < 3; ++k) sum += turn(r, k) * row[3 * half + k];
      for (int c = 0; c < 6; ++c) out.column[c][3 * half + r] = sum[c];
    }
  return out;
}

void DelassusOperator::clear() {
  for (const int segment : touched_) place_[at(segment)] = -1;
  touched_.clear();
  known_ = 0;
  is_full_ = false;
}

void DelassusOperator::touch(int segment) {
  if (place_[at(segment)] >= 0) return;
  if (touched_.size() == most_touched_) {
    is_full_ = true;
    return;
  }
  place_[at(segment)] = static_cast<int>(touched_.size());
  touched_.push_back(segment);
}

void DelassusOperator::grow() {
  if (touched_.size() <= stride_) return;
  const std::size_t stride = std::max(touched_.size(), stride_ + stride_ / 2);
  grown_.resize(stride * stride);
  for (std::size_t by = 0; by < known_; ++by)
    std::copy_n(blocks_.data() + by * stride_, known_, grown_.data() + by * stride);
  std::swap(blocks_, grown_);
  stride_ = stride;
}

void DelassusOperator::update(const Rod& rod, RodResponse& response) {
  if (is_full_) return;
  grow();
  for (std::size_t by = known_; by < touched_.size(); ++by) {
    response.load(rod, touched_[by]);
    for (std::size_t of = 0; of < touched_.size(); ++of) {
      blocks_[by * stride_ + of] = response.compliance(rod, touched_[of]);
      if (of < known_) blocks_[of * stride_ + by] = transposed(blocks_[by * stride_ + of]);
    }
  }
  known_ = touched_.size();
}

}  // namespace rodsweep
