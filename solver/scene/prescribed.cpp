#include "solver/scene/prescribed.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <sstream>
#include <utility>

#include "solver/scene/scene_parts.hpp"

namespace rodsweep {
namespace {

/// A point of the axis of a segment.
struct Place {
  int rod = 0, segment = 0;
  double along_m = 0;  ///< from the centre
  double distance_m = std::numeric_limits<double>::infinity();
};

/// The place nearest to a point, among held segments or among all.
Place nearest(const Scene& scene, const Vector3& point, bool held) {
  Place best;
  for (std::size_t r = 0; r < scene.rods.size(); ++r) {
    const Rod& rod = scene.rods[r];
    for (std::size_t s = 0; s < rod.segments.size(); ++s) {
      if (held && !rod.segments[s].is_static) continue;
      const Vector3 axis = rod.orientation[s] * Vector3::UnitZ();
      const double half = rod.segments[s].length_m / 2;
      const double along = std::clamp(axis.dot(point - rod.position[s]), -half, half);
      const double distance = (point - rod.position[s] - along * axis).norm();
      if (distance < best.distance_m) best = {static_cast<int>(r), static_cast<int>(s), along, distance};
    }
  }
  return best;
}

const Segment& segment(const Scene& scene, const Place& place) {
  return scene.rods[static_cast<std::size_t>(place.rod)].segments[static_cast<std::size_t>(place.segment)];
}

void check_near(const Scene& scene, const Place& place, const char* what, const Vector3& at_m) {
  const Segment& found = segment(scene, place);
  const double most = std::max(found.radius_m, found.length_m);
  if (place.distance_m <= most) return;
  std::ostringstream out;
  out << what << " at " << text_of(at_m) << " is " << place.distance_m
      << " m away from the nearest segment; must be at most " << most << " m away";
  throw SceneError(out.str());
}

void add(const PrescribedLoad& load, Scene& scene) {
  const Place place = nearest(scene, load.at_m, false);
  check_near(scene, place, "a load", load.at_m);
  if (segment(scene, place).is_static)
    throw SceneError("a load at " + text_of(load.at_m) + " is on a held segment; must be on one that can move");
  scene.loads.push_back(
      {place.rod, place.segment, load.force_n, load.torque_nm, Vector3(0, 0, place.along_m), load.schedule});
}

/// The poses of a held segment that motions move.
struct Moved {
  std::vector<PrescribedMotion> motions;
  Vector3 position;
  Quaternion orientation;

  Pose operator()(double time_s) const {
    Vector3 displacement(0, 0, 0), rotation_deg(0, 0, 0);
    for (const PrescribedMotion& motion : motions) {
      const double factor = motion.schedule.at(time_s);
      displacement += factor * motion.displacement_m;
      rotation_deg += factor * motion.rotation_deg;
    }
    const double angle = rotation_deg.norm() * pi / 180;
    const Quaternion turn =
        angle == 0 ? Quaternion::Identity() : Quaternion(Eigen::AngleAxisd(angle, rotation_deg.normalized()));
    const Vector3& about = motions.front().at_m;
    return {about + displacement + turn * (position - about), (turn * orientation).normalized()};
  }
};

void add(const std::vector<PrescribedMotion>& motions, Scene& scene) {
  std::map<std::pair<int, int>, Moved> moved;
  for (const PrescribedMotion& motion : motions) {
    const Place place = nearest(scene, motion.at_m, true);
    if (place.distance_m == std::numeric_limits<double>::infinity())
      throw SceneError("a motion needs a held segment; this scene has none");
    check_near(scene, place, "a motion of a clamp", motion.at_m);
    for (const MovingClamp& clamp : scene.clamps)
      if (clamp.rod == place.rod && clamp.segment == place.segment)
        throw SceneError("the clamp at " + text_of(motion.at_m) + " is moved by the scene itself; must be another");
    const Rod& rod = scene.rods[static_cast<std::size_t>(place.rod)];
    const auto s = static_cast<std::size_t>(place.segment);
    Moved& own = moved[{place.rod, place.segment}];
    own.position = rod.position[s];
    own.orientation = rod.orientation[s];
    own.motions.push_back(motion);
  }
  for (const auto& [place, poses] : moved) scene.clamps.push_back({place.first, place.second, poses});
}

}  // namespace

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

void add_prescribed(const Prescribed& prescribed, Scene& scene) {
  for (const PrescribedLoad& load : prescribed.loads) add(load, scene);
  add(prescribed.motions, scene);
  scene.gravity_changes = prescribed.gravity;
}

}  // namespace rodsweep
