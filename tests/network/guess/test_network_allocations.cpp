// The learned guess allocates nothing after a rod's first solves: not in base guess, features or layers.

#include "network/guess/coping_net_guess.hpp"
#include "network/guess/end_to_end.hpp"
#include "network/guess/knn_guess.hpp"
#include "network/guess/state_network.hpp"
#include "tests/catch.hpp"
#include "tests/network/models.hpp"
#include "tests/network/stored.hpp"
#include "tests/solver/allocations.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_network_allocations {

/// Allocations in the last `counted` of these steps.
template <class Step>
long allocations_in(int steps, int counted, const Step& step) {
  long before = 0;
  for (int i = 0; i < steps; ++i) {
    if (i == steps - counted) before = test::allocations();
    step(i);
  }
  return test::allocations() - before;
}

long allocations_of(InitialGuess& guess, const LinearSystem& system, int steps) {
  VectorX x0(system.rhs().size());
  return allocations_in(steps, 2, [&](int step) {
    guess.propose(system, {step, 0, 0}, x0);
    guess.accept(system, {step, 0, 0}, x0);
  });
}

TEST_CASE("a guess allocates nothing on a rod seen before, whatever the network") {
  const int segments = GENERATE(20, 400);
  const bool globals = GENERATE(false, true);
  for (CopingNetSettings settings : test::kinds_of_networks()) {
    settings.globals = globals;
    CAPTURE(segments, static_cast<int>(settings.encoding), static_cast<int>(settings.processor),
            static_cast<int>(settings.base));
    const Scene scene = build_scene(test::bending_rod(segments));
    CopingNetGuess guess(test::random_model(settings), scene, 1);
    CHECK(allocations_of(guess, test::assembled(scene.rods.front()), 7) == 0);
  }
}

TEST_CASE("a network instead of the solve allocates nothing on a rod seen before") {
  CopingNetSettings settings = test::message_passing(Encoding::paper_residual, GENERATE(false, true));
  settings.base = BaseGuess::regression;
  settings.base_size = 3;
  settings.best_length = true;
  const Scene scene = build_scene(test::bending_rod(20));
  Rod rod = scene.rods.front();
  EndToEndProjection projection(scene, std::make_unique<CopingNetIncrements>(test::random_model(settings), scene, 1));
  const auto project = [&](int step) {
    rod = scene.rods.front();
    for (Vector3& x : rod.position) x += Vector3(0, 0.01 * x.x() * x.x(), 0);
    projection.project(rod, {step, 0, 0}, 0.02, 0);
  };
  CHECK(allocations_in(7, 2, project) == 0);
}

TEST_CASE("a simulator of states allocates nothing after a rod's first step") {
  const Scene scene = build_scene(test::bending_rod(20));
  Rod rod = scene.rods.front();
  StateNetworkProjection projection(scene, test::random_model(test::message_passing(Encoding::state, true)), 0.02);
  CHECK(allocations_in(4, 2, [&](int step) { projection.project(rod, {step, 0, 0}, 0.02, 0); }) == 0);
}

TEST_CASE("nearest neighbours allocate nothing") {
  const auto set = std::make_shared<KnnSet>();
  set->add(test::stored_simulation(build_scene(test::bending_rod(12)), 30));
  set->finish();
  const Scene scene = build_scene(test::bending_rod(20));
  KnnGuess guess(set, scene, 3);
  const LinearSystem system = test::assembled(scene.rods.front());
  VectorX x0(system.rhs().size());
  CHECK(guess.propose(system, {0, 0, 0}, x0).nonzero);
  CHECK(allocations_of(guess, system, 3) == 0);
}

}  // namespace rodsweep::test_network_allocations
