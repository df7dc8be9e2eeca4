#include "solver/linear/interruption.hpp"

#include <catch2/catch.hpp>
#include <stdexcept>

using namespace rodsweep;

TEST_CASE("nothing is interrupted without an Interruptible") {
  CHECK_FALSE(is_interrupted(1'000'000'000));
  CHECK_NOTHROW(check_interrupted(1'000'000'000));
}

TEST_CASE("whether a result is wanted is asked about every two milliseconds of work, and no more once it is not") {
  int asked = 0;
  {
    const Interruptible interruptible([&] { return ++asked == 3; });
    for (int i = 0; i < 4; ++i) CHECK_FALSE(is_interrupted(1'000'000));
    CHECK(asked == 2);
    CHECK_FALSE(is_interrupted(1'000'000));
    CHECK(is_interrupted(1'000'000));
    CHECK(is_interrupted(0));
    CHECK_THROWS_AS(check_interrupted(0), InterruptedComputation);
    CHECK(asked == 3);
  }
  CHECK_FALSE(is_interrupted(1'000'000'000));
}

TEST_CASE("what finding out throws arrives where an exception may") {
  const Interruptible interruptible([]() -> bool { throw std::runtime_error("the disk is full"); });
  CHECK(is_interrupted(2'000'000));
  CHECK_THROWS_WITH(check_interrupted(0), "the disk is full");
}
