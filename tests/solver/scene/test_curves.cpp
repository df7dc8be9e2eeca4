// Curves: a straight one is a bending rod; what is drawn in another order, direction or in parts moves alike.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "solver/numbers/rotation.hpp"
#include "solver/step/observables.hpp"
#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_curves {

using Catch::Matchers::ContainsSubstring;

Curve line(const std::vector<Vector3>& points) { return {"curve", points, {}, {}, {}, {}}; }

Curves curves(const std::vector<Curve>& drawn, double segment_m = 0.1) {
  Curves p;
  static_cast<RodParameters&>(p) = test::bending_rod(10);
  p.curves = std::make_shared<const std::vector<Curve>>(drawn);
  p.how.segment_m = segment_m;
  return p;
}

/// The positions of free segments in the order of their initial places.
std::vector<Vector3> positions(const Scene& initial, const Scene& now) {
  std::vector<std::pair<std::vector<double>, Vector3>> all;
  for (std::size_t r = 0; r < now.rods.size(); ++r)
    for (std::size_t s = 0; s < now.rods[r].segments.size(); ++s) {
      if (now.rods[r].segments[s].is_static) continue;
      const Vector3 at = initial.rods[r].position[s];
      std::vector<double> key;
      for (const double x : {at.x(), at.y(), at.z()}) key.push_back(std::round(1e6 * x));
      all.emplace_back(key, now.rods[r].position[s]);
    }
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Vector3> out;
  for (const auto& one : all) out.push_back(one.second);
  return out;
}

std::vector<Vector3> after(const Curves& p, int steps = 20) {
  const Scene initial = build_scene(p);
  Simulation simulation(initial, 0.01);
  simulation.run(steps);
  return positions(initial, simulation.scene);
}

double distance(const std::vector<Vector3>& one, const std::vector<Vector3>& other) {
  REQUIRE(one.size() == other.size());
  double most = 0;
  for (std::size_t i = 0; i < one.size(); ++i) most = std::max(most, (one[i] - other[i]).norm());
  return most;
}

TEST_CASE("equal curves are cut once, others anew") {
  const Curves p = curves({line({{0, 0, 0}, {1, 0, 0}}), line({{1, 0, 0}, {1, 1, 0}})});
  const auto changed = [&](const auto& change) {
    const auto graph = p.graph();
    Curves other = p;
    change(other);
    return other.graph() != graph;
  };
  CHECK_FALSE(changed([](Curves& c) { c.youngs_modulus_pa *= 2; }));
  CHECK(changed([](Curves& c) { c.curves = std::make_shared<const std::vector<Curve>>(*c.curves); }));
  CHECK(changed([](Curves& c) { c.unit_m = 2; }));
  CHECK(changed([](Curves& c) { c.radius_m *= 2; }));
  CHECK(changed([](Curves& c) { c.how.interpolation = Interpolation::spline; }));
  CHECK(changed([](Curves& c) { c.how.segment_m = 0.3; }));
  CHECK(changed([](Curves& c) { c.how.join_m = 1e-3; }));
  CHECK(changed([](Curves& c) { c.how.held = HeldPoints::ends; }));
  CHECK(changed([](Curves& c) { c.how.held_at_m = {{0, 0, 0}}; }));
}

TEST_CASE("a straight curve with a held end is the bending rod with a wall") {
  BendingRod rod = test::bending_rod(10, Clamp::wall);
  rod.length_m = 1;
  rod.initial_angle_deg = 0;
  const Scene expected = build_scene(rod);
  Curves p = curves({line({{0, 0, 0}, {0.4, 0, 0}, {1, 0, 0}})});
  static_cast<RodParameters&>(p) = rod;
  p.how.held_at_m = {{0, 0, 0}};
  const Scene found = build_scene(p);
  REQUIRE(found.rods.size() == 1);
  CHECK(size_of(p).segments == found.rods[0].segment_count());
  CHECK(size_of(p).joints == found.rods[0].joint_count());
  REQUIRE(found.rods[0].joint_count() == expected.rods[0].joint_count());
  const std::vector<Joint>& joints = found.rods[0].joints;
  for (std::size_t k = 1; k < joints.size(); ++k)  // numbered along the curve
    CHECK((joints[k].a == joints[k - 1].b || joints[k].a == joints[k - 1].a));
  for (const Stretch stretch : {Stretch::inextensible, Stretch::physical}) {
    rod.stretch = p.stretch = stretch;
    Simulation own(build_scene(p), 0.01), other(build_scene(rod), 0.01);
    const Scene initial = own.scene;
    own.run(20);
    other.run(20);
    CHECK(distance(positions(initial, own.scene), positions(expected, other.scene)) < 1e-9);
  }
}

/// Drawings of one thing, held at a point. Curve i of `radii` has that radius, if there are any.
struct Drawing {
  std::vector<Curve> curves;
  std::vector<double> radii = {};
};

TEST_CASE("what is drawn backwards, in parts, with more points or in another order moves alike, forks and loops too") {
  const Vector3 a(0, 0, 0), b(0.6, 0, 0), c(0.6, 0, 0.5), d(0, 0, 0.5);
  const Vector3 o(0, 0, 0), x(1, 0, 0), y(-0.5, 0, 0.8), z(-0.5, 0, -0.8), up(0, 0.9, 0.1);
  const std::tuple<Vector3, double, std::vector<Drawing>> things[] = {
      {a,
       0.1,
       {{{line({a, b, c})}},
        {{line({c, b, a})}},
        {{line({a, b}), line({b, c})}},
        {{line({c, b}), line({a, b})}},
        {{line({b, c}), line({b, a})}},
        {{line({a, 0.5 * b, b, c})}}}},
      {a, 0.1, {{{line({a, b, c, d, a})}}, {{line({c, b}), line({a, d}), line({a, b}), line({d, c})}}}},
      {x,
       0.25,
       {{{line({x, o}), line({o, y}), line({o, z})}, {0.05, 0.03, 0.02}},
        {{line({z, o}), line({x, o}), line({y, o})}, {0.02, 0.05, 0.03}},
        {{line({y, o}), line({o, z}), line({o, x})}, {0.03, 0.02, 0.05}}}},
      {x,
       0.25,
       {{{line({x, o}), line({o, y}), line({o, z})}},
        {{line({z, o}), line({y, o}), line({o, x})}},
        {{line({o, y}), line({x, o, z})}}}},
      {x, 0.25, {{{line({x, o, y}), line({z, o, up})}}, {{line({up, o, x}), line({y, o, z})}}}}};
  for (const auto& [held, segment_m, drawings] : things) {
    std::vector<Vector3> first;
    for (const Drawing& drawing : drawings) {
      Curves p = curves(drawing.curves, segment_m);
      std::vector<Curve> drawn = drawing.curves;
      for (std::size_t i = 0; i < drawing.radii.size(); ++i) drawn[i].radii.assign(2, drawing.radii[i]);
      p.curves = std::make_shared<const std::vector<Curve>>(drawn);
      p.how.held_at_m = {held};
      const std::vector<Vector3> now = after(p);
      if (first.empty()) first = now;
      CHECK(distance(first, now) < 1e-9);
    }
  }
}

TEST_CASE("given points stay, and pieces between them have at most the given length") {
  for (const double longest : {10.0, 0.3, 0.07}) {
    const Rod rod = build_scene(curves({line({{0, 0, 0}, {1, 0, 0}, {1, 0.5, 0}})}, longest)).rods[0];
    double length = 0;
    for (const Segment& segment : rod.segments) {
      length += segment.length_m;
      CHECK(segment.length_m < longest + 1e-12);
    }
    CHECK(length == Approx(1.5));
  }
}

TEST_CASE("a strut between two forks, a loop and curves apart have the segments and joints that they need") {
  const Vector3 a(0, 0, 0), b(1, 0, 0);
  Curves h = curves(
      {line({a, b}), line({a, {0, 0, 1}}), line({a, {0, 0, -1}}), line({b, {1, 0, 1}}), line({b, {1, 0, -1}})}, 2);
  CHECK(size_of(h).segments == 6);  // the strut is cut in two
  CHECK(size_of(h).joints == 5);
  CHECK(size_of(h).rods == 1);
  Curves loop = curves({line({a, b, {1, 1, 0}, a})}, 100);
  CHECK(size_of(loop).segments == 3);
  CHECK(size_of(loop).joints == 3);
  Curves apart = curves({line({a, b}), line({{0, 1, 0}, {1, 1, 0}})}, 0.5);
  CHECK(size_of(apart).rods == 2);
  CHECK(build_scene(apart).rods.size() == 2);
  apart.how.held = HeldPoints::ends;
  CHECK(size_of(apart).segments == 8);
  CHECK(size_of(apart).joints == 6);
}

TEST_CASE("a straight rest shape straightens a bent curve, a drawn one keeps it") {
  Curves p = curves({line({{0, 0, 0}, {0.5, 0, 0}, {0.9, 0.3, 0}})});
  p.gravity_m_s2.setZero();
  for (const bool straight : {false, true}) {
    p.rest_shape = straight ? Curves::RestShape::straight : Curves::RestShape::drawn;
    Simulation simulation(build_scene(p), 0.05);
    simulation.relax(1e-7);
    const Rod& rod = simulation.rod();
    const double kink = director(rod.orientation.front()).cross(director(rod.orientation.back())).norm();
    CHECK(kink == Approx(straight ? 0 : 0.6).margin(1e-4));
  }
}

// A frame of two legs, clamped at its foot and loaded across its plane at the tip, by the theory of beams: both legs bend,
// and the first is twisted by the second.
TEST_CASE("an L-shaped frame sags as beams do, in one curve or in two") {
  constexpr double first = 1, second = 0.5, load_n = 1e-3;
  const Vector3 foot(0, 0, 0), corner(first, 0, 0), end(first, 0, second);
  for (const auto& drawn :
       {std::vector<Curve>{line({foot, corner, end})}, {line({end, corner}), line({foot, corner})}}) {
    Curves p = curves(drawn, 0.025);
    p.radius_m = 0.02;
    p.youngs_modulus_pa = 1e6;
    p.torsion_modulus_pa = 4e5;
    p.gravity_m_s2.setZero();
    p.stretch = Stretch::physical;
    p.how.held_at_m = {foot};
    p.prescribed.loads.push_back({end, {0, load_n, 0}, {0, 0, 0}, {}});
    Simulation simulation(build_scene(p), 1, 40, 1e-10);
    simulation.relax(1e-10);
    const double inertia = pi * std::pow(p.radius_m, 4) / 4, area = pi * p.radius_m * p.radius_m;
    const double bending = 1 / (3 * p.youngs_modulus_pa * inertia), twisting = 1 / (p.torsion_modulus_pa * 2 * inertia);
    const double shear =
        1 / (circle(p.radius_m, poisson_number(1e6, 4e5)).shear_coefficient * p.torsion_modulus_pa * area);
    const double expected = load_n * (bending * (std::pow(first, 3) + std::pow(second, 3)) +
                                      twisting * first * second * second + shear * (first + second));
    Vector3 tip(0, 0, 0);  // the end of a segment that is the farthest along z
    const Rod& rod = simulation.rod();
    for (std::size_t s = 0; s < rod.segments.size(); ++s)
      for (const double side : {-0.5, 0.5}) {
        const Vector3 at = rod.position[s] + side * rod.segments[s].length_m * director(rod.orientation[s]);
        if (at.z() > tip.z()) tip = at;
      }
    CHECK(tip.y() == Approx(expected).epsilon(1e-3));
  }
}

/// A spline through points of the unit circle, `turn` apart, from (1, 0, 0); `last` is the last one.
Rod spline(int pieces, double turn, double segment_m, const Vector3& last, double join_m = 0) {
  std::vector<Vector3> points;
  for (int i = 0; i < pieces; ++i) points.emplace_back(std::cos(i * turn), std::sin(i * turn), 0);
  points.push_back(last);
  Curves p = curves({line(points)}, segment_m);
  p.how.interpolation = Interpolation::spline;
  p.how.join_m = join_m;
  return build_scene(p).rods[0];
}

TEST_CASE("a spline through points of a circle is a circle, also through its ends") {
  for (const bool closed : {false, true}) {
    const Rod rod = spline(12, pi / (closed ? 6 : 12), 0.05, {closed ? 1.0 : -1.0, 0, 0});
    CHECK(rod.joint_count() == rod.segment_count() - (closed ? 0 : 1));
    for (const Vector3& at : rod.position) CHECK(at.norm() == Approx(1).margin(closed ? 0.003 : 0.01));
  }
}

/// The sines of the angles between neighbours at rest.
std::vector<double> kinks(const Rod& rod) {
  std::vector<double> out;
  for (const Joint& joint : rod.joints)
    out.push_back(director(rod.orientation[static_cast<std::size_t>(joint.a)])
                      .cross(director(rod.orientation[static_cast<std::size_t>(joint.b)]))
                      .norm());
  return out;
}
TEST_CASE("the bends of a spline do not depend on how finely it is cut") {
  const auto bending = [](double segment_m) {  // the integral of the squared curvature
    double sum = 0;
    for (const double kink : kinks(spline(8, pi / 4, segment_m, {1, 0, 0}))) sum += kink * kink / segment_m;
    return sum;
  };
  const double fine = bending(0.01);
  CHECK(bending(0.05) == Approx(fine).epsilon(0.02));
  CHECK(bending(0.002) == Approx(fine).epsilon(0.02));
}

TEST_CASE("a curve that turns back exactly is open, and has the energy of one that almost does") {
  const auto scene = [](const Vector3& there, const Vector3& back) {
    Curves p = curves({line({{0, 0, 0}, there, back})}, 0);
    p.rest_shape = Curves::RestShape::straight;
    return build_scene(p).rods[0];
  };
  const double expected = elastic_energy(scene({1, 0, 0}, {0, 1e-5, 0}));
  for (const Vector3& there : {Vector3(1, 0, 0), Vector3(0, 0, 1), Vector3(0, -0.6, 0.8)})
    for (const double rounding : {0.0, 1.2e-16}) {
      const Rod rod = scene(there, {0, rounding, 0});
      CHECK(rod.joint_count() == 1);
      CHECK(elastic_energy(rod) == Approx(expected).epsilon(1e-6));
    }
}

TEST_CASE("a spline is closed if its ends meet, be it with a rounded last point or within join_m") {
  const auto greatest_kink = [](double gap) {
    const std::vector<double> all = kinks(spline(8, pi / 4, 0.05, {1, -gap, 0}, gap > 1e-6 ? 0.03 : 0));
    return *std::max_element(all.begin(), all.end());
  };
  const double closed = greatest_kink(0);
  CHECK(closed < 0.1);
  CHECK(greatest_kink(2.4e-16) == Approx(closed).epsilon(1e-9));
  CHECK(greatest_kink(0.02) < 0.12);
}

TEST_CASE("curves that meet within join_m move to the middle of the gap and are at rest there") {
  Curves p = curves({line({{0, 0, 0}, {1, 0, 0}}), line({{1.01, 0, 0}, {2.01, 0, 0}})});
  p.how.join_m = 0.02;
  p.gravity_m_s2.setZero();
  CHECK(joining_shift(*p.curves, p.how.join_m) == Approx(0.005));
  CHECK(joining_shift(*p.curves, 0.001) == 0);
  Simulation simulation(build_scene(p), 0.001);
  const Rod start = simulation.rod();
  REQUIRE(start.joint_count() == start.segment_count() - 1);
  double length = 0;
  for (const Segment& segment : start.segments) length += segment.length_m;
  CHECK(length == Approx(2.01));
  simulation.run(5);
  for (std::size_t s = 0; s < start.segments.size(); ++s)
    CHECK((simulation.rod().position[s] - start.position[s]).norm() < 1e-12);
}

TEST_CASE("where curves meet within join_m does not depend on their order") {
  const Curve one = line({{0, 0, 0}, {1, 0, 0}}), two = line({{1.01, 0, 0}, {1, 1, 0}}),
              three = line({{1, 0.01, 0.01}, {0.5, -1, 0}});
  const auto joined = [](const std::vector<Curve>& drawn) {
    Curves p = curves(drawn, 0.3);
    p.how.join_m = 0.03;
    p.how.held_at_m = {{0, 0, 0}};
    const Scene scene = build_scene(p);
    return positions(scene, scene);
  };
  const std::vector<Vector3> expected = joined({one, two, three});
  CHECK(distance(expected, joined({three, one, two})) < 1e-12);
  CHECK(distance(expected, joined({two, three, one})) < 1e-12);
}

TEST_CASE("radii and materials of curves are their own") {
  Curve thick = line({{0, 0, 0}, {1, 0, 0}});
  thick.radii = {0.02, 0.04};
  thick.density_kg_m3 = 2000;
  const Scene scene = build_scene(curves({thick, line({{0, 1, 0}, {1, 1, 0}})}, 0.001));
  double mass = 0;
  for (const Segment& segment : scene.rods[0].segments) mass += segment.mass;
  CHECK(mass == Approx(2000 * pi / 3 * (0.02 * 0.02 + 0.02 * 0.04 + 0.04 * 0.04)));
  CHECK(scene.rods[1].segments[0].radius_m == test::bending_rod(10).radius_m);
}

TEST_CASE("curves that cannot be rods are refused") {
  CHECK_THROWS_WITH(build_scene(curves({line({{0, 0, 0}})})), ContainsSubstring("need a curve of two points"));
  CHECK_THROWS_WITH(build_scene(curves({line({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}})})),
                    ContainsSubstring("point 3 of curve is at [1, 0, 0], as the one before"));
  Curves closed = curves({line({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}})});
  closed.how.interpolation = Interpolation::spline;
  CHECK_THROWS_WITH(build_scene(closed), ContainsSubstring("a closed spline needs at least 4"));
}

}  // namespace rodsweep::test_curves
