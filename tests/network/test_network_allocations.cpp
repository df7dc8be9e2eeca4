// The learned guess asks for no memory after a rod's first solves: not in its base guess, features or layers.
#include <catch2/catch.hpp>

#include "allocations.hpp"
#include "models.hpp"
#include "network/coping_net_guess.hpp"
#include "support.hpp"

namespace rodsweep {
namespace {

TEST_CASE("a guess allocates nothing on a rod seen before, whatever the network") {
  const int segments = GENERATE(20, 400);
  const bool globals = GENERATE(false, true);
  for (CopingNetSettings settings : test::kinds_of_networks()) {
    settings.globals = globals;
    // Sweeps over other features than those of the system use the training code.
    if (settings.processor == Processor::sweeps && settings.encoding != Encoding::system) continue;
    CAPTURE(segments, static_cast<int>(settings.encoding), static_cast<int>(settings.processor),
            static_cast<int>(settings.base));
    const Scene scene = build_scene(test::bending_rod(segments));
    LinearSystem system(scene.rods.front());
    system.assemble(scene.rods.front(), 0.02);
    CopingNetGuess guess(test::random_model(settings), scene, 0.02, 1);
    VectorX x0(system.rhs().size());
    long before = 0;
    for (int step = 0; step < 7; ++step) {
      if (step == 5) before = test::allocations();
      guess.propose(system, {step, 0, 0}, x0);
      guess.accept({step, 0, 0}, x0);
    }
    CHECK(test::allocations() == before);
  }
}

}  // namespace
}  // namespace rodsweep
