#include "network/graph/joint_forest.hpp"

#include <algorithm>
#include <numeric>

namespace rodsweep {
namespace {

/// Sorts joints by depth, keeping their order within a depth, and renumbers the parents.
JointForest sorted(const std::vector<int>& parent, const std::vector<int>& depth, const std::vector<int>& beside) {
  JointForest out;
  out.order.resize(parent.size());
  std::iota(out.order.begin(), out.order.end(), 0);
  const auto at = [](const std::vector<int>& v, int i) { return v[static_cast<std::size_t>(i)]; };
  std::stable_sort(out.order.begin(), out.order.end(), [&](int a, int b) { return at(depth, a) < at(depth, b); });
  std::vector<int> place(parent.size());
  for (int i = 0; i < out.size(); ++i) place[static_cast<std::size_t>(at(out.order, i))] = i;
  out.level_begin.push_back(0);
  for (int i = 0; i < out.size(); ++i) {
    const int joint = at(out.order, i);
    if (i > 0 && at(depth, joint) > at(depth, at(out.order, i - 1))) out.level_begin.push_back(i);
    out.parent.push_back(at(parent, joint) < 0 ? -1 : at(place, at(parent, joint)));
    out.beside.push_back(at(beside, joint));
  }
  out.level_begin.push_back(out.size());
  return out;
}

}  // namespace

JointForest joint_forest(const Rod& rod) {
  const auto joints = static_cast<std::size_t>(rod.joint_count());
  std::vector<std::vector<int>> joints_of(static_cast<std::size_t>(rod.segment_count()));
  for (int j = 0; j < rod.joint_count(); ++j) {
    joints_of[static_cast<std::size_t>(rod.joints[static_cast<std::size_t>(j)].a)].push_back(j);
    joints_of[static_cast<std::size_t>(rod.joints[static_cast<std::size_t>(j)].b)].push_back(j);
  }
  const auto is_static = [&](int segment) { return rod.segments[static_cast<std::size_t>(segment)].is_static; };
  std::vector<int> parent(joints, -1), depth(joints, -1), segment_seen(joints_of.size(), 0);
  std::vector<std::pair<int, int>> queue;  // segment to continue from, joint that led there
  bool cut = false;

  const auto grow = [&] {
    for (std::size_t next = 0; next < queue.size(); ++next) {
      const auto [segment, from] = queue[next];
      if (is_static(segment)) continue;  // joints do not couple through it
      if (segment_seen[static_cast<std::size_t>(segment)]++) {
        cut = true;
        continue;
      }
      int above = from;
      for (const int j : joints_of[static_cast<std::size_t>(segment)]) {
        if (depth[static_cast<std::size_t>(j)] >= 0) continue;  // `from`, or a joint that closes a loop
        parent[static_cast<std::size_t>(j)] = above;
        depth[static_cast<std::size_t>(j)] = above < 0 ? 0 : depth[static_cast<std::size_t>(above)] + 1;
        if (above < 0) above = j;
        const Joint& joint = rod.joints[static_cast<std::size_t>(j)];
        queue.emplace_back(joint.a == segment ? joint.b : joint.a, j);
      }
    }
    queue.clear();
  };
  for (int j = 0; j < rod.joint_count(); ++j) {  // trees that hang from a static segment
    const Joint& joint = rod.joints[static_cast<std::size_t>(j)];
    if (depth[static_cast<std::size_t>(j)] >= 0 || !(is_static(joint.a) || is_static(joint.b))) continue;
    depth[static_cast<std::size_t>(j)] = 0;
    queue.emplace_back(is_static(joint.a) ? joint.b : joint.a, j);
    grow();
  }
  for (int s = 0; s < rod.segment_count(); ++s) {  // trees without a static segment
    if (is_static(s) || segment_seen[static_cast<std::size_t>(s)]) continue;
    queue.emplace_back(s, -1);
    grow();
  }
  std::vector<int> beside(joints, 0);
  for (std::size_t j = 0; j < joints; ++j) {
    if (const int up = parent[j]; up >= 0) {
      --beside[j];
      --beside[static_cast<std::size_t>(up)];
    }
    for (const int segment : {rod.joints[j].a, rod.joints[j].b})
      if (!is_static(segment)) beside[j] += static_cast<int>(joints_of[static_cast<std::size_t>(segment)].size()) - 1;
  }
  JointForest out = sorted(parent, depth, beside);
  out.cut = cut;
  return out;
}

JointForest side_by_side(const std::vector<const JointForest*>& forests) {
  std::vector<int> parent, depth, beside;
  for (const JointForest* forest : forests) {
    const int first = static_cast<int>(parent.size());
    parent.resize(parent.size() + forest->order.size());
    depth.resize(parent.size());
    beside.insert(beside.end(), forest->beside.begin(), forest->beside.end());
    for (int level = 0; level < forest->levels(); ++level)
      for (int i = forest->level_begin[static_cast<std::size_t>(level)];
           i < forest->level_begin[static_cast<std::size_t>(level) + 1]; ++i) {
        // A forest's places serve as joint numbers here, so that features in its order stay together.
        const int up = forest->parent[static_cast<std::size_t>(i)];
        parent[static_cast<std::size_t>(first + i)] = up < 0 ? -1 : first + up;
        depth[static_cast<std::size_t>(first + i)] = level;
      }
  }
  JointForest out = sorted(parent, depth, beside);
  out.cut = std::any_of(forests.begin(), forests.end(), [](const JointForest* forest) { return forest->cut; });
  return out;
}

}  // namespace rodsweep
