// The learned guess allocates nothing after a rod's first solves: not in base guess, features or layers.
#include <catch2/catch.hpp>

#include "network/guess/coping_net_guess.hpp"
#include "network/guess/end_to_end.hpp"
#include "network/guess/knn_guess.hpp"
#include "network/guess/state_network.hpp"
#include "tests/network/models.hpp"
#include "tests/network/stored.hpp"
#include "tests/solver/allocations.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_network_allocations {

TEST_CASE("a guess allocates nothing on a rod seen before, whatever the network") {
  const int segments = GENERATE(20, 400);
  const bool globals = GENERATE(false, true);
  for (CopingNetSettings settings : test::kinds_of_networks()) {
    settings.globals = globals;
    CAPTURE(segments, static_cast<int>(settings.encoding), static_cast<int>(settings.processor),
            static_cast<int>(settings.base));
    const Scene scene = build_scene(test::bending_rod(segments));
    const LinearSystem system = test::assembled(scene.rods.front());
    CopingNetGuess guess(test::random_model(settings), scene, 1);
    VectorX x0(system.rhs().size());
    long before = 0;
    for (int step = 0; step < 7; ++step) {
      if (step == 5) before = test::allocations();
      guess.propose(system, {step, 0, 0}, x0);
      guess.accept(system, {step, 0, 0}, x0);
    }
    CHECK(test::allocations() == before);
  }
}

TEST_CASE("a network instead of the solve allocates nothing on a rod seen before") {
  CopingNetSettings settings;
  settings.encoding = Encoding::paper_residual;
  settings.processor = Processor::message_passing;
  settings.base_size = 3;
  settings.latent = 16;
  settings.steps = 2;
  settings.moves = GENERATE(false, true);
  const Scene scene = build_scene(test::bending_rod(20));
  Rod rod = scene.rods.front();
  EndToEndProjection projection(scene, std::make_unique<CopingNetIncrements>(test::random_model(settings), scene, 1));
  long before = 0;
  for (int step = 0; step < 7; ++step) {
    if (step == 5) before = test::allocations();
    rod = scene.rods.front();
    for (Vector3& x : rod.position) x += Vector3(0, 0.01 * x.x() * x.x(), 0);
    projection.project(rod, {step, 0, 0}, 0.02, 0);
  }
  CHECK(test::allocations() == before);
}

TEST_CASE("a simulator of states allocates nothing after a rod's first step") {
  const CopingNetSettings settings = test::message_passing(Encoding::state, true);
  const Scene scene = build_scene(test::bending_rod(20));
  Rod rod = scene.rods.front();
  StateNetworkProjection projection(scene, test::random_model(settings), 0.02);
  long before = 0;
  for (int step = 0; step < 4; ++step) {
    if (step == 2) before = test::allocations();
    projection.project(rod, {step, 0, 0}, 0.02, 0);
  }
  CHECK(test::allocations() == before);
}

TEST_CASE("nearest neighbours allocate nothing") {
  const auto set = std::make_shared<KnnSet>();
  set->add(test::stored_simulation(build_scene(test::bending_rod(12)), 30));
  set->finish();
  const Scene scene = build_scene(test::bending_rod(20));
  const LinearSystem system = test::assembled(scene.rods.front());
  KnnGuess guess(set, scene, 3);
  VectorX x0(system.rhs().size());
  long before = 0;
  for (int step = 0; step < 3; ++step) {
    if (step == 1) before = test::allocations();
    CHECK(guess.propose(system, {step, 0, 0}, x0).nonzero);
    guess.accept(system, {step, 0, 0}, x0);
  }
  CHECK(test::allocations() == before);
}

}  // namespace rodsweep::test_network_allocations
