// Rods as functions of arc length: positions of joints, independence of the number of segments, refusals.
#include <algorithm>
#include <utility>

#include "network/guess/knn.hpp"
#include "solver/numbers/rotation.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_chain_profile {

const Vector3 gravity(0, -9.81, 0);

Tensor<float> loads_of(const ChainProfile& profile, const VectorX& multipliers, double dt) {
  Tensor<float> out(6, multipliers.size() / 6);
  profile.loads(multipliers, dt, out);
  return out;
}

TEST_CASE("joints lie on the free part of the rod, from the held end on") {
  const auto arc = [](Clamp clamp) {
    return ChainProfile(build_scene(test::bending_rod(5, clamp)).rods[0], gravity).arc();
  };
  CHECK_THAT(arc(Clamp::segment), Catch::Matchers::Approx(std::vector<float>{0, .25, .5, .75}));
  CHECK_THAT(arc(Clamp::wall), Catch::Matchers::Approx(std::vector<float>{0, .2F, .4F, .6F, .8F}));
  CHECK_THAT(arc(Clamp::free), Catch::Matchers::Approx(std::vector<float>{.2F, .4F, .6F, .8F}));
}

TEST_CASE("a linear profile is resampled exactly, between the joints and beyond them, and from one joint alone") {
  const std::vector<float> from{.1F, .3F, .35F, .8F}, to{0, .1F, .2F, .5F, .8F, 1};
  Tensor<float> values(2, 4), out = Tensor<float>::Ones(2, 6);
  for (Eigen::Index i = 0; i < 4; ++i) values.col(i) << 2 + 3 * from[i], 1;
  add_resampled(from, values, to, .5F, out);
  for (Eigen::Index i = 0; i < 6; ++i) {
    CHECK(out(0, i) == Approx(1 + .5 * (2 + 3 * to[i])));
    CHECK(out(1, i) == Approx(1.5));
  }
  Tensor<float> one(1, 1), everywhere = Tensor<float>::Zero(1, 3);
  one << 4;
  add_resampled({.5F}, one, {0, .5F, 1}, 1, everywhere);
  CHECK((everywhere.array() == 4).all());
}

TEST_CASE("loads become multipliers again, forces and torques in their units") {
  const Rod rod = build_scene(test::bending_rod(4)).rods[0];
  const ChainProfile profile(rod, gravity);
  test::Random random(3);
  const VectorX multipliers = random.entries(18);
  const double dt = 0.01;
  const Tensor<float> loads = loads_of(profile, multipliers, dt);
  double mass = 0, length = 0;
  for (std::size_t s = 1; s < 4; ++s) {
    mass += rod.segments[s].mass;
    length += rod.segments[s].length_m;
  }
  CHECK(loads(1, 2) == Approx(multipliers[13] / (rod.joints[2].length * dt * dt) / (mass * 9.81)));
  CHECK(loads(5, 2) == Approx(multipliers[17] / (dt * dt) / (mass * 9.81 * length)));
  VectorX back(18);
  profile.multipliers(loads, dt, back);
  CHECK((back - multipliers).norm() < 1e-6 * multipliers.norm());
  CHECK((loads_of(profile, 4 * multipliers, 2 * dt) - loads).norm() < 1e-6 * loads.norm());
}

TEST_CASE("the weight of the rod hangs on its first joint, however it is divided") {
  for (const int segments : {10, 20, 40}) {
    Scene scene = build_scene(test::bending_rod(segments, Clamp::wall));
    Rod& rod = scene.rods[0];
    for (std::size_t s = 1; s < rod.segments.size(); ++s) {  // straight down
      rod.orientation[s] = turn_between(Vector3(0, 0, 1), Vector3(0, -1, 0));
      rod.position[s] = Vector3(0, -(static_cast<double>(s) - 0.5) * rod.segments[s].length_m, 0);
    }
    rod.orientation[0] = rod.orientation[1];
    for (Joint& joint : rod.joints) set_rest(joint, Quaternion::Identity());
    const double dt = 0.02;
    for (std::size_t s = 1; s < rod.segments.size(); ++s) rod.position[s] += dt * dt * gravity;  // free fall of a step
    const LinearSystem system = test::assembled(rod, dt);
    VectorX solution(system.rhs().size());
    DirectSolve(scene).solve(system, {}, 0, solution);
    const ChainProfile profile(rod, gravity);
    const Tensor<float> loads = loads_of(profile, solution, dt);
    CHECK(std::abs(loads(2, 0)) == Approx(1).epsilon(1e-3));  // along the rod
    for (Eigen::Index i = 0; i < loads.cols(); ++i)
      CHECK(std::abs(loads(2, i)) == Approx(1 - profile.arc()[i]).margin(1e-3));
  }
}

TEST_CASE("a rod that turns about its held end has the same state however it is divided") {
  KnnSet::Query queries[2];
  for (const int twice : {0, 1}) {
    Scene scene = build_scene(test::bending_rod(twice ? 24 : 12, Clamp::wall));
    Rod& rod = scene.rods[0];
    const Vector3 spin(0.3, -0.2, 0.5);
    for (std::size_t s = 1; s < rod.segments.size(); ++s) {
      rod.velocity[s] = spin.cross(rod.position[s]);
      rod.angular_velocity[s] = spin;
    }
    const LinearSystem system = test::assembled(rod);
    const ChainProfile profile(rod, gravity);
    Tensor<float> state(ChainProfile::state_size, rod.joint_count());
    profile.state(rod, system, 0.02, state);
    CHECK(state.row(9).cwiseAbs().maxCoeff() > 0.01);
    queries[twice] = KnnSet::query(profile, state);
  }
  for (std::size_t i = 0; i < queries[0].size(); ++i) CHECK(queries[0][i] == Approx(queries[1][i]).margin(1e-5));
}

TEST_CASE("joints in another order and direction are the same chain") {
  const Rod rod = test::moving_scene(6).rods[0];
  Rod other = rod;
  std::reverse(other.joints.begin(), other.joints.end());
  for (Joint& joint : other.joints) {
    std::swap(joint.a, joint.b);
    std::swap(joint.arm_a, joint.arm_b);
    std::swap(joint.frame_a, joint.frame_b);
  }
  Tensor<float> state[2], loads[2];
  for (const int reversed : {0, 1}) {
    Scene scene = test::scene_of(reversed ? other : rod);
    scene.rods[0].lambda.setZero();
    const LinearSystem system = test::assembled(scene.rods[0]);
    VectorX solution(30);
    DirectSolve(scene).solve(system, {}, 0, solution);
    const ChainProfile profile(scene.rods[0], gravity);
    state[reversed].resize(ChainProfile::state_size, 5);
    profile.state(scene.rods[0], system, 0.02, state[reversed]);
    loads[reversed] = loads_of(profile, solution, 0.02);
  }
  CHECK((state[0] - state[1]).norm() < 1e-4 * state[0].norm());
  CHECK((loads[0] - loads[1]).norm() < 1e-4 * loads[0].norm());
}

TEST_CASE("rods that are not a single chain are refused") {
  const auto profile = [](const test::Edges& edges) { return ChainProfile(test::random_rod(edges, {0}, 1), gravity); };
  CHECK_NOTHROW(profile(test::chain(4)));
  CHECK_THROWS_WITH(profile(test::tree(2, 2)), Catch::Matchers::ContainsSubstring("has 3 joints") &&
                                                   Catch::Matchers::ContainsSubstring("a single chain"));
  CHECK_THROWS_WITH(profile(test::ring(5)), Catch::Matchers::ContainsSubstring("no segment is an end"));
  CHECK_THROWS_WITH(profile({{0, 1}, {2, 3}}), Catch::Matchers::ContainsSubstring("not connected"));
}

}  // namespace rodsweep::test_chain_profile
