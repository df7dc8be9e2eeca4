// The shortest ways along a rod from joint to joint (Dijkstra 1959), over its segments: from a joint's point on a segment
// straight to another's.
#pragma once

#include <functional>
#include <limits>
#include <queue>
#include <tuple>
#include <vector>

#include "solver/rod/rod.hpp"

namespace rodsweep {

class JointWays {
 public:
  /// A joint of a segment, and its arm there.
  struct Meeting {
    int joint;
    Vector3 arm;
  };
  struct Way {
    double length_m = std::numeric_limits<double>::infinity();
    int joints = 0;  ///< with the first and the last one
  };

  /// `rod` must outlive it.
  explicit JointWays(const Rod& rod) : rod_(rod), joints_of_(rod.segments.size()), ways_(rod.joints.size()) {
    for (int k = 0; k < rod.joint_count(); ++k) {
      const Joint& joint = rod.joints[at(k)];
      joints_of_[at(joint.a)].push_back({k, joint.arm_a});
      joints_of_[at(joint.b)].push_back({k, joint.arm_b});
    }
  }

  const std::vector<Meeting>& joints_of(int segment) const { return joints_of_[at(segment)]; }

  /// Calls visit(joint, way) for these joints and all with a way from them below `most_m`, the nearest first. Ways lead
  /// over segments with passes(segment).
  template <class Passes, class Visit>
  void from(const std::vector<Meeting>& starts, double most_m, const Passes& passes, const Visit& visit) {
    using Next = std::tuple<double, int, int>;  // length, joints, joint
    std::priority_queue<Next, std::vector<Next>, std::greater<>> next;
    const auto reach = [&](int k, double length_m, int joints) {
      Way& way = ways_[at(k)];
      if (!(length_m < way.length_m)) return;
      if (way.joints == 0) reached_.push_back(k);
      way = {length_m, joints};
      next.emplace(length_m, joints, k);
    };
    for (const Meeting& start : starts) reach(start.joint, 0, 1);
    while (!next.empty()) {
      const auto [length_m, joints, k] = next.top();
      next.pop();
      const Way way = ways_[at(k)];
      if (length_m > way.length_m) continue;
      visit(k, way);
      const Joint& joint = rod_.joints[at(k)];
      for (const auto& [segment, arm] : {std::pair(joint.a, joint.arm_a), std::pair(joint.b, joint.arm_b)}) {
        if (!passes(segment)) continue;
        for (const Meeting& at : joints_of(segment))
          if (const double there = way.length_m + (at.arm - arm).norm(); there < most_m)
            reach(at.joint, there, way.joints + 1);
      }
    }
    for (const int k : reached_) ways_[at(k)] = {};
    reached_.clear();
  }

 private:
  const Rod& rod_;
  std::vector<std::vector<Meeting>> joints_of_;
  std::vector<Way> ways_;     ///< of the search in progress
  std::vector<int> reached_;  ///< by it
};

}  // namespace rodsweep
