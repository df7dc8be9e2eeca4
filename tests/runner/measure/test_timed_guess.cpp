// The measured time of a guess, with a guess of known durations.
#include <array>
#include <memory>

#include "runner/measure/timed_guess.hpp"
#include "solver/scene/scenes.hpp"
#include "tests/catch.hpp"
#include "tests/hand_clock.hpp"

namespace rodsweep {
namespace test_timed_guess {

/// A guess that sleeps for given times.
class Slow : public InitialGuess {
 public:
  Slow(int prepare_ms, int propose_ms, int accept_ms)
      : prepare_ms_(prepare_ms), propose_ms_(propose_ms), accept_ms_(accept_ms) {}
  void prepare(const SolvePosition&) override { sleep(prepare_ms_); }
  Proposal propose(const LinearSystem&, const SolvePosition&, VectorX&) override {
    sleep(propose_ms_);
    return {};
  }
  void accept(const LinearSystem&, const SolvePosition&, const VectorX&) override { sleep(accept_ms_); }

 private:
  static void sleep(int ms) { test::HandClock::pass(std::chrono::milliseconds(ms)); }
  int prepare_ms_, propose_ms_, accept_ms_;
};

TEST_CASE("what a guess does for a system is charged once, however often it is timed, and for each system anew") {
  const Scene scene = build_scene(BendingRod{});
  const LinearSystem system(scene.rods.front());
  for (const auto& [prepare_ms, propose_ms, accept_ms] : {std::array{40, 0, 0}, {0, 20, 0}, {0, 0, 40}, {5, 6, 7}}) {
    TimedGuess guess(std::make_unique<Slow>(prepare_ms, propose_ms, accept_ms), test::HandClock::now);
    VectorX x0 = VectorX::Zero(system.matrix().unknowns());
    for (int step = 0; step < 3; ++step) {
      guess.prepare({step, 0, 0});
      guess.propose(system, {step, 0, 0}, x0);
      for (int repeat = 0; repeat < 5; ++repeat) guess.propose_timed(system, {step, 0, 0}, x0);
      guess.accept(system, {step, 0, 0}, x0);
      CHECK(guess.seconds() == Approx(1e-3 * (prepare_ms + propose_ms + accept_ms)));
    }
  }
}

}  // namespace test_timed_guess
}  // namespace rodsweep
