// A batch of equal chains takes the same steps as each chain alone.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "solver/batch/batched_step.hpp"
#include "solver/step/observables.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_batched_step {

const StepSettings settings{0.02, 6, 1e-9};
constexpr int lanes = BatchedRods::lanes;

Scene bending_scene(int segments, int variant, Clamp clamp = Clamp::segment) {
  BendingRod rod = test::bending_rod(segments, clamp);
  rod.length_m = 1 + 0.3 * variant;
  rod.radius_m = 0.04 + 0.002 * variant;
  rod.density_kg_m3 = 800 + 50 * variant;
  rod.initial_angle_deg = 6 * variant;
  rod.youngs_modulus_pa = 1e5 * (1 + variant);
  rod.damping_per_s = 0.2 * variant;
  rod.gravity_m_s2 = {0.1 * variant, -9.81, 0.2};
  return build_scene(rod);
}

Scene helix_scene(int segments, int variant) {
  Helix helix;
  helix.segments = segments;
  helix.helix_radius_m = 0.4 + 0.02 * variant;
  helix.windings = 2 + 0.1 * variant;
  helix.youngs_modulus_pa = 1e6;
  helix.torsion_modulus_pa = 1e5 * (1 + variant);
  return build_scene(helix);
}

// One scene per lane.
std::vector<Scene> bending_scenes(int segments) {
  std::vector<Scene> scenes;
  for (int r = 0; r < lanes; ++r) scenes.push_back(bending_scene(segments, r));
  return scenes;
}
std::vector<Scene> helix_scenes(int segments) {
  std::vector<Scene> scenes;
  for (int r = 0; r < lanes; ++r) scenes.push_back(helix_scene(segments, r));
  return scenes;
}

/// The largest difference of positions [m], and of orientations as quaternions up to sign.
double distance(const Rod& a, const Rod& b) {
  double out = 0;
  for (std::size_t s = 0; s < a.position.size(); ++s) {
    out = std::max(out, (a.position[s] - b.position[s]).norm());
    out = std::max(out, 1 - std::abs(a.orientation[s].dot(b.orientation[s])));
  }
  return out;
}

/// The largest difference of velocities [1/s]. An angular velocity is 2/dt tan(half the step's angle), whose slope in
/// the angle is 1 + tan^2; its difference is divided by that. After a half turn it tells nothing.
double velocity_distance(const Rod& a, const Rod& b, double dt) {
  double out = 0;
  for (std::size_t s = 0; s < a.position.size(); ++s) {
    const double steepness = 1 + dt * dt / 4 * b.angular_velocity[s].squaredNorm();
    out = std::max({out, (a.velocity[s] - b.velocity[s]).norm(),
                    (a.angular_velocity[s] - b.angular_velocity[s]).norm() / steepness});
  }
  return out;
}

bool same_bits(const Rod& a, const Rod& b) {
  const auto same = [](const auto& x, const auto& y) {
    return std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0;
  };
  return same(a.position, b.position) && same(a.velocity, b.velocity) && same(a.orientation, b.orientation) &&
         same(a.angular_velocity, b.angular_velocity) && same(a.lambda, b.lambda);
}

/// Steps the scenes in a batch and alone; compares reports, states and times.
void check_equal(std::vector<Scene> scenes, int steps, double bound, const StepSettings& s = settings,
                 std::optional<double> momentum_tolerance = {}) {
  std::vector<std::unique_ptr<Simulation>> alone;
  for (const Scene& scene : scenes) alone.push_back(std::make_unique<Simulation>(scene, s, momentum_tolerance));
  BatchedStepper batch(scenes, s, momentum_tolerance);
  for (int i = 0; i < steps; ++i) {
    const std::vector<StepReport>& reports = batch.step();
    REQUIRE(reports.size() == scenes.size());
    for (std::size_t r = 0; r < scenes.size(); ++r) {
      CAPTURE(i, r);
      const StepReport expected = alone[r]->step();
      CHECK(reports[r].outcome == expected.outcome);
      CHECK(reports[r].newton_iterations == expected.newton_iterations);
      CHECK(reports[r].balanced == expected.balanced);
    }
  }
  for (std::size_t r = 0; r < scenes.size(); ++r) {
    CAPTURE(r);
    const Rod& expected = alone[r]->rod();
    batch.write(static_cast<int>(r), scenes[r]);
    const Rod& rod = scenes[r].rods.front();
    CHECK(distance(rod, expected) < bound);
    CHECK(velocity_distance(rod, expected, s.dt) < bound / s.dt);
    CHECK((rod.lambda - expected.lambda).norm() <= 1e3 * bound * expected.lambda.norm());
    CHECK(momentum_residual(rod) == Approx(momentum_residual(expected)).epsilon(1e-3).margin(1e4 * bound));
    CHECK(scenes[r].time_s == alone[r]->scene.time_s);
    CHECK(batch.steps_taken(static_cast<int>(r)) == steps);
  }
}

TEST_CASE("rods and helices of different parameters step together as alone, also in the balance of momentum") {
  check_equal(bending_scenes(30), 50, 1e-10);
  check_equal(helix_scenes(45), 50, 1e-10);
  check_equal(bending_scenes(20), 40, 1e-8, {0.02, 20, 1e-9}, 1e-4);
  check_equal(helix_scenes(30), 40, 1e-8, {0.02, 20, 1e-9}, 1e-4);
}

TEST_CASE("rods of a batch that cannot be balanced are taken back, each for itself, as alone") {
  std::vector<Scene> scenes = bending_scenes(10);
  const StepSettings s{0.02, 12, 1e-9};
  const int wild = lanes / 2;
  Rod& rod = scenes[wild].rods.front();
  for (std::size_t i = 1; i < rod.velocity.size(); ++i) rod.velocity[i] = {0, i % 2 ? 60.0 : -60.0, 0};
  check_equal(scenes, 1, 1e-8, s, 1e-6);
  BatchedStepper batch(scenes, s, 1e-6);
  const std::vector<StepReport>& reports = batch.step();
  for (int r = 0; r < lanes; ++r) CHECK(reports[r].balanced == (r != wild));
}

TEST_CASE("rods that stretch more easily than they shear step together with some that don't, as alone") {
  std::vector<Scene> scenes;
  for (int r = 0; r < lanes; ++r) {
    BendingRod rod = test::bending_rod(30, Clamp::segment);
    rod.length_m = 1 + 0.3 * r;
    rod.initial_angle_deg = 6 * r;
    if (r % 3 > 0) rod.stretch = Stretch::physical;
    scenes.push_back(build_scene(rod));
    const Vector6& compliance = scenes.back().rods[0].joints[0].compliance;
    CHECK((compliance[2] == compliance[0]) == (r % 3 == 0));
  }
  check_equal(scenes, 50, 1e-10);
}

TEST_CASE("batches of fewer rods than lanes, of two segments and of one") {
  const int rods = GENERATE(1, lanes - 1);
  const Clamp clamp = GENERATE(Clamp::segment, Clamp::wall, Clamp::free);
  for (const int segments : {1, 2, 5}) {
    if (segments == 1 && clamp == Clamp::segment) continue;
    CAPTURE(rods, segments);
    std::vector<Scene> scenes;
    for (int r = 0; r < rods; ++r) scenes.push_back(bending_scene(segments, r, clamp));
    check_equal(scenes, 50, 1e-11);
  }
}

TEST_CASE("any arms, rest rotations, compliances and held segments") {
  const std::vector<int> held = GENERATE(std::vector<int>{}, std::vector<int>{0}, std::vector<int>{6},
                                         std::vector<int>{0, 6}, std::vector<int>{3});
  std::vector<Scene> scenes;
  for (unsigned r = 0; r < static_cast<unsigned>(lanes); ++r)
    scenes.push_back(test::scene_of(test::random_rod(test::chain(7), held, 10 + r)));
  check_equal(scenes, 1, 1e-9, {1e-3, 3, 1e-9});  // gaps of metres to close
}

TEST_CASE("a rod that has converged waits, unchanged, for those that have not") {
  // A tolerance so coarse that one iteration too many would change the result.
  const StepSettings coarse{0.02, 6, 1e-3};
  std::vector<Scene> scenes = bending_scenes(10);
  scenes.back().gravity_m_s2.setZero();
  check_equal(scenes, 10, 1e-11, coarse);

  BatchedStepper batch(scenes, coarse);
  const std::vector<StepReport>& reports = batch.step();
  CHECK(reports.back().newton_iterations == 0);
  CHECK(reports[0].newton_iterations > 0);
}

TEST_CASE("a rod that blows up does not disturb the others, and stays where it failed") {
  std::vector<Scene> scenes = bending_scenes(10);
  BatchedStepper good(scenes, settings);

  const int bad = lanes / 2;
  const double infinite = std::numeric_limits<double>::infinity();
  const bool turning = GENERATE(true, false);
  Rod& rod = scenes[bad].rods[0];
  (turning ? rod.angular_velocity : rod.velocity)[5].x() = infinite;
  const SolveOutcome expected = turning ? SolveOutcome::indefinite : SolveOutcome::not_a_number;
  Scene alone = scenes[bad];
  DirectSolve direct(alone);
  LinearProjection projection(alone, direct);
  CHECK(TimeStepper(alone, settings).step(projection).outcome == expected);

  BatchedStepper batch(scenes, settings);
  for (int i = 0; i < 10; ++i) {
    good.step();
    const std::vector<StepReport>& reports = batch.step();
    for (int r = 0; r < lanes; ++r) CHECK(reports[r].outcome == (r == bad ? expected : SolveOutcome::converged));
    CHECK(reports[bad].newton_iterations == (i == 0 ? 1 : 0));
  }
  for (int r = 0; r < lanes; ++r) {
    if (r == bad) continue;
    CAPTURE(r);
    Scene reference = scenes[r];
    batch.write(r, scenes[r]);
    good.write(r, reference);
    CHECK(same_bits(scenes[r].rods.front(), reference.rods.front()));
  }
  batch.write(bad, scenes[bad]);
  CHECK(scenes[bad].time_s == 0);
  CHECK(batch.steps_taken(bad) == 0);
  CHECK(batch.steps_taken(0) == 10);
}

TEST_CASE("a step goes on from whatever state and time a scene has") {
  Scene scene = test::moving_scene(10, 8);
  scene.time_s = 3;
  Simulation alone(scene, settings);
  BatchedStepper batch({scene}, settings);
  for (int i = 0; i < 5; ++i) {
    alone.step();
    batch.step();
  }
  batch.write(0, scene);
  CHECK(distance(scene.rods.front(), alone.rod()) < 1e-12);
  CHECK(scene.time_s == alone.scene.time_s);
}

TEST_CASE("a step in parts shows every rod's system as the linear system of it alone has it") {
  constexpr int rods = std::min(3, lanes);
  const std::optional<double> momentum_tolerance = GENERATE(std::optional<double>(), std::optional<double>(1e-6));
  std::vector<Scene> scenes;
  for (int r = 0; r < rods; ++r) scenes.push_back(bending_scene(8, r));
  BatchedStepper batch(scenes, settings, momentum_tolerance), whole(scenes, settings, momentum_tolerance);
  const auto scene_of = [&](int rod) {
    Scene scene = scenes[rod];
    batch.write(rod, scene);
    return scene;
  };
  for (int step = 0; step < 3; ++step) {
    batch.begin();
    int solves = 0;
    while (batch.linearize()) {
      std::vector<VectorX> exact(rods);
      for (int rod = 0; rod < rods; ++rod) {
        if (!batch.iterates(rod)) continue;
        Scene scene = scene_of(rod);
        LinearSystem system(scene.rods.front());
        CHECK(batch.keeps_balance(rod) == momentum_tolerance.has_value());
        if (momentum_tolerance)
          system.assemble_balanced(scene.rods.front(), constraint_dt(scene, settings.dt));
        else
          system.assemble(scene.rods.front(), constraint_dt(scene, settings.dt));
        const BatchedLinearization& seen = batch.system().linearization();
        CHECK(seen.residual[rod] == Approx(system.newton_residual()).margin(1e-14));
        CHECK(std::sqrt(seen.squared_norm[rod]) == Approx(system.rhs().norm()).margin(1e-14));
        CHECK(std::sqrt(seen.squared_gap[rod]) == Approx(joint_gap(scene.rods.front())).margin(1e-14));
        exact[rod].resize(system.rhs().size());
        BlockFactor(system.matrix(), root_to_leaf_order(scene.rods.front()))
            .solve(system.matrix(), system.rhs(), exact[rod]);
      }
      batch.solve();
      ++solves;
      for (int rod = 0; rod < rods; ++rod) {
        VectorX& expected = exact[rod];
        if (!batch.iterates(rod) || expected.size() == 0) continue;
        VectorX solution(expected.size());
        batch.write_solution(rod, solution.data());
        CHECK((solution - expected).norm() < 1e-9 * expected.norm() + 1e-14);
      }
    }
    batch.end();
    whole.step();
    CHECK(solves > 1);
  }
  for (int rod = 0; rod < rods; ++rod) {
    Scene expected = scenes[rod];
    whole.write(rod, expected);
    CHECK(same_bits(scene_of(rod).rods.front(), expected.rods.front()));
  }
}

TEST_CASE("a rod that is abandoned stays where it is, the others go on") {
  std::vector<Scene> scenes{bending_scene(6, 0), bending_scene(6, 1)};
  BatchedStepper batch(scenes, settings), other({scenes[1]}, settings);
  batch.step();
  other.step();
  Scene left = scenes[0], after = scenes[0];
  batch.write(0, left);
  batch.abandon(0);
  for (int step = 0; step < 3; ++step) {
    batch.step();
    other.step();
  }
  batch.write(0, after);
  CHECK(same_bits(left.rods.front(), after.rods.front()));
  CHECK(batch.steps_taken(0) == 1);
  Scene alone = scenes[1];
  batch.write(1, scenes[1]);
  other.write(0, alone);
  CHECK(same_bits(scenes[1].rods.front(), alone.rods.front()));
}

TEST_CASE("what a batch cannot hold is refused") {
  using Scenes = std::vector<Scene>;
  const std::string bound = " scenes; must be from 1 to " + std::to_string(lanes);
  const std::pair<void (*)(Scenes&), std::string> refused[] = {
      {[](Scenes& s) { s.clear(); }, "a batch of 0" + bound},
      {[](Scenes& s) { s.assign(lanes + 1, bending_scene(5, 0)); }, "a batch of " + std::to_string(lanes + 1) + bound},
      {[](Scenes& s) { s[1].rods.push_back(s[1].rods.front()); }, "scene 1 of a batch has 2 rods; must have one"},
      {[](Scenes& s) {
         s[0].clamps.push_back({0, 0, [](double) { return Pose{Vector3::Zero(), Quaternion::Identity()}; }});
       },
       "scene 0 of a batch has a moving clamp"},
      {[](Scenes& s) {
         s[1].loads.push_back({0, 4, {1, 0, 0}});
       },
       "scene 1 of a batch has a point load"},
      {[](Scenes& s) { s[1] = bending_scene(6, 0); }, "scene 1 of a batch has 6 segments; the first one has 5"},
      {[](Scenes& s) { s[1] = bending_scene(5, 0, Clamp::free); }, "scene 1 of a batch: segment 0 is free"},
      {[](Scenes& s) { s[1].rods[0] = test::random_rod(test::ring(5), {0}, 1); },
       "scene 1 of a batch has 5 joints for 5 segments; a chain has one less"},
      {[](Scenes& s) {
         s[1].rods[0] = test::random_rod({{0, 1}, {1, 2}, {1, 3}, {3, 4}}, {0}, 1);
       },
       "scene 1 of a batch: joint 2 joins segments 1 and 3; in a chain it joins 2 and 3"},
      {[](Scenes& s) {
         s[0].rods[0] = test::random_rod(test::chain(5), {1, 2}, 1);
       },
       "scene 0 of a batch: joint 1 joins two static segments"},
  };
  for (const auto& [change, what] : refused) {
    Scenes scenes{bending_scene(5, 0), bending_scene(5, 1)};
    change(scenes);
    CHECK_THROWS_AS(BatchedStepper(scenes, settings), SceneError);
    CHECK_THROWS_WITH(BatchedStepper(scenes, settings), Catch::StartsWith(what));
  }
}

}  // namespace rodsweep::test_batched_step
