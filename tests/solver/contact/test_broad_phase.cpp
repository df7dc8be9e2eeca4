// Pairs of boxes against brute force, pairs kept between steps, and segments of a rod that can touch.
#include <optional>
#include <set>
#include <utility>

#include "solver/contact/contact_bodies.hpp"
#include "solver/scene/scene_parts.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_broad_phase {

std::vector<Box> random_boxes(int count, unsigned seed) {
  test::Random random(seed);
  std::vector<Box> boxes;
  for (int i = 0; i < count; ++i) {
    const Vector3 at = random.vector(2);
    boxes.push_back({at, at + random.uniform(0.01, 0.5) * (Vector3::Ones() + random.vector(0.9))});
  }
  return boxes;
}

std::set<std::pair<int, int>> set_of(const std::vector<Pair>& pairs) {
  std::set<std::pair<int, int>> out;
  for (const Pair& pair : pairs) out.emplace(pair.a, pair.b);
  return out;
}

/// True for all pairs except two odd numbers.
bool matters(int a, int b) { return a % 2 == 0 || b % 2 == 0; }
std::set<std::pair<int, int>> searched(const std::vector<Box>& boxes, double margin) {
  std::set<std::pair<int, int>> out;
  for (int a = 0; a < static_cast<int>(boxes.size()); ++a)
    for (int b = a + 1; b < static_cast<int>(boxes.size()); ++b)
      if (matters(a, b) && grown(boxes[a], margin).intersects(grown(boxes[b], margin))) out.emplace(a, b);
  return out;
}

TEST_CASE("the pairs of boxes that meet are those of brute force, sorted") {
  for (const int count : {0, 1, 2, 50, 400}) {
    const std::vector<Box> boxes = random_boxes(count, 3);
    BroadPhase broad_phase(std::vector<double>(boxes.size(), 0.0), matters);
    const std::vector<Pair>& pairs = broad_phase.pairs(boxes);
    CHECK(set_of(pairs) == searched(boxes, 0));
    CHECK(set_of(pairs).size() == pairs.size());
    for (std::size_t i = 1; i < pairs.size(); ++i)
      CHECK(std::pair(pairs[i - 1].a, pairs[i - 1].b) < std::pair(pairs[i].a, pairs[i].b));
  }
}

TEST_CASE("pairs are searched anew only when a box has left its margin, and none is missed meanwhile") {
  std::vector<Box> boxes = random_boxes(200, 4);
  const std::vector<Box> start = boxes;
  BroadPhase broad_phase(std::vector<double>(boxes.size(), 0.1), matters);
  CHECK(set_of(broad_phase.pairs(boxes)) == searched(boxes, 0.1));
  test::Random random(5);
  for (int step = 0; step < 20; ++step) {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const Vector3 by = random.vector(0.09);
      boxes[i] = {start[i].min() + by, start[i].max() + by};
    }
    const auto kept = set_of(broad_phase.pairs(boxes));
    for (const auto& pair : searched(boxes, 0)) CHECK(kept.count(pair) == 1);
  }
  CHECK(broad_phase.searches() == 1);
  boxes[7].max().x() = start[7].max().x() + 0.11;
  broad_phase.pairs(boxes);
  CHECK(broad_phase.searches() == 2);
}

/// The first segment of a straight rod that can touch segment 0.
int first_that_matters(double segment_length_m, double radius_m) {
  BendingRod p;
  p.segments = 40;
  p.length_m = 40 * segment_length_m;
  p.radius_m = radius_m;
  const ContactBodies bodies(build_scene(p));
  int s = 1;
  while (s < 40 && !bodies.matter(0, s)) ++s;
  return s;
}

TEST_CASE("segments less than pi radii apart along their rod never touch") {
  CHECK(first_that_matters(1, 0.1) == 2);      // excludes joint neighbours only
  CHECK(first_that_matters(1, 0.31) == 2);     // one segment between: 1 > 0.97
  CHECK(first_that_matters(1, 0.33) == 3);     // 1 < 1.04
  CHECK(first_that_matters(0.05, 0.05) == 5);  // three between: 3 < pi, four: 4 > pi
}

TEST_CASE("static pairs and segments without radius never touch; branches that leave one point do not either") {
  Scene scene = build_scene(test::bending_rod(10, Clamp::wall));
  scene.obstacles.push_back(Ball{});
  scene.obstacles.push_back(Capsule{});
  const ContactBodies bodies(scene);
  REQUIRE(bodies.count() == 13);
  CHECK_FALSE(bodies.matter(0, 9));    // the wall has no radius
  CHECK_FALSE(bodies.matter(11, 12));  // two obstacles
  CHECK(bodies.matter(3, 11));
  CHECK(bodies.matter(2, 9));

  const std::vector<SegmentSpec> segments(3, segment_at(Vector3::Zero(), Quaternion::Identity(), 1, RodParameters{}));
  std::vector<JointSpec> joints;
  for (const int branch : {1, 2})
    joints.push_back({0, branch, {0, 0, 0.5}, {0, 0, -0.5}, Vector6::Zero(), std::nullopt});
  Scene fork;
  fork.rods.emplace_back(segments, joints);
  CHECK_FALSE(ContactBodies(fork).matter(1, 2));
  joints[1].arm_a_m = {0, 0, 0.3};
  fork.rods = {Rod(segments, joints)};
  CHECK_FALSE(ContactBodies(fork).matter(1, 2));  // they start inside each other
  joints[1].rest = Quaternion(Eigen::AngleAxisd(pi / 2, Vector3::UnitX()));
  fork.rods = {Rod(segments, joints)};
  CHECK(ContactBodies(fork).matter(1, 2));
}

/// Number of pairs that can touch and that overlap.
int overlapping_pairs(const Scene& scene) {
  const ContactBodies bodies(scene);
  std::vector<CapsuleAxis> axes;
  bodies.place(scene, axes);
  int count = 0;
  for (int a = 0; a < bodies.count(); ++a)
    for (int b = a + 1; b < bodies.count(); ++b)
      count += bodies.matter(a, b) &&
               separation(axes[a], axes[b]).norm() < (1 - 1e-9) * (bodies.body(a).radius + bodies.body(b).radius);
  return count;
}

TEST_CASE(
    "what overlaps beside a fork where no joint is strained never touches, be its angle ever so sharp; its tips may") {
  for (const bool held : {false, true})
    for (const double angle : {0.0, 0.02, 0.1, 0.2, 0.4, 1.0, 1.5})
      for (const double length : {0.02, 0.05, 0.17})
        for (const double ratio : {1.0, 0.6}) {
          const double radius = 0.05;
          RodParameters p;
          p.radius_m = radius;
          std::vector<SegmentSpec> segments{segment_at(Vector3::Zero(), Quaternion::Identity(), held ? 0 : length, p)};
          segments[0].is_static = held;
          if (held) segments[0].radius_m = 0;
          std::vector<JointSpec> joints;
          std::vector<int> tips;
          for (const double side : {-0.5, 0.5}) {
            const double piece = side < 0 ? length : ratio * length;
            const Quaternion turn(Eigen::AngleAxisd(side * angle, Vector3::UnitX()));
            const Vector3 along = turn * Vector3(0, 0, piece), from(0, 0, held ? 0 : length / 2);
            for (int i = 0; (i + 1) * piece <= 1; ++i) {
              const int b = static_cast<int>(segments.size());
              segments.push_back(segment_at(from + (i + 0.5) * along, turn, piece, p));
              joints.push_back(joint_between(segments, i == 0 ? 0 : b - 1, b, p, 1));
            }
            tips.push_back(static_cast<int>(segments.size()) - 1);
          }
          Scene scene;
          scene.rods.emplace_back(segments, joints);
          CAPTURE(held, angle, length, ratio);
          CHECK(overlapping_pairs(scene) == 0);
          CHECK(ContactBodies(scene).matter(tips[0], tips[1]) == (angle > 2 * radius));
        }
}

TEST_CASE("nothing in a lattice at rest touches, however thick its rods and however they are divided") {
  for (const auto cell : {Lattice::Cell::cubic, Lattice::Cell::body_centred, Lattice::Cell::octet})
    for (const int segments : {1, 2, 5, 8})
      for (const double radius : {0.01, 0.02, 0.03}) {
        Lattice p = test::lattice_of(cell, 2, segments, Held::free);
        p.radius_m = radius;
        CHECK(overlapping_pairs(build_scene(p)) == 0);
      }
}

TEST_CASE("which segments may touch does not depend on how the rods are bent") {
  Lattice p = test::lattice_of(Lattice::Cell::octet, 2);
  p.radius_m = 0.02;
  Scene scene = build_scene(p);
  const ContactBodies before(scene);
  test::Random random(5);
  for (Quaternion& q : scene.rods[0].orientation) q = random.quaternion();
  for (Vector3& x : scene.rods[0].position) x = random.vector(1);
  const ContactBodies after(scene);
  for (int a = 0; a < before.count(); ++a)
    for (int b = a + 1; b < before.count(); ++b) CHECK(before.matter(a, b) == after.matter(a, b));
}

TEST_CASE("obstacles that are none are refused") {
  Scene scene = build_scene(test::bending_rod(3));
  scene.obstacles = {Ball{{0, 0, 0}, 0}};
  CHECK_THROWS_WITH(ContactBodies(scene), "an obstacle's radius is 0.000000; must be positive and finite");
  scene.obstacles = {Ball{{0, NAN, 0}, 1}};
  CHECK_THROWS_WITH(ContactBodies(scene), Catch::Matchers::ContainsSubstring("not finite"));
}

}  // namespace rodsweep::test_broad_phase
