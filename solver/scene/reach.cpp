#include "solver/scene/reach.hpp"

#include <limits>
#include <map>
#include <string>

#include "solver/rod/joint_ways.hpp"
#include "solver/scene/scene_parts.hpp"

namespace rodsweep {
namespace {

const Vector3& arm(const Joint& joint, int segment) { return joint.a == segment ? joint.arm_a : joint.arm_b; }

}  // namespace

void check_reach(const Rod& rod, const std::vector<ClampPath>& paths, const std::vector<double>& times_s,
                 bool stretches) {
  constexpr double tolerance = 1e-5, most_deg = 90;
  JointWays ways(rod);
  std::map<int, const ClampPath*> path_of;
  for (const ClampPath& path : paths) path_of[path.segment] = &path;
  const auto pose = [&](int segment, double time_s) {
    const auto s = at(segment);
    const auto path = path_of.find(segment);
    return path == path_of.end() ? Pose{rod.position[s], rod.orientation[s]} : path->second->pose(time_s);
  };
  const auto turned_deg = [&](int segment, double time_s) -> Vector3 {
    const auto path = path_of.find(segment);
    return path == path_of.end() ? Vector3::Zero() : path->second->turned_deg(time_s);
  };
  const auto check = [&](const Joint& first, int a, const Joint& last, int b, const JointWays::Way& way) {
    const auto clamps = [&] {
      return "motions of the clamps at " + text_of(rod.position[at(a)]) + " and " + text_of(rod.position[at(b)]);
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
  const auto joint = [&rod](int k) -> const Joint& { return rod.joints[at(k)]; };
  const auto is_static = [&rod](int segment) { return rod.segments[at(segment)].is_static; };
  for (const ClampPath& path : paths)
    for (const JointWays::Meeting& first : ways.joints_of(path.segment))
      ways.from(
          {first}, std::numeric_limits<double>::infinity(), [&](int segment) { return !is_static(segment); },
          [&](int k, const JointWays::Way& way) {
            for (const int end : {joint(k).a, joint(k).b})
              if (end != path.segment && is_static(end)) check(joint(first.joint), path.segment, joint(k), end, way);
          });
}

}  // namespace rodsweep
