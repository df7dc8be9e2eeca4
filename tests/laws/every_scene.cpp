// Every scene of a job moves alike if it is turned, mirrored, moved away or given in other units, in both steps and by
// both integrators; and loads, motions of clamps and changes of gravity act at each of its places.
#include <algorithm>
#include <map>
#include <set>

#include "runner/plan/plan.hpp"
#include "runner/specs/scene_keys.hpp"
#include "tests/catch.hpp"
#include "tests/laws/scene_samples.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/turned.hpp"

namespace rodsweep::law_every_scene {

using Catch::Matchers::ContainsSubstring;
using scene_samples::samples;
using scene_samples::SceneFiles;
using scene_samples::step_s;

/// One of the ways to step.
struct Way {
  const char* name;
  Integrator integrator;
  std::optional<double> momentum_tolerance;
};
const Way ways[] = {{"Euler", Integrator::euler, {}},
                    {"BDF2", Integrator::bdf2, {}},
                    {"Euler in balance", Integrator::euler, 1e-9},
                    {"BDF2 in balance", Integrator::bdf2, 1e-9}};

struct End {
  Scene scene;
  int contacts = 0;  ///< of all steps
};
End after(const Scene& start, const Way& way, int steps, double dt = step_s) {
  Simulation simulation(start, {dt, 60, 1e-11, way.integrator}, way.momentum_tolerance);
  int contacts = 0;
  for (int step = 0; step < steps; ++step) contacts += simulation.step().contacts;
  return {simulation.scene, contacts};
}

/// Calls `visit(rod, segment)` for each segment.
template <class Visit>
void each_segment(const Scene& scene, const Visit& visit) {
  for (std::size_t r = 0; r < scene.rods.size(); ++r)
    for (std::size_t s = 0; s < scene.rods[r].segments.size(); ++s) visit(r, s);
}

/// The largest distance of points of `other` from the images of those of `scene`.
template <class Image>
double apart(const Scene& scene, const Scene& other, const Image& image) {
  double out = 0;
  each_segment(scene, [&](std::size_t r, std::size_t s) {
    const double distance = (other.rods[r].position[s] - image(scene.rods[r].position[s])).norm();
    if (!(distance <= out)) out = distance;  // also if it is not a number
  });
  return out;
}

bool is_moved_by_scene(const Scene& scene, std::size_t r, std::size_t s) {
  return std::any_of(scene.clamps.begin(), scene.clamps.end(), [&](const MovingClamp& clamp) {
    return clamp.rod == static_cast<int>(r) && clamp.segment == static_cast<int>(s);
  });
}

Json as_json(const Vector3& v) { return {v.x(), v.y(), v.z()}; }
Json list_of(const Json& item) { return Json::array({item}); }

/// With a load, a change of gravity and, if a clamp can be moved, a motion.
Json with_changes(Json scene, const Scene& built) {
  each_segment(built, [&](std::size_t r, std::size_t s) {
    const Rod& rod = built.rods[r];
    const Json at = as_json(rod.position[s]);
    if (!rod.segments[s].is_static)
      scene["loads"] = list_of({{"at_m", at},
                                {"force_n", as_json(3 * rod.segments[s].mass * Vector3(1, 2, -1))},
                                {"times_s", {0, 0.05}},
                                {"factors", {0, 1}}});
    else if (!is_moved_by_scene(built, r, s))
      scene["motions"] = list_of({{"at_m", at},
                                  {"displacement_m", {0.004, -0.002, 0.003}},
                                  {"rotation_deg", {2, 1, -3}},
                                  {"times_s", {0, 0.05}},
                                  {"factors", {0, 1}},
                                  {"smooth", true}});
  });
  scene["gravity_changes"] = list_of({{"by_m_s2", {1, 2, -3}}, {"times_s", {0, 0.05}}, {"factors", {0, 1}}});
  return scene;
}

// Another system of units: powers of two, so that numbers keep their digits. Accelerations keep their numbers, because
// "inextensible" joints are made for at least the Earth's gravity.
constexpr double length_unit = 4, time_unit = 2, mass_unit = 32;

double in_units(const std::string& unit) {
  constexpr double force = mass_unit * length_unit / (time_unit * time_unit), energy = force * length_unit;
  static const std::map<std::string, double> units{
      {"", 1},
      {"deg", 1},
      {"m", length_unit},
      {"m^2", length_unit * length_unit},
      {"m^4", length_unit * length_unit * length_unit * length_unit},
      {"kg/m^3", mass_unit / (length_unit * length_unit * length_unit)},
      {"s", time_unit},
      {"1/s", 1 / time_unit},
      {"m/s", length_unit / time_unit},
      {"m/s^2", length_unit / (time_unit * time_unit)},
      {"N", force},
      {"N m", energy},
      {"1/J", 1 / energy},
      {"Pa", force / (length_unit * length_unit)},
  };
  return units.at(unit);
}

/// A validated value of a key in the other units.
Json in_other_units(const Key& key, Json value) {
  if (value.is_object()) {
    for (auto& [name, member] : value.items()) member = in_other_units(*find_key(key.keys, name), member);
  } else if (value.is_array()) {
    for (Json& item : value) item = in_other_units(key.kind == Key::Kind::list ? key.keys.front() : key, item);
  } else if (value.is_number() && key.unit != "") {
    value = value.get<double>() * in_units(key.unit);
  }
  return value;
}

TEST_CASE("every type of scene has a sample here") {
  std::set<std::string> types;
  for (const Json& scene : samples()) types.insert(scene["type"]);
  KindsOf<SceneSpec>::each([&](const auto& scene) { CHECK(types.count(scene.name) == 1); });
}

TEST_CASE("every scene moves alike if it is turned, mirrored, moved by 100 m or given in other units") {
  const SceneFiles files;
  std::vector<test::RigidMotion> motions(std::begin(test::motions), std::end(test::motions));
  motions.push_back({Quaternion::Identity(), {60, -80, 0}});
  for (const Json& sample : samples()) {
    const Json changed = with_changes(sample, files.scene(sample));
    const Job job = files.job(changed);
    const Scene start = build_scene(Plan(job).spec(0).scene),
                in_units = files.scene(in_other_units(scene_key(), job.values["scene"]));
    for (const Way& way : ways) {
      INFO(sample["type"] << " by " << way.name);
      constexpr int steps = 16;
      const auto& [end, contacts] = after(start, way, steps);
      const double rounding = contacts > 0 ? 1e-6 : 1e-8;  // contacts converge to 1e-5 radii of .03 m
      CHECK((start.obstacles.empty() || contacts > 0));
      REQUIRE(apart(start, end, [](const Vector3& x) { return x; }) > 1e-3);
      for (const test::RigidMotion& motion : motions)
        CHECK(apart(end, after(moved(start, motion), way, steps).scene, motion) < rounding);
      CHECK(apart(end, after(test::mirrored(start), way, steps).scene,
                  [](const Vector3& x) { return test::mirrored(x); }) < rounding);
      CHECK(apart(end, after(in_units, way, steps, time_unit * step_s).scene,
                  [](const Vector3& x) { return Vector3(length_unit * x); }) < length_unit * rounding);
    }
  }
}

TEST_CASE("a change of gravity moves every rod of every scene") {
  const SceneFiles files;
  for (const Json& sample : samples()) {
    Json changed = sample;
    changed["gravity_changes"] = list_of({{"by_m_s2", {3, 2, -4}}});
    const Scene plain = files.scene(sample), start = files.scene(changed);
    for (const Way& way : ways) {
      const Scene end = after(plain, way, 3).scene, other = after(start, way, 3).scene;
      for (std::size_t r = 0; r < plain.rods.size(); ++r) {
        INFO(sample["type"] << " by " << way.name << ", rod " << r);
        double most = 0;
        for (std::size_t s = 0; s < plain.rods[r].segments.size(); ++s)
          most = std::max(most, (other.rods[r].position[s] - end.rods[r].position[s]).norm());
        CHECK(most > 1e-6);
      }
    }
  }
}

/// A direction across a segment.
Vector3 across(const Rod& rod, std::size_t s) { return rod.orientation[s] * Vector3::UnitX(); }

TEST_CASE("a load moves every segment of every scene that can move, and is refused on every one that cannot") {
  const SceneFiles files;
  for (const Json& sample : samples()) {
    const Scene plain = files.scene(sample);
    for (const Way& way : ways) {
      const Scene end = after(plain, way, 2).scene;
      each_segment(plain, [&](std::size_t r, std::size_t s) {
        const Rod& rod = plain.rods[r];
        INFO(sample["type"] << " by " << way.name << ", segment " << s << " of rod " << r);
        const Vector3 direction = across(rod, s);
        Json loaded = sample;
        const double force_n = 100 * rod.segments[s].mass;
        loaded["loads"] = list_of({{"at_m", as_json(rod.position[s])}, {"force_n", as_json(force_n * direction)}});
        if (rod.segments[s].is_static) {
          CHECK_THAT(message_of<JobError>([&] { files.scene(loaded); }), ContainsSubstring("is on a held segment"));
          return;
        }
        const Scene other = after(files.scene(loaded), way, 2).scene;
        CHECK((other.rods[r].position[s] - end.rods[r].position[s]).dot(direction) > 1e-9);
      });
    }
  }
}

TEST_CASE("a motion moves all that is held at its place in every scene, and what hangs there follows") {
  const SceneFiles files;
  const Vector3 by(2e-3, -3e-3, 1e-3);
  for (const Json& sample : samples()) {
    const Scene plain = files.scene(sample);
    for (const Way& way : ways) {
      const Scene end = after(plain, way, 3).scene;
      each_segment(plain, [&](std::size_t r, std::size_t s) {
        const Vector3& at = plain.rods[r].position[s];
        if (!plain.rods[r].segments[s].is_static) return;
        INFO(sample["type"] << " by " << way.name << ", segment " << s << " of rod " << r);
        Json changed = sample;
        changed["motions"] = list_of({{"at_m", as_json(at)},
                                      {"displacement_m", as_json(by)},
                                      {"times_s", {0, 2 * step_s}},
                                      {"factors", {0, 1}}});
        if (is_moved_by_scene(plain, r, s)) {
          CHECK_THAT(message_of<JobError>([&] { files.scene(changed); }),
                     ContainsSubstring("is moved by the scene itself"));
          return;
        }
        const Scene other = after(files.scene(changed), way, 3).scene;
        double follows = 0;
        for (std::size_t k = 0; k < plain.rods[r].segments.size(); ++k) {
          const Vector3 shift = other.rods[r].position[k] - end.rods[r].position[k];
          if (!plain.rods[r].segments[k].is_static)
            follows = std::max(follows, shift.norm());
          else if ((plain.rods[r].position[k] - at).norm() < 1e-9)
            CHECK((shift - by).norm() < 1e-12);
        }
        CHECK(follows > 0.1 * by.norm());
      });
    }
  }
}

/// What joints do to each segment of a rod, about its centre.
std::vector<Action> of_joints(const Rod& rod) {
  std::vector<Action> out(rod.segments.size());
  for (int k = 0; k < rod.joint_count(); ++k) {
    const Joint& joint = rod.joints[at(k)];
    const auto [force, moment] = joint_action(rod, k);
    out[at(joint.a)].add(point_on_a(rod, joint) - rod.position[at(joint.a)], force, moment);
    out[at(joint.b)].add(point_on_b(rod, joint) - rod.position[at(joint.b)], -force, -moment);
  }
  return out;
}

/// m (v - v^) / h + c m v of a segment: what its velocity says that acts on it (free_flight.hpp).
Vector3 felt_force(const Scene& before, const Scene& now, const Scene& after, std::size_t r, std::size_t s) {
  const auto v = [&](const Scene& scene) { return scene.rods[r].velocity[s]; };
  const bool is_euler = after.rods[r].constraint_dt == constraint_dt(after, step_s);
  const double h = is_euler ? step_s : 2 * step_s / 3;
  const Vector3 past = is_euler ? v(now) : Vector3((4 * v(now) - v(before)) / 3);
  return after.rods[r].segments[s].mass * ((v(after) - past) / h + after.damping_per_s * v(after));
}

TEST_CASE("forces of joints, clamps, obstacles and loads change the momentum of every segment and of every scene") {
  const SceneFiles files;
  for (const Json& sample : samples()) {
    const Scene start = files.scene(with_changes(sample, files.scene(sample)));
    for (const Way& way : ways) {
      if (!way.momentum_tolerance) continue;
      INFO(sample["type"] << " by " << way.name);
      Simulation simulation(start, {step_s, 40, 1e-11, way.integrator}, way.momentum_tolerance);
      Scene before = start, now = start;
      const Scene& after = simulation.scene;
      int balanced = 0;
      for (int step = 0; step < 16; ++step) {
        before = std::exchange(now, after);
        simulation.step();
        double scale = 0, lacking = 0;
        for (const Rod& rod : after.rods) {
          lacking = std::max(lacking, momentum_residual(rod));
          for (int k = 0; k < rod.joint_count(); ++k) {
            const auto [force, moment] = joint_action(rod, k);
            scale = std::max({scale, force.norm(), moment.norm() / rod.joints[at(k)].length});
          }
        }
        if (!(lacking < 1e-8)) continue;
        ++balanced;
        Vector3 felt = Vector3::Zero(), outer = Vector3::Zero();
        for (std::size_t r = 0; r < after.rods.size(); ++r) {
          const Rod& rod = after.rods[r];
          const double per_dt2 = 1 / (rod.constraint_dt * rod.constraint_dt);
          const std::vector<Action> joints = of_joints(rod);
          for (std::size_t s = 0; s < rod.segments.size(); ++s) {
            const Segment& segment = rod.segments[s];
            if (segment.is_static) continue;
            Vector3 load = segment.mass * after.gravity_at(after.time_s);
            for (const PointLoad& at_one : after.loads)
              if (at(at_one.rod) == r && at(at_one.segment) == s)
                load += at_one.schedule.at(after.time_s) * at_one.force_n;
            const Vector6 contact = per_dt2 * rod.outer_impulse(s);
            const Vector3 force = felt_force(before, now, after, r, s);
            CHECK((joints[s].force_n + contact.head<3>() + load - force).norm() < 1e-6 * scale);
            felt += force;
            outer += load;
            const Quaternion& q = rod.orientation[s];
            const Vector3 turn = q.conjugate() * rotation(q, rod.free_orientation[s]);
            const Vector3 torque =
                per_dt2 * (q * Vector3(segment.inertia_transverse * turn.x(), segment.inertia_transverse * turn.y(),
                                       segment.inertia_axial * turn.z()));
            CHECK((joints[s].moment_nm + contact.tail<3>() - torque).norm() < 1e-6 * scale * segment.length_m);
          }
        }
        const Reactions reactions = simulation.reactions();
        CHECK((reactions.clamps.force_n + reactions.obstacles.force_n + outer - felt).norm() < 1e-6 * scale);
      }
      CHECK(balanced >= 8);
    }
  }
}

}  // namespace rodsweep::law_every_scene
