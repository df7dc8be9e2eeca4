// Nearest neighbours: the neighbours found, the interpolation of their solutions, the cost; systems that fit no rod.

#include "network/guess/knn_guess.hpp"
#include "tests/catch.hpp"
#include "tests/network/stored.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_knn {

std::shared_ptr<const KnnSet> set_of(const std::vector<StoredSimulation>& simulations,
                                     KnnInputs inputs = KnnInputs::all) {
  auto set = std::make_shared<KnnSet>(inputs);
  for (const StoredSimulation& simulation : simulations) set->add(simulation);
  set->finish();
  return set;
}

/// The proposal for a recorded system, at a rod of `scene` in the recorded state.
VectorX guess_at(const std::shared_ptr<const KnnSet>& set, Scene scene, const StoredSystem& where, int k,
                 double dt = 0.02, Proposal* proposal = nullptr) {
  Rod& rod = scene.rods[0];
  restore(where, rod);
  const LinearSystem system = test::assembled(rod, dt);
  VectorX x0(system.rhs().size());
  const Proposal made = KnnGuess(set, scene, k).propose(system, where.at, x0);
  if (proposal) *proposal = made;
  return x0;
}

/// A system of a straight rod at rest with this velocity and this solution.
StoredSystem planted(const Rod& rod, const Vector3& velocity, const VectorX& solution) {
  return {{},
          0.02,
          rod.position,
          rod.orientation,
          std::vector<Vector3>(rod.segments.size(), velocity),
          rod.angular_velocity,
          VectorX::Zero(rod.lambda.size()),
          solution};
}

TEST_CASE("a system of the training set is its own nearest neighbour and is answered with its solution") {
  BendingRod other = test::bending_rod(7);
  other.length_m *= 1.3;
  const std::vector<StoredSimulation> simulations{test::stored_simulation(build_scene(test::bending_rod(9)), 12, 2),
                                                  test::stored_simulation(build_scene(other), 12, 2)};
  const auto set = set_of(simulations);
  CHECK(set->size(0) == 24);
  for (const StoredSimulation& simulation : simulations)
    for (const StoredSystem& system : simulation.systems) {
      const double norm = system.solution.norm();
      CHECK((guess_at(set, simulation.scene, system, 1) - system.solution).norm() < 1e-6 * norm);
      CHECK((guess_at(set, simulation.scene, system, 3) - system.solution).norm() < 1e-3 * norm);
    }
}

TEST_CASE("neighbours weigh by the inverse of their distance") {
  const Scene scene = build_scene(test::bending_rod(5));
  test::Random random(1);
  const VectorX near = random.entries(24), far = random.entries(24);
  const Vector3 u(0.1, 0.2, -0.3);
  StoredSimulation simulation{scene, 0.02, 1, {}};
  simulation.systems = {planted(scene.rods[0], Vector3::Zero(), near), planted(scene.rods[0], 3 * u, far)};
  const StoredSystem between = planted(scene.rods[0], u, near);
  const auto set = set_of({simulation});
  for (const int k : {2, 5}) {  // 5 is more than the set has
    const VectorX x0 = guess_at(set, scene, between, k);
    CHECK((x0 - (2 * near + far) / 3).norm() < 1e-5 * x0.norm());
  }
  CHECK((guess_at(set, scene, between, 1) - near).norm() < 1e-5 * near.norm());
}

TEST_CASE("the tree finds what a look at every system finds") {
  std::vector<StoredSimulation> simulations;
  for (const int segments : {6, 8, 11, 14})
    simulations.push_back(test::stored_simulation(build_scene(test::bending_rod(segments)), 20, 1));
  const auto set = set_of(simulations);
  const StoredSimulation unseen = test::stored_simulation(build_scene(test::bending_rod(9)), 20, 1);
  Rod rod = unseen.scene.rods[0];
  const ChainProfile profile(rod, unseen.scene.gravity_m_s2);
  LinearSystem system(rod);
  Tensor<float> state(ChainProfile::state_size, rod.joint_count());
  for (const StoredSystem& one : unseen.systems) {
    restore(one, rod);
    system.assemble(rod, rod.constraint_dt);
    profile.state(rod, system, rod.constraint_dt, state);
    KnnSet::Neighbours few{std::vector<std::uint32_t>(3), std::vector<float>(3)};
    KnnSet::Neighbours all{std::vector<std::uint32_t>(100), std::vector<float>(100)};
    CHECK(set->nearest(0, KnnSet::query(profile, state), few) == 3);
    CHECK(set->nearest(0, KnnSet::query(profile, state), all) == set->size(0));
    CHECK(set->size(0) == 80);
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(few.system[i] == all.system[i]);
      CHECK(few.distance[i] == all.distance[i]);
    }
  }
}

TEST_CASE("neighbours of shape alone see no velocities") {
  const Scene scene = build_scene(test::bending_rod(5));
  test::Random random(1);
  const VectorX slow = random.entries(24), fast = random.entries(24);
  const Vector3 u(0.1, 0.2, -0.3);
  StoredSimulation simulation{scene, 0.02, 1, {}};
  simulation.systems = {planted(scene.rods[0], Vector3::Zero(), slow), planted(scene.rods[0], 3 * u, fast)};
  const auto shapes = set_of({simulation}, KnnInputs::shape);
  const VectorX x0 = guess_at(shapes, scene, planted(scene.rods[0], 3 * u, fast), 2);
  CHECK((x0 - (slow + fast) / 2).norm() < 1e-5 * x0.norm());
  StoredSimulation bent = simulation;
  for (std::size_t s = 1; s < 5; ++s) bent.systems[1].position[s] += Vector3(0, 0.1 * static_cast<double>(s), 0);
  const auto of_both = set_of({bent}, KnnInputs::shape);
  CHECK((guess_at(of_both, scene, bent.systems[1], 1) - fast).norm() < 1e-5 * fast.norm());
}

TEST_CASE("a Newton iteration without training data is answered with zero") {
  const StoredSimulation simulation = test::stored_simulation(build_scene(test::bending_rod(6)), 3, 1);
  StoredSystem later = simulation.systems.back();
  later.at.newton = 1;
  Proposal proposal{true, 7};
  const VectorX x0 = guess_at(set_of({simulation}), simulation.scene, later, 3, 0.02, &proposal);
  CHECK(x0.norm() == 0);
  CHECK(!proposal.nonzero);
  CHECK(proposal.products == 0);
}

TEST_CASE("a system is not put into a rod of another size") {
  StoredSystem system;
  system.position.resize(3);
  system.lambda.resize(12);
  Rod rod = test::random_rod(test::chain(4), {}, 1);
  CHECK_THROWS_WITH(restore(system, rod), Catch::Matchers::ContainsSubstring("3 segments and 2 joints") &&
                                              Catch::Matchers::ContainsSubstring("4 and 3"));
}

}  // namespace rodsweep::test_knn
