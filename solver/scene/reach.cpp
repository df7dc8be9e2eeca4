#include "solver/scene/reach.hpp"

#include <limits>
#include <map>
#include <queue>
#include <string>
#include <tuple>

#include "solver/scene/scene_parts.hpp"

namespace rodsweep {
namespace {

/// The shortest way along the rod to a joint.
struct Way {
  double length_m = std::numeric_limits<double>::infinity();
  int joints = 0;  ///< with the first and the last one
};

const Vector3& arm(const Joint& joint, int segment) { return joint.a == segment ? joint.arm_a : joint.arm_b; }

/// The shortest ways from the joints of a held segment to all joints, along segments that are free.
class Ways {
 public:
  explicit Ways(const Rod& rod) : rod_(rod), joints_of_(rod.segments.size()) {
    for (int k = 0; k < rod.joint_count(); ++k)
      for (const int segment : {joint(k).a, joint(k).b}) joints_of_[static_cast<std::size_t>(segment)].push_back(k);
  }

  const std::vector<int>& joints_of(int segment) const { return joints_of_[static_cast<std::size_t>(segment)]; }
  const Joint& joint(int k) const { return rod_.joints[static_cast<std::size_t>(k)]; }

  std::vector<Way> from(int first) const {
    std::vector<Way> ways(rod_.joints.size());
    using Next = std::tuple<double, int, int>;  // length, joints, joint
    std::priority_queue<Next, std::vector<Next>, std::greater<>> next;
    const auto reach = [&](int k, double length, int joints) {
      Way& way = ways[static_cast<std::size_t>(k)];
      if (!(length < way.length_m)) return;
      way = {length, joints};
      next.emplace(length, joints, k);
    };
    reach(first, 0, 1);
    while (!next.empty()) {
      const auto [length, joints, k] = next.top();
      next.pop();
      if (length > ways[static_cast<std::size_t>(k)].length_m) continue;
      for (const int segment : {joint(k).a, joint(k).b}) {
        if (rod_.segments[static_cast<std::size_t>(segment)].is_static) continue;
        for (const int other : joints_of(segment))
          reach(other, length + (arm(joint(other), segment) - arm(joint(k), segment)).norm(), joints + 1);
      }
    }
    return ways;
  }

 private:
  const Rod& rod_;
  std::vector<std::vector<int>> joints_of_;
};

}  // namespace

void check_reach(const Rod& rod, const std::vector<ClampPath>& paths, const std::vector<double>& times_s,
                 bool stretches) {
  constexpr double tolerance = 1e-5, most_deg = 90;
  const Ways ways(rod);
  std::map<int, const ClampPath*> path_of;
  for (const ClampPath& path : paths) path_of[path.segment] = &path;
  const auto pose = [&](int segment, double time_s) {
    const auto s = static_cast<std::size_t>(segment);
    const auto path = path_of.find(segment);
    return path == path_of.end() ? Pose{rod.position[s], rod.orientation[s]} : path->second->pose(time_s);
  };
  const auto turned_deg = [&](int segment, double time_s) -> Vector3 {
    const auto path = path_of.find(segment);
    return path == path_of.end() ? Vector3::Zero() : path->second->turned_deg(time_s);
  };
  const auto check = [&](const Joint& first, int a, const Joint& last, int b, const Way& way) {
    const auto clamps = [&] {
      return "motions of the clamps at " + text_of(rod.position[static_cast<std::size_t>(a)]) + " and " +
             text_of(rod.position[static_cast<std::size_t>(b)]);
    };
    for (const double time_s : times_s) {
      const Pose one = pose(a, time_s), other = pose(b, time_s);
      const double apart =
          (one.position + one.orientation * arm(first, a) - other.position - other.orientation * arm(last, b)).norm();
      if (!stretches && apart > (1 + tolerance) * way.length_m)
        throw SceneError(clamps() + " pull the rod between them to " + std::to_string(apart) +
                         " m; must be at most its length, " + std::to_string(way.length_m) +
                         " m, or \"stretch\" must be \"physical\"");
      const double turned = (turned_deg(a, time_s) - turned_deg(b, time_s)).norm();
      if (turned > (1 + tolerance) * most_deg * way.joints)
        throw SceneError(clamps() + " turn them against each other by " + std::to_string(turned) +
                         " degrees; must be at most 90 for each of the " + std::to_string(way.joints) +
                         " joints between them: use more segments");
    }
  };
  for (const ClampPath& path : paths)
    for (const int first : ways.joints_of(path.segment)) {
      const std::vector<Way> found = ways.from(first);
      for (int k = 0; k < rod.joint_count(); ++k)
        for (const int end : {ways.joint(k).a, ways.joint(k).b})
          if (end != path.segment && rod.segments[static_cast<std::size_t>(end)].is_static &&
              found[static_cast<std::size_t>(k)].length_m < std::numeric_limits<double>::infinity())
            check(ways.joint(first), path.segment, ways.joint(k), end, found[static_cast<std::size_t>(k)]);
    }
}

}  // namespace rodsweep
