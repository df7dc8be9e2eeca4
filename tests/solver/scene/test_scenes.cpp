// Rods and scenes: masses, geometry, rest states, compliances, refusals.
#include <cmath>
#include <limits>
#include <string>

#include "solver/numbers/narrow.hpp"
#include "solver/numbers/rotation.hpp"
#include "solver/step/observables.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_scenes {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

SegmentSpec good_segment() {
  SegmentSpec s;
  s.length_m = 0.2;
  s.radius_m = 0.05;
  s.density_kg_m3 = 1000;
  return s;
}

JointSpec good_joint() {
  JointSpec j;
  j.a = 0;
  j.b = 1;
  return j;
}

TEST_CASE("a static segment cannot be moved, and may have neither size nor mass") {
  SegmentSpec wall;
  wall.is_static = true;
  const Rod rod({wall, good_segment()}, {good_joint()});
  CHECK(rod.segments[0].inverse_mass == 0);
  CHECK(rod.segments[0].inverse_inertia_transverse == 0);
  CHECK(rod.segments[0].inverse_inertia_axial == 0);
  CHECK(rod.joints[0].length == Approx(0.1));
}

TEST_CASE("the rest rotation is the initial one unless given, with a real part of at least zero") {
  SegmentSpec a = good_segment(), b = good_segment();
  a.orientation = Quaternion(Eigen::AngleAxisd(0.4, Vector3::UnitX()));
  b.orientation = Quaternion(Eigen::AngleAxisd(1.1, Vector3::UnitX()));
  b.orientation.coeffs() *= -1;
  const Rod rod({a, b}, {good_joint()});
  const Quaternion expected(Eigen::AngleAxisd(0.7, Vector3::UnitX()));
  CHECK((rod.joints[0].rest().coeffs() - expected.coeffs()).norm() < 1e-15);
  JointSpec straight = good_joint();
  straight.rest = Quaternion(-1, 0, 0, 0);
  CHECK((Rod({a, b}, {straight}).joints[0].rest().coeffs() - Quaternion::Identity().coeffs()).norm() == 0);
}

TEST_CASE("impossible segments are refused with quantity, value and bound") {
  using S = SegmentSpec;
  const std::pair<void (*)(S&), const char*> refused[] = {
      {[](S& s) { s.length_m = 0; }, "length_m is 0; must be positive and finite (zero only when static)"},
      {[](S& s) { s.length_m = -0.5; }, "length_m is -0.5; must be positive"},
      {[](S& s) { s.length_m = infinity; }, "length_m is inf; must be positive"},
      {[](S& s) {
         s.length_m = nan;
         s.is_static = true;
       },
       "length_m is nan; must be positive"},
      {[](S& s) { s.radius_m = -1e-9; }, "radius_m is -1e-09; must be positive and finite"},
      {[](S& s) { s.density_kg_m3 = 0; }, "density_kg_m3 is 0; must be positive and finite"},
      {[](S& s) { s.position_m.y() = nan; }, "position is not finite"},
      {[](S& s) { s.orientation = Quaternion(2, 0, 0, 0); }, "orientation norm is 2; must be 1"},
      {[](S& s) { s.radius_m = 1e-200; }, "mass is 0; must be large enough to be inverted"},
  };
  for (const auto& [change, what] : refused) {
    std::vector<S> segments(3, good_segment());
    change(segments[1]);
    CHECK_THROWS_AS(Rod(segments, {}), SceneError);
    CHECK_THROWS_WITH(Rod(segments, {}), Catch::Matchers::StartsWith(std::string("segment 1: ") + what));
  }
  CHECK_THROWS_WITH(Rod({}, {}), "a rod needs at least one segment");
}

TEST_CASE("impossible joints are refused with quantity, value and bound") {
  using J = JointSpec;
  const std::pair<void (*)(J&), const char*> refused[] = {
      {[](J& j) { j.a = 3; }, "segment a is 3; must be from 0 to 2"},
      {[](J& j) { j.b = -1; }, "segment b is -1; must be from 0 to 2"},
      {[](J& j) { j.b = 0; }, "segment b is 0; must be different from segment a"},
      {[](J& j) { j.compliance_per_j[4] = -1; }, "compliance of row 4 is -1; must be finite and at least 0"},
      {[](J& j) { j.compliance_per_j[0] = infinity; }, "compliance of row 0 is inf; must be finite and at least 0"},
      {[](J& j) { j.arm_b_m.z() = nan; }, "an arm is not finite"},
      {[](J& j) { j.rest = Quaternion(0, 0, 0, 0); }, "norm of the rest rotation is 0; must be 1"},
      {[](J& j) { j.frame = Quaternion(2, 0, 0, 0); }, "norm of the frame's rotation is 2; must be 1"},
  };
  for (const auto& [change, what] : refused) {
    std::vector<J> joints(2, good_joint());
    change(joints[1]);
    CHECK_THROWS_AS(Rod(std::vector(3, good_segment()), joints), SceneError);
    CHECK_THROWS_WITH(Rod(std::vector(3, good_segment()), joints), std::string("joint 1: ") + what);
  }
  SegmentSpec wall;
  wall.is_static = true;
  CHECK_THROWS_WITH(Rod({wall, wall}, {good_joint()}),
                    Catch::Matchers::StartsWith("joint 0: length is 0; must be positive"));
}

TEST_CASE("a bending rod runs from the origin at its angle, straight and at rest") {
  for (const Clamp clamp : {Clamp::segment, Clamp::wall, Clamp::free}) {
    BendingRod spec = test::bending_rod(7, clamp);
    spec.length_m = 3;
    spec.initial_angle_deg = 30;
    const Scene scene = build_scene(spec);
    const Rod& rod = scene.rods.front();
    REQUIRE(rod.joint_count() == rod.segment_count() - 1);
    const Vector3 along(std::sqrt(3) / 2, 0.5, 0);
    for (int s = 0; s < rod.segment_count(); ++s) {
      const int i = clamp == Clamp::wall ? s - 1 : s;
      const double at = i < 0 ? 0 : (i + 0.5) * 3 / 7;
      CHECK((rod.position[s] - at * along).norm() < 1e-14);
      CHECK((director(rod.orientation[s]) - along).norm() < 1e-14);
      CHECK(rod.segments[s].length_m == Approx(i < 0 ? 0 : 3.0 / 7));
      CHECK(rod.segments[s].is_static == (s == 0 && clamp != Clamp::free));
      CHECK(rod.velocity[s].norm() + rod.angular_velocity[s].norm() == 0);
    }
    CHECK(rod_length(rod) == Approx(3).epsilon(1e-13));
    CHECK(test::constraint_of(rod).lpNorm<Eigen::Infinity>() < 1e-13);
    CHECK(rod.joints[0].length == Approx(clamp == Clamp::wall ? 3.0 / 14 : 3.0 / 7));
  }
}

TEST_CASE(
    "a helix is at rest with its joints on the curve, hangs from its first end, and no joint twists about its "
    "segment") {
  for (const Clamp clamp : {Clamp::segment, Clamp::wall, Clamp::free}) {
    Helix spec;
    spec.segments = 45;
    spec.clamp = clamp;
    spec.helix_radius_m = 0.45;
    spec.helix_height_m = 0.6;
    spec.windings = 2.25;
    const Rod rod = build_scene(spec).rods.front();
    CHECK(test::constraint_of(rod).lpNorm<Eigen::Infinity>() < 1e-13);
    for (int k = 0; k < rod.joint_count(); ++k) {
      const Joint& joint = rod.joints[k];
      const int vertex = clamp == Clamp::wall ? k : k + 1;
      const double t = 2 * pi * spec.windings * vertex / spec.segments;
      const Vector3 on_curve(0.45 * std::cos(t), -0.6 * vertex / spec.segments, 0.45 * std::sin(t));
      CHECK((rod.position[joint.a] + rod.orientation[joint.a] * joint.arm_a - on_curve).norm() < 1e-12);
      CHECK(std::abs(joint.rest().z()) < 1e-14);
    }
    CHECK(rod.position.front().y() > rod.position.back().y());
  }
}

TEST_CASE("the default stretch compliance is that of the rod's weight and tip force") {
  BendingRod spec = test::bending_rod(5);
  const double weight = 1000 * pi * 0.0025 * 2 * 9.81, l = 0.4;
  CHECK(build_scene(spec).rods[0].joints[1].compliance[0] == Approx(1e-7 / (l * weight)).epsilon(1e-12));
  spec.tip_force_n = {0, 0, 300};
  CHECK(build_scene(spec).rods[0].joints[1].compliance[0] == Approx(1e-7 / (l * (weight + 300))).epsilon(1e-12));
}

TEST_CASE("scenes with too few segments are refused") {
  CHECK_THROWS_WITH(build_scene(test::bending_rod(1)),
                    Catch::Matchers::StartsWith("segments is 1; must be at least 2: the clamp"));
  CHECK_THROWS_WITH(build_scene(test::bending_rod(0, Clamp::wall)), "segments is 0; must be at least 1");
  Helix helix;
  helix.segments = -3;
  helix.clamp = Clamp::free;
  CHECK_THROWS_WITH(build_scene(helix), "segments is -3; must be at least 1");
  CHECK_THROWS_AS(build_scene(helix), SceneError);
}

TEST_CASE("a scene of more rods than results can number is refused with the keys, their value and the bound") {
  const auto refused = [](const SceneSpec& spec, const std::string& keys) {
    CHECK_THROWS_WITH(validate(spec), Catch::Matchers::StartsWith(keys + " is 32768; must be at most 32767") &&
                                          Catch::Matchers::ContainsSubstring("several scenes"));
  };
  Forest forest;
  forest.shape.depth = 0;
  forest.rows = 7 * 31;
  forest.columns = 151;
  CHECK_NOTHROW(validate(forest));
  CHECK(rod_count(forest) == most_rods);
  forest.rows = 256;
  forest.columns = 128;
  refused(forest, "rows x columns");
  FallingRods heap;
  Bundle bundle;
  RingChain chain;
  chain.radius_m = 0.01;
  heap.rods = bundle.rods = chain.rings = most_rods;
  for (const SceneSpec& spec : {SceneSpec(heap), SceneSpec(bundle), SceneSpec(chain)}) CHECK_NOTHROW(validate(spec));
  heap.rods = bundle.rods = chain.rings = most_rods + 1;
  refused(heap, "rods");
  refused(bundle, "rods");
  refused(chain, "rings");
}

TEST_CASE("a number that does not fit into its bits is a bug, not another number") {
  CHECK(narrow<std::int16_t>(32767) == 32767);
  CHECK(narrow<std::int16_t>(-32768) == -32768);
  CHECK_THROWS_WITH(narrow<std::int16_t>(32768), "32768 does not fit into 16 bits");
  CHECK_THROWS_WITH(narrow<std::int16_t>(-32769), "-32769 does not fit into 16 bits");
}

}  // namespace rodsweep::test_scenes
