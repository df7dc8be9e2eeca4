// Scenes for contact: their geometry and what each demonstrates. The knot stays a knot.
#include <algorithm>
#include <cmath>

#include "solver/numbers/rotation.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"
#include "tests/solver/touching.hpp"

namespace rodsweep::test_touching_scenes {

/// The determinant of a knot from the crossings of a closed polygon seen along z: 1 for the unknot, 3 for a trefoil.
/// One row per crossing: 2 for the upper arc, -1 for both arcs that end below it. One row and column are dropped.
long knot_determinant(const std::vector<Vector3>& polygon) {
  struct Passing {
    double place;  // along the polygon
    int crossing;
    bool below;
  };
  std::vector<Passing> passings;
  int crossings = 0;
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      const Vector3 a = polygon[i], u = polygon[(i + 1) % n] - a, b = polygon[j], v = polygon[(j + 1) % n] - b;
      const double det = u.x() * v.y() - u.y() * v.x();
      if (det == 0 || (i == 0 && j == n - 1)) continue;
      const Vector3 c = b - a;
      const double s = (c.x() * v.y() - c.y() * v.x()) / det, t = (c.x() * u.y() - c.y() * u.x()) / det;
      if (s < 0 || s >= 1 || t < 0 || t >= 1) continue;
      const bool a_below = a.z() + s * u.z() < b.z() + t * v.z();
      passings.push_back({static_cast<double>(i) + s, crossings, a_below});
      passings.push_back({static_cast<double>(j) + t, crossings++, !a_below});
    }
  if (crossings < 2) return 1;
  std::sort(passings.begin(), passings.end(), [](const Passing& p, const Passing& q) { return p.place < q.place; });
  test::MatrixX colours = test::MatrixX::Zero(crossings, crossings);
  int arc = 0;
  for (const Passing& passing : passings) {
    if (!passing.below) {
      colours(passing.crossing, arc) += 2;
      continue;
    }
    colours(passing.crossing, arc) -= 1;
    arc = (arc + 1) % crossings;
    colours(passing.crossing, arc) -= 1;
  }
  const Eigen::Index m = crossings - 1;
  return std::lround(std::abs(test::determinant(colours.topLeftCorner(m, m))));
}

/// A rod's axis as a polygon closed far beyond its ends at -x and x, rotated into a general direction.
std::vector<Vector3> closed_up(const Rod& rod) {
  std::vector<Vector3> polygon;
  for (std::size_t s = 0; s < rod.segments.size(); ++s)
    polygon.push_back(rod.position[s] - rod.segments[s].length_m / 2 * director(rod.orientation[s]));
  polygon.emplace_back(rod.position.back() + Vector3(50, 0.1, 0));
  polygon.emplace_back(0, 100, 0.3);
  polygon.emplace_back(rod.position.front() + Vector3(-50, 0.2, 0));
  const Quaternion turn(Eigen::AngleAxisd(0.3, Vector3(1, 2, 0.5).normalized()));
  for (Vector3& vertex : polygon) vertex = turn * vertex;
  return polygon;
}

template <class Spec>
Spec touching(int segments, double radius_m, double youngs_modulus_pa) {
  Spec p;
  p.segments = segments;
  p.radius_m = radius_m;
  p.youngs_modulus_pa = youngs_modulus_pa;
  p.contact = ContactSettings{};
  return p;
}

Knot knot() {
  Knot p = touching<Knot>(60, 0.015, 1e5);
  p.length_m = 2;
  p.torsion_modulus_pa = 4e4;
  p.gravity_m_s2.setZero();
  p.damping_per_s = 5;
  p.pull_m_s = 0.5;
  return p;
}

TEST_CASE("a knot starts as a loose overhand knot of the length asked for, its strands apart") {
  const Scene scene = build_scene(knot());
  const Rod& rod = scene.rods.front();
  CHECK(rod.segment_count() == 60);
  CHECK(rod_length(rod) == Approx(2).epsilon(0.01));
  CHECK(joint_gap(rod) < 1e-12);
  CHECK(knot_determinant(closed_up(rod)) == 3);
  CHECK(test::nearest(scene) > 1.02);
  for (const std::size_t end : {std::size_t{0}, rod.segments.size() - 1}) {
    CHECK(rod.segments[end].is_static);
    CHECK(director(rod.orientation[end]).x() > 0.95);
  }
}

TEST_CASE("a knot that is pulled tightens and stays a knot, with contact alone") {
  for (const bool contact : {true, false}) {
    Knot p = knot();
    if (!contact) p.contact.reset();
    test::Touching t(build_scene(p), 0.005);
    const auto span = [&t] { return (t.scene.rods[0].position.back() - t.scene.rods[0].position.front()).norm(); };
    double nearest = HUGE_VAL;
    int steps = 0;
    for (; steps < 400 && span() < (contact ? 1.55 : 1.9); ++steps) {
      t.step();
      if (contact) nearest = std::min(nearest, test::nearest(t.scene));
    }
    CHECK(steps < 400);
    CHECK(knot_determinant(closed_up(t.scene.rods[0])) == (contact ? 3 : 1));
    if (!contact) continue;
    CHECK(nearest > 0.99);
    CHECK(nearest < 1.001);
    CHECK(joint_gap(t.scene.rods[0]) < 1e-4);
  }
}

TEST_CASE("a heap never gains energy, be its rods thin or bouncing, and stays whole") {
  for (const Integrator integrator : {Integrator::euler, Integrator::bdf2})
    for (const double radius_m : {1e-3, 0.02})
      for (const double restitution : {0.0, 1.0}) {
        FallingRods p = touching<FallingRods>(6, radius_m, 1e8);
        p.torsion_modulus_pa = 4e7;
        p.length_m = 0.6;
        p.height_m = 5 * radius_m;
        p.contact->friction = 0.3;
        p.contact->restitution = restitution;
        test::Touching t(build_scene(p), 0.005, integrator);
        INFO("BDF2 " << (integrator == Integrator::bdf2) << ", radius " << radius_m << ", e " << restitution);
        const double start = mechanical_energy(t.scene);
        double least = start, gained = 0;
        for (int i = 0; i < 100; ++i) {
          t.step();
          least = std::min(least, mechanical_energy(t.scene));
          gained = std::max(gained, mechanical_energy(t.scene) - least);
        }
        CHECK(gained < 0.03 * (start - least));
        for (const Rod& rod : t.scene.rods) CHECK(joint_gap(rod) < 1e-3);
      }
}

TEST_CASE("a rod fed onto the floor coils there") {
  CoilingRod p = touching<CoilingRod>(30, 0.01, 1e5);
  p.length_m = 1;
  p.torsion_modulus_pa = 4e4;
  test::Touching t(build_scene(p), 0.005);
  CHECK(t.run(160) < 0.01);
  const Rod& rod = t.scene.rods[0];
  CHECK(joint_gap(rod) < 1e-3);
  CHECK(rod.position[0].y() == Approx(1.11 - 1.0 / 60 - 0.8).epsilon(1e-6));
  int lying = 0;
  for (const Vector3& at : rod.position) {
    CHECK(at.y() > 0.0099);
    lying += at.y() < 0.05;
  }
  CHECK(lying > 12);
  CHECK(test::nearest(t.scene) > 0.99);
}

TEST_CASE("the rings of a chain are linked, hang in each other and stay so") {
  RingChain p = touching<RingChain>(12, 0.02, 1e7);
  p.rings = 3;
  p.length_m = 1;
  Scene start = build_scene(p);
  CHECK(test::nearest(start) > 1);
  CHECK(segment_count(p) == 36);
  test::Touching t(start, 0.01);
  CHECK(t.run(80) < 0.01);
  for (int ring = 1; ring < 3; ++ring)  // the top of each ring is well above the bottom of the one before
    CHECK(t.scene.rods[ring].position[0].y() > t.scene.rods[ring - 1].position[6].y());
  CHECK(t.scene.rods[2].position[6].y() < -0.6);
}

TEST_CASE("a net with contact rests flat without contacts, also where it is held") {
  for (const Held held : {Held::side, Held::corners}) {
    Net p;
    p.held = held;
    p.gravity_m_s2.setZero();
    p.contact.emplace();
    CHECK(Simulation(build_scene(p), {0.01, 5, 1e-9}).step().contacts == 0);
  }
}

TEST_CASE("the counts of a scene are those of what is built") {
  RingChain rings;
  rings.radius_m = 0.02;
  Net net;
  net.segments = 3;
  net.rows = 2;
  Forest forest;
  forest.shape.depth = 2;
  forest.rows = 2;
  std::vector<SceneSpec> specs{
      FallingRods{}, CoilingRod{}, knot(), rings, Bundle{}, Ring{}, forest, Tree{}, test::bending_rod(5, Clamp::wall)};
  for (const Clamp clamp : {Clamp::segment, Clamp::wall, Clamp::free}) {
    Helix moved;
    moved.clamp = clamp;
    moved.tip_motion = TipMotion{Vector3(0.1, 0.2, 0), Vector3(0, 0, 90), 0.4};
    specs.push_back(moved);
  }
  for (const Held held : {Held::side, Held::corners, Held::free}) {
    net.held = held;
    specs.push_back(net);
  }
  for (const SceneSpec& spec : specs) {
    const Scene scene = build_scene(spec);
    int segments = 0, joints = 0;
    for (const Rod& rod : scene.rods) {
      segments += rod.segment_count();
      joints += rod.joint_count();
    }
    CHECK(segment_count(spec) == segments);
    CHECK(joint_count(spec) == joints);
    CHECK(rod_count(spec) == static_cast<int>(scene.rods.size()));
  }
}

TEST_CASE("scenes that could only start with rods inside each other are refused") {
  FallingRods flat;
  flat.height_m = 0.09;
  CHECK_THROWS_WITH(build_scene(flat), "height_m is 0.090000; must be at least 2 radius_m, or the rods overlap");
  Knot thick = knot();
  thick.radius_m = 0.1;
  CHECK_THROWS_WITH(build_scene(thick), Catch::Matchers::StartsWith("length_m is 2.000000; must be at least ") &&
                                            Catch::Matchers::EndsWith(" for a loose knot of this radius_m"));
  RingChain narrow;
  narrow.length_m = 1;
  narrow.radius_m = 0.03;
  CHECK_THROWS_WITH(build_scene(narrow),
                    Catch::Matchers::ContainsSubstring("must be at least 1.200000 for rings of this radius_m"));
  Bundle crossed;
  crossed.initial_angle_deg = -1;
  CHECK_THROWS_WITH(build_scene(crossed), Catch::Matchers::ContainsSubstring("must be from 0 to 90 for a bundle"));
}

}  // namespace rodsweep::test_touching_scenes
