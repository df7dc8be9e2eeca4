// Copies of examples, turned about gravity and shifted: the features that change and those that do not.

#include "network/training/turn.hpp"
#include "tests/catch.hpp"
#include "tests/network/stored.hpp"

namespace rodsweep::test_turned_copies {

using namespace test;

TEST_CASE("a turn keeps gravity and distances, and moves everything that a rod has in the world") {
  SplitMix random(3);
  const Vector3 gravity(1, -9, 2);
  Rod rod = sample_scene(2).rods.front();
  rod.velocity[1] = {1, 2, 3};
  rod.angular_velocity[1] = {3, 1, 2};
  for (int k = 0; k < 20; ++k) {
    const Turn turn = random_turn(gravity, 2, random);
    CHECK((turn.rotation * gravity - gravity).norm() < 1e-12);
    CHECK(turn.shift.cwiseAbs().maxCoeff() < 2);
    const Rod moved = turned(rod, turn);
    CHECK((moved.position[3] - moved.position[1]).norm() == Approx((rod.position[3] - rod.position[1]).norm()));
    CHECK((moved.velocity[1] - turn.rotation * rod.velocity[1]).norm() < 1e-12);
    CHECK((moved.angular_velocity[1] - turn.rotation * rod.angular_velocity[1]).norm() < 1e-12);
    CHECK(moved.orientation[1].angularDistance(turn.rotation * rod.orientation[1]) < 1e-7);
  }
}

TEST_CASE("without gravity a turn is about anything") {
  SplitMix random(4);
  const Turn a = random_turn(Vector3::Zero(), 1, random), b = random_turn(Vector3::Zero(), 1, random);
  CHECK(Eigen::AngleAxisd(a.rotation).axis().cross(Eigen::AngleAxisd(b.rotation).axis()).norm() > 1e-3);
}

TEST_CASE("copies have features and moves of the turned rod, and the same edges, system and multipliers") {
  for (const Encoding encoding : {Encoding::paper, Encoding::paper_residual}) {
    CAPTURE(static_cast<int>(encoding));
    CopingNetSettings settings;
    settings.encoding = encoding;
    settings.processor = Processor::message_passing;
    settings.base = BaseGuess::none;
    settings.latent = 8;
    settings.moves = true;
    const StoredSimulation simulation = stored_simulation(sample_scene(1), 2);
    std::vector<Example> alone, copied;
    add_examples(settings, simulation, alone);
    add_examples(settings, simulation, copied, {2, 5});
    REQUIRE(copied.size() == 3 * alone.size());
    for (std::size_t i = 0; i < copied.size(); ++i) {
      const Example &original = alone[i / 3], &copy = copied[i];
      CHECK(copy.edges == original.edges);
      CHECK(copy.edge_target == original.edge_target);
      CHECK(copy.system.residual == original.system.residual);
      CHECK(copy.nodes.middleRows(7, 7) == original.nodes.middleRows(7, 7));  // radius ... last
      CHECK((copy.nodes.topRows(7) == original.nodes.topRows(7)) == (i % 3 == 0));
      CHECK(copy.node_target.colwise().norm().isApprox(original.node_target.colwise().norm(), 1e-5F));
      if (i % 3 > 0) CHECK_FALSE(copy.node_target.isApprox(original.node_target, 1e-3F));
    }
  }
}

TEST_CASE("examples may be those of first Newton iterations alone") {
  CopingNetSettings settings;
  settings.base = BaseGuess::subspace;
  const StoredSimulation simulation = stored_simulation(sample_scene(1), 4, 3);
  std::vector<Example> all, first;
  add_examples(settings, simulation, all);
  add_examples(settings, simulation, first, {}, true);
  CHECK(all.size() == 12);
  REQUIRE(first.size() == 4);
  for (std::size_t i = 0; i < 4; ++i)  // base guesses also use the other iterations
    CHECK(first[i].edge_target == all[3 * i].edge_target);
}

}  // namespace rodsweep::test_turned_copies
