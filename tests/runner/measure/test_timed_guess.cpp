// The measured time of a guess, with a guess of known durations.
#include <catch2/catch.hpp>
#include <memory>

#include "runner/measure/timed_guess.hpp"
#include "solver/scene/scenes.hpp"
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

double seconds_of(int prepare_ms, int propose_ms, int accept_ms) {
  const Scene scene = build_scene(BendingRod{});
  const LinearSystem system(scene.rods.front());
  TimedGuess guess(std::make_unique<Slow>(prepare_ms, propose_ms, accept_ms), test::HandClock::now);
  VectorX x0 = VectorX::Zero(system.matrix().unknowns());
  guess.prepare({});
  guess.propose(system, {}, x0);
  for (int repeat = 0; repeat < 5; ++repeat) guess.propose_timed(system, {}, x0);
  guess.accept(system, {}, x0);
  return guess.seconds();
}

TEST_CASE("what a guess does before its proposals and after the solve is charged once") {
  CHECK(seconds_of(40, 0, 0) == Approx(0.04));
  CHECK(seconds_of(0, 0, 40) == Approx(0.04));
}

TEST_CASE("repeated proposals are charged as one") { CHECK(seconds_of(0, 20, 0) == Approx(0.02)); }

TEST_CASE("every system is charged anew") {
  const Scene scene = build_scene(BendingRod{});
  const LinearSystem system(scene.rods.front());
  TimedGuess guess(std::make_unique<Slow>(5, 5, 5), test::HandClock::now);
  VectorX x0 = VectorX::Zero(system.matrix().unknowns());
  double last = 0;
  for (int step = 0; step < 20; ++step) {
    guess.prepare({step, 0, 0});
    guess.propose_timed(system, {step, 0, 0}, x0);
    guess.accept(system, {step, 0, 0}, x0);
    last = guess.seconds();
  }
  CHECK(last == Approx(0.015));
}

}  // namespace test_timed_guess
}  // namespace rodsweep
