#include "solver/scene/scenes.hpp"

#include <cmath>
#include <string>

#include "solver/scene/scene_rods.hpp"

namespace rodsweep {
namespace {

constexpr int most_segments = 10000000;

void check_least(const char* what, int value, int least, const char* why = "") {
  if (value < least)
    throw SceneError(std::string(what) + " is " + std::to_string(value) + "; must be at least " +
                     std::to_string(least) + why);
}

void check_total(const char* what, double segments) {
  if (segments > most_segments)
    throw SceneError(std::string(what) + " of so many segments is too large; the most is " +
                     std::to_string(most_segments));
}

void check(const OpenRod& p) {
  if (p.clamp == Clamp::segment)
    check_least("segments", p.segments, 2, ": the clamp \"segment\" holds the first one");
  else
    check_least("segments", p.segments, 1);
}

void check(const Ring& p) {
  check_least("segments", p.segments, 3, ": fewer do not close a ring");
  if (p.clamp == Clamp::wall) throw SceneError("a ring has no end that the clamp \"wall\" could hold");
  if (!(std::abs(p.twist_deg) <= 90.0 * p.segments))
    throw SceneError("twist_deg is " + std::to_string(p.twist_deg) + "; must be at most 90 degrees for each of " +
                     std::to_string(p.segments) + " segments");
}

void check(const Net& p) {
  check_least("rows", p.rows, 2);
  check_least("columns", p.columns, 2);
  check_least("segments", p.segments, 1);
  if (p.held == Net::Held::corners && p.rows == 2)
    check_least("segments", p.segments, 2, ": between the held ends of two rows nothing would be free");
  check_total("a net", 2.0 * p.rows * p.columns * p.segments);
}

void check(const Tree& p) { validate(p.shape); }

void check(const Forest& p) {
  validate(p.shape);
  check_least("rows", p.rows, 1);
  check_least("columns", p.columns, 1);
  check_total("a forest", static_cast<double>(edge_count(p.shape)) * p.rows * p.columns);
}

void check(const SkeletonTree& p) {
  if (!p.skeleton || p.skeleton->size() < 2) throw SceneError("a skeleton needs at least two nodes");
  if (const auto wrong = fault(*p.skeleton))
    throw SceneError("node " + std::to_string(wrong->node) + " of a skeleton: " + wrong->text);
}

void check(const FallingRods& p) {
  check_least("rods", p.rods, 1);
  check_least("segments", p.segments, 2);
  if (!(p.height_m >= 2 * p.radius_m))
    throw SceneError("height_m is " + std::to_string(p.height_m) +
                     "; must be at least 2 radius_m, or the rods overlap");
  check_total("a heap", static_cast<double>(p.rods) * p.segments);
}

void check(const CoilingRod& p) { check_least("segments", p.segments, 2, ": the first one is held"); }

void check(const Knot& p) {
  check_least("segments", p.segments, 30, ": fewer do not make a knot");
  const double shortest = loose_knot_radii() * p.radius_m;
  if (!(p.length_m >= shortest))
    throw SceneError("length_m is " + std::to_string(p.length_m) + "; must be at least " + std::to_string(shortest) +
                     " for a loose knot of this radius_m");
}

void check(const RingChain& p) {
  check_least("rings", p.rings, 1);
  check_least("segments", p.segments, 8, ": fewer do not make a round ring");
  const double shortest = open_ring_radii * p.radius_m;
  if (!(p.length_m >= shortest))
    throw SceneError("length_m is " + std::to_string(p.length_m) + "; must be at least " + std::to_string(shortest) +
                     " for rings of this radius_m to hang through each other");
  check_total("a chain", static_cast<double>(p.rings) * p.segments);
}

void check(const Bundle& p) {
  check_least("rods", p.rods, 1);
  check_least("segments", p.segments, 2, ": the first ones are held");
  if (!(p.initial_angle_deg >= 0 && p.initial_angle_deg <= 90))
    throw SceneError("initial_angle_deg is " + std::to_string(p.initial_angle_deg) +
                     "; must be from 0 to 90 for a bundle, whose rods must not cross");
  check_total("a bundle", static_cast<double>(p.rods) * p.segments);
}

template <class Parameters>
std::vector<Rod> build_rods(const Parameters& p) {
  return {build_rod(p)};
}

void add_loads(Scene& scene, const OpenRod& p) {
  if (p.tip_force_n.isZero()) return;
  const Rod& rod = scene.rods.front();
  const Vector3 tip(0, 0, rod.segments.back().length_m / 2);
  scene.loads.push_back({0, rod.segment_count() - 1, p.tip_force_n, Vector3::Zero(), tip});
}
void add_loads(Scene&, const RodParameters&) {}

/// Held segments that move on from where they are at a velocity.
void move_clamp(Scene& scene, int segment, const Vector3& velocity_m_s) {
  const Rod& rod = scene.rods.front();
  const auto s = static_cast<std::size_t>(segment);
  scene.clamps.push_back({0, segment, [from = rod.position[s], turned = rod.orientation[s], velocity_m_s](double t) {
                            return Pose{from + t * velocity_m_s, turned};
                          }});
}

void add_surroundings(Scene& scene, const FallingRods&) { scene.obstacles.emplace_back(HalfSpace{}); }
void add_surroundings(Scene& scene, const CoilingRod& p) {
  scene.obstacles.emplace_back(HalfSpace{});
  move_clamp(scene, 0, Vector3(0, -p.feed_m_s, 0));
}
void add_surroundings(Scene& scene, const Knot& p) {
  move_clamp(scene, 0, Vector3(-p.pull_m_s, 0, 0));
  move_clamp(scene, p.segments - 1, Vector3(p.pull_m_s, 0, 0));
}
void add_surroundings(Scene&, const RodParameters&) {}

int segments_of(const OpenRod& p) { return p.segments + (p.clamp == Clamp::wall ? 1 : 0); }
int segments_of(const Ring& p) { return p.segments; }
int segments_of(const Net& p) {
  return p.rows * ((p.columns - 1) * p.segments + 1) + p.columns * ((p.rows - 1) * p.segments + 1);
}

// With the ground's.
int segments_of(const Tree& p) { return edge_count(p.shape) + 1; }
int segments_of(const Forest& p) { return p.rows * p.columns * (edge_count(p.shape) + 1); }
int segments_of(const SkeletonTree& p) { return static_cast<int>(p.skeleton->size()); }

int segments_of(const FallingRods& p) { return p.rods * p.segments; }
int segments_of(const CoilingRod& p) { return p.segments; }
int segments_of(const Knot& p) { return p.segments; }
int segments_of(const RingChain& p) { return p.rings * p.segments; }
int segments_of(const Bundle& p) { return p.rods * p.segments; }

int rods_of(const RodParameters&) { return 1; }
int rods_of(const Forest& p) { return p.rows * p.columns; }
int rods_of(const FallingRods& p) { return p.rods; }
int rods_of(const RingChain& p) { return p.rings; }
int rods_of(const Bundle& p) { return p.rods; }

int joints_of(const OpenRod& p) { return segments_of(p) - 1; }
int joints_of(const Ring& p) { return p.segments; }
int joints_of(const Net& p) { return segments_of(p) - p.rows - p.columns + p.rows * p.columns; }
int joints_of(const Tree& p) { return segments_of(p) - 1; }
int joints_of(const Forest& p) { return segments_of(p) - rods_of(p); }
int joints_of(const SkeletonTree& p) { return segments_of(p) - 1; }
int joints_of(const FallingRods& p) { return segments_of(p) - rods_of(p); }
int joints_of(const CoilingRod& p) { return segments_of(p) - 1; }
int joints_of(const Knot& p) { return segments_of(p) - 1; }
int joints_of(const RingChain& p) { return segments_of(p); }
int joints_of(const Bundle& p) { return segments_of(p) - rods_of(p); }

}  // namespace

void validate(const SceneSpec& spec) {
  std::visit(
      [](const auto& p) {
        check(p);
        if (p.stretch == Stretch::physical && p.stretch_compliance_per_j)
          throw SceneError("stretch is physical, but stretch_compliance_per_j is given too; must be one of them");
      },
      spec);
}

Scene build_scene(const SceneSpec& spec) {
  validate(spec);
  return std::visit(
      [](const auto& p) {
        Scene scene;
        scene.rods = build_rods(p);
        scene.gravity_m_s2 = p.gravity_m_s2;
        scene.damping_per_s = p.damping_per_s;
        if (p.wind) scene.wind.emplace(*p.wind);
        scene.contact = p.contact;
        scene.obstacles = p.obstacles;
        add_loads(scene, p);
        add_surroundings(scene, p);
        return scene;
      },
      spec);
}

const OpenRod* open_rod(const SceneSpec& spec) {
  if (const auto* rod = std::get_if<BendingRod>(&spec)) return rod;
  return std::get_if<Helix>(&spec);
}

int segment_count(const SceneSpec& spec) {
  return std::visit([](const auto& p) { return segments_of(p); }, spec);
}

int joint_count(const SceneSpec& spec) {
  return std::visit([](const auto& p) { return joints_of(p); }, spec);
}

int rod_count(const SceneSpec& spec) {
  return std::visit([](const auto& p) { return rods_of(p); }, spec);
}

}  // namespace rodsweep
