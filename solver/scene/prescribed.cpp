#include "solver/scene/prescribed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <utility>

#include "solver/numbers/rotation.hpp"
#include "solver/rod/joint_ways.hpp"
#include "solver/scene/scene_parts.hpp"

namespace rodsweep {
namespace {

/// A point of the axis of a segment.
struct AxisPoint {
  int rod = 0, segment = 0;
  double along_m = 0;  ///< from the centre
  double distance_m = std::numeric_limits<double>::infinity();
};

const Segment& segment(const Scene& scene, const AxisPoint& place) {
  return scene.rods[at(place.rod)].segments[at(place.segment)];
}

/// Finds the segments at points of a scene.
class SegmentFinder {
 public:
  explicit SegmentFinder(const Scene& scene) : scene_(scene), rounding_m_(1e-6 * extent(scene)) {}

  /// Points that are no farther apart are one: coordinates may be rounded, or come from another unit.
  double rounding_m() const { return rounding_m_; }

  /// The segments nearest to a point, among held ones or among all: several where they meet. Throws SceneError if there
  /// are none near it. `what`: for errors.
  std::vector<AxisPoint> nearest(const Vector3& point, bool held, const char* what) const {
    std::vector<AxisPoint> all;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t r = 0; r < scene_.rods.size(); ++r)
      for (std::size_t s = 0; s < scene_.rods[r].segments.size(); ++s) {
        const AxisPoint place = on_axis(point, r, s);
        if ((held && !segment(scene_, place).is_static) || !(place.distance_m <= least + rounding_m_)) continue;
        least = std::min(least, place.distance_m);
        all.push_back(place);
      }
    all.erase(std::remove_if(all.begin(), all.end(),
                             [&](const AxisPoint& place) { return place.distance_m > least + rounding_m_; }),
              all.end());
    if (all.empty()) throw SceneError(std::string(what) + " needs a held segment; this scene has none");
    check_near(all.front(), what, point);
    return all;
  }

 private:
  static double extent(const Scene& scene) {
    Eigen::AlignedBox3d box;
    for (const Rod& rod : scene.rods)
      for (std::size_t s = 0; s < rod.segments.size(); ++s)
        for (const double side : {-0.5, 0.5})
          box.extend(rod.position[s] + side * rod.segments[s].length_m * director(rod.orientation[s]));
    return box.diagonal().norm();
  }

  AxisPoint on_axis(const Vector3& point, std::size_t r, std::size_t s) const {
    const Rod& rod = scene_.rods[r];
    const Vector3 axis = rod.orientation[s] * Vector3::UnitZ();
    const double half = rod.segments[s].length_m / 2;
    const double along = std::clamp(axis.dot(point - rod.position[s]), -half, half);
    return {static_cast<int>(r), static_cast<int>(s), along, (point - rod.position[s] - along * axis).norm()};
  }

  void check_near(const AxisPoint& place, const char* what, const Vector3& at_m) const {
    const Segment& found = segment(scene_, place);
    const double most = std::max({found.radius_m, found.length_m, rounding_m_});
    if (place.distance_m <= most) return;
    std::ostringstream out;
    out << what << " at " << text_of(at_m) << " is " << place.distance_m
        << " m away from the nearest segment; must be at most " << most << " m away";
    throw SceneError(out.str());
  }

  const Scene& scene_;
  double rounding_m_;
};

void add(const PrescribedLoad& load, const SegmentFinder& places, Scene& scene) {
  const std::vector<AxisPoint> found = places.nearest(load.at_m, false, "a load");
  if (std::any_of(found.begin(), found.end(), [&](const AxisPoint& each) { return segment(scene, each).is_static; }))
    throw SceneError("a load at " + text_of(load.at_m) + " is on a held segment; must be on one that can move");
  const AxisPoint& place = found.front();
  scene.loads.push_back(
      {place.rod, place.segment, load.force_n, load.torque_nm, Vector3(0, 0, place.along_m), load.schedule});
}

/// The poses of a held segment that motions move: each is displaced by their sum, and turned by the sum of their
/// rotation vectors.
struct Moved {
  std::vector<PrescribedMotion> motions;
  Vector3 about, position;
  Quaternion orientation;

  /// The sum of these over the motions, times their factors.
  Vector3 sum(Vector3 PrescribedMotion::*of, double time_s) const {
    Vector3 out(0, 0, 0);
    for (const PrescribedMotion& motion : motions) out += motion.schedule.at(time_s) * (motion.*of);
    return out;
  }
  Vector3 turned_deg(double time_s) const { return sum(&PrescribedMotion::rotation_deg, time_s); }

  Pose operator()(double time_s) const {
    const Vector3 rotation_deg = turned_deg(time_s);
    const double angle = rotation_deg.norm() * pi / 180;
    const Quaternion turn =
        angle == 0 ? Quaternion::Identity() : Quaternion(Eigen::AngleAxisd(angle, rotation_deg.normalized()));
    return {about + sum(&PrescribedMotion::displacement_m, time_s) + turn * (position - about),
            (turn * orientation).normalized()};
  }
};

/// When to look at motions: at the times of their factors, and some between.
std::vector<double> times_of(const std::vector<PrescribedMotion>& motions) {
  constexpr int looks = 20;
  std::vector<double> given, out;
  for (const PrescribedMotion& motion : motions)
    given.insert(given.end(), motion.schedule.times_s.begin(), motion.schedule.times_s.end());
  std::sort(given.begin(), given.end());
  for (std::size_t i = 0; i + 1 < given.size(); ++i)
    for (int k = 0; k < looks; ++k) out.push_back(given[i] + (given[i + 1] - given[i]) * k / looks);
  out.push_back(given.back());
  return out;
}

/// The point about which all motions of a clamp turn it: on the axis of each. Turns about different points give a pose
/// that depends on their order, so they are refused.
Vector3 centre_of_turns(const std::vector<PrescribedMotion>& motions, double rounding_m) {
  const auto is_on_axis = [&](const Vector3& point, const PrescribedMotion& of) {
    return (point - of.at_m).cross(of.rotation_deg.normalized()).norm() <= rounding_m;
  };
  std::string points;
  for (const PrescribedMotion& one : motions) {
    if (std::all_of(motions.begin(), motions.end(), [&](const auto& each) { return is_on_axis(one.at_m, each); }))
      return one.at_m;
    if (!one.rotation_deg.isZero(0)) points += (points.empty() ? "" : ", ") + text_of(one.at_m);
  }
  throw SceneError("motions of one clamp turn about different points: " + points +
                   "; must be one point or points of one axis, because the order of such turns would matter");
}

/// How a held segment of a rod moves.
struct ClampPath {
  int segment;
  std::function<Pose(double time_s)> pose;
  std::function<Vector3(double time_s)> turned_deg;  ///< rotation vector, also of many turns
};

const Vector3& arm(const Joint& joint, int segment) { return joint.a == segment ? joint.arm_a : joint.arm_b; }

/// Throws SceneError if at one of these times two clamps of a rod are farther apart than the rod between them is long,
/// unless it `stretches`; or if they are turned against each other by more than a right angle for each joint between
/// them: there a joint bears the most, and beyond half a turn it slips by a turn.
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

void add(const std::vector<PrescribedMotion>& motions, const SegmentFinder& places, bool stretches, Scene& scene) {
  if (motions.empty()) return;
  std::map<std::pair<int, int>, Moved> moved;
  for (const PrescribedMotion& motion : motions)
    for (const AxisPoint& place : places.nearest(motion.at_m, true, "a motion of a clamp")) {
      for (const MovingClamp& clamp : scene.clamps)
        if (clamp.rod == place.rod && clamp.segment == place.segment)
          throw SceneError("the clamp at " + text_of(motion.at_m) + " is moved by the scene itself; must be another");
      moved[{place.rod, place.segment}].motions.push_back(motion);
    }
  std::map<int, std::vector<ClampPath>> paths;  // of each rod
  for (auto& [place, own] : moved) {
    const Rod& rod = scene.rods[at(place.first)];
    const auto s = at(place.second);
    own.about = centre_of_turns(own.motions, places.rounding_m());
    own.position = rod.position[s];
    own.orientation = rod.orientation[s];
    scene.clamps.push_back({place.first, place.second, own, times_of(own.motions).back()});
    paths[place.first].push_back({place.second, own, [own = own](double time_s) { return own.turned_deg(time_s); }});
  }
  for (const auto& [rod, own] : paths) check_reach(scene.rods[at(rod)], own, times_of(motions), stretches);
}

}  // namespace

double Schedule::until_s() const { return times_s.empty() ? -std::numeric_limits<double>::infinity() : times_s.back(); }

double Schedule::at(double time_s) const {
  if (times_s.empty()) return 1;
  const auto next = std::upper_bound(times_s.begin(), times_s.end(), time_s);
  if (next == times_s.begin()) return factors.front();
  if (next == times_s.end()) return factors.back();
  const auto i = static_cast<std::size_t>(next - times_s.begin());
  const double u = (time_s - times_s[i - 1]) / (times_s[i] - times_s[i - 1]);
  const double done = smooth ? u * u * u * (10 - 15 * u + 6 * u * u) : u;
  return factors[i - 1] + done * (factors[i] - factors[i - 1]);
}

double Schedule::largest() const {
  double most = factors.empty() ? 1 : 0;
  for (const double factor : factors) most = std::max(most, std::abs(factor));
  return most;
}

void Schedule::check() const {
  if (times_s.size() != factors.size())
    throw SceneError("times_s has " + std::to_string(times_s.size()) + " values, factors " +
                     std::to_string(factors.size()) + "; must be as many");
  for (std::size_t i = 1; i < times_s.size(); ++i)
    require(times_s[i] > times_s[i - 1], "a value of times_s", times_s[i], "greater than the one before");
}

void Prescribed::check() const {
  const auto check_all = [](const char* name, const auto& items, const auto& check) {
    for (std::size_t i = 0; i < items.size(); ++i) try {
        items[i].schedule.check();
        check(items[i].schedule);
      } catch (const SceneError& error) {
        throw SceneError(std::string(name) + '[' + std::to_string(i) + "]: " + error.what());
      }
  };
  const auto nothing = [](const Schedule&) {};
  check_all("loads", loads, nothing);
  check_all("gravity_changes", gravity, nothing);
  check_all("motions", motions, [](const Schedule& schedule) {
    if (schedule.times_s.empty() || schedule.at(0) != 0)
      throw SceneError("begins with the factor " + std::to_string(schedule.at(0)) +
                       "; must be 0 at the time 0, with times_s and factors such as [0, 1] and [0, 1]");
  });
}

double Prescribed::largest_force_n() const {
  double sum = 0;
  for (const PrescribedLoad& load : loads) sum += load.force_n.norm() * load.schedule.largest();
  return sum;
}

double Prescribed::largest_gravity_m_s2(const Vector3& constant) const {
  double sum = constant.norm();
  for (const GravityChange& change : gravity) sum += change.by_m_s2.norm() * change.schedule.largest();
  return sum;
}

void add_prescribed(const Prescribed& prescribed, Scene& scene, bool stretches) {
  const SegmentFinder places(scene);
  for (const PrescribedLoad& load : prescribed.loads) add(load, places, scene);
  add(prescribed.motions, places, stretches, scene);
  scene.gravity_changes = prescribed.gravity;
}

}  // namespace rodsweep
