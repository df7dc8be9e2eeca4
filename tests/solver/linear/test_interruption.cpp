#include "solver/linear/interruption.hpp"

#include <atomic>
#include <stdexcept>
#include <thread>

#include "tests/catch.hpp"
#include "tests/hand_clock.hpp"

using namespace rodsweep;
using namespace std::chrono_literals;
using test::HandClock;

namespace test_interruption {

constexpr std::int64_t much = 1'000'000'000, little = 1'000;  ///< of work, as it was estimated

TEST_CASE("nothing is interrupted without an Interruptible") {
  CHECK_FALSE(is_interrupted(much));
  CHECK_NOTHROW(check_interrupted(much));
  const UnreportedCall call(nullptr);
}

TEST_CASE("whether a result is wanted is asked every two milliseconds by the clock, and no more once it is not") {
  int asked = 0;
  {
    const Interruptible interruptible([&] { return ++asked == 3; }, HandClock::now);
    for (int i = 0; i < 10; ++i) CHECK_FALSE(is_interrupted(much));  // estimated work is no time
    CHECK(asked == 0);
    HandClock::pass(1ms);
    CHECK_FALSE(is_interrupted(much));
    CHECK(asked == 0);
    for (int i = 0; i < 2; ++i) {
      HandClock::pass(2ms);
      CHECK_FALSE(is_interrupted(much));
    }
    CHECK(asked == 2);
    HandClock::pass(2ms);
    CHECK(is_interrupted(much));
    CHECK(is_interrupted(0));
    CHECK_THROWS_AS(check_interrupted(0), InterruptedComputation);
    CHECK(asked == 3);
  }
  CHECK_FALSE(is_interrupted(much));
}

TEST_CASE("work that takes a thousand times as long as was estimated is interrupted all the same") {
  const Interruptible interruptible([] { return true; }, HandClock::now);
  int products = 0;
  for (; !is_interrupted(little) && products < 1000; ++products) HandClock::pass(1ms);
  CHECK(products < 100);
}

TEST_CASE("work that takes no time is done without looking at the clock") {
  static int looks;
  looks = 0;
  const Interruptible interruptible([] { return true; }, [] { return ++looks, HandClock::now(); });
  for (int i = 0; i < 40; ++i) is_interrupted(little);
  CHECK(looks == 1);  // at its construction
}

TEST_CASE("after a call that reported nothing the clock is looked at") {
  const Interruptible interruptible([] { return true; }, HandClock::now);
  CHECK_FALSE(is_interrupted(0));
  {
    const UnreportedCall call(nullptr);
    HandClock::pass(1s);
  }
  CHECK(is_interrupted(0));
}

TEST_CASE("what finding out throws arrives where an exception may") {
  const Interruptible interruptible([]() -> bool { throw std::runtime_error("the disk is full"); }, HandClock::now);
  HandClock::pass(2ms);
  CHECK(is_interrupted(much));
  CHECK_THROWS_WITH(check_interrupted(0), "the disk is full");
}

// What another thread does during calls; they wait for it.
std::atomic<int> interrupts{0}, is_long{0}, stuck{0};

bool becomes(const std::atomic<int>& number, int at_least) {
  for (int i = 0; number < at_least && i < 60'000; ++i) std::this_thread::sleep_for(1ms);
  return number >= at_least;
}

TEST_CASE("during a call that reports nothing another thread asks, and interrupts the call once a second") {
  interrupts = 0;
  std::atomic<int> asked{0};
  std::atomic<bool> wanted{true};
  const Interruptible interruptible([&] { return ++asked, !wanted; }, HandClock::now);
  {
    const UnreportedCall call([] { ++interrupts; });
    REQUIRE(becomes(asked, 3));
    CHECK(interrupts == 0);
    wanted = false;
    REQUIRE(becomes(interrupts, 1));
    REQUIRE(becomes(asked, asked + 3));  // the heartbeats go on
    CHECK(interrupts == 1);
    HandClock::pass(1s);
    REQUIRE(becomes(interrupts, 2));
  }
  CHECK_THROWS_AS(check_interrupted(0), InterruptedComputation);
  const int before = asked;
  std::this_thread::sleep_for(120ms);
  CHECK(asked == before);
}

TEST_CASE("a call that does not return a minute after it should is stuck: nothing more is asked") {
  stuck = 0;
  std::atomic<int> asked{0};
  handle_calls({nullptr, [] { ++stuck; }});
  const Interruptible interruptible([&] { return ++asked, true; }, HandClock::now);
  const UnreportedCall call(nullptr);
  REQUIRE(becomes(asked, 3));
  CHECK(stuck == 0);
  HandClock::pass(61s);
  REQUIRE(becomes(stuck, 1));
  const int before = asked;
  std::this_thread::sleep_for(120ms);
  CHECK(asked == before);
  CHECK(stuck == 1);
  handle_calls({});
}

TEST_CASE("a wanted call that takes a minute is long, which is said once") {
  is_long = 0;
  std::atomic<int> asked{0};
  handle_calls({[] { ++is_long; }, nullptr});
  const Interruptible interruptible([&] { return ++asked, false; }, HandClock::now);
  const UnreportedCall call(nullptr);
  REQUIRE(becomes(asked, 1));
  CHECK(is_long == 0);
  HandClock::pass(60s);
  REQUIRE(becomes(is_long, 1));
  REQUIRE(becomes(asked, asked + 3));
  CHECK(is_long == 1);
  handle_calls({});
}

}  // namespace test_interruption
