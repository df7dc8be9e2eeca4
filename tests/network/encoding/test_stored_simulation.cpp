
#include "network/encoding/stored_simulation.hpp"
#include "tests/catch.hpp"
#include "tests/solver/support.hpp"

using namespace rodsweep;

TEST_CASE("a recorded system puts its rod back to the state that it was assembled from") {
  const Rod rod = test::random_rod(test::tree(2, 2), {0}, 3);
  const StoredSystem system{{},         0.02, rod.position, rod.orientation, rod.velocity, rod.angular_velocity,
                            rod.lambda, {}};

  Rod other = rod;
  for (std::size_t s = 0; s < other.segments.size(); ++s) {
    other.position[s].x() += 1;
    other.velocity[s].y() += 2;
    other.angular_velocity[s].z() += 3;
    other.orientation[s] = Quaternion::Identity();
  }
  other.lambda.setZero();
  restore(system, other);
  CHECK(other.position == rod.position);
  CHECK(other.velocity == rod.velocity);
  CHECK(other.angular_velocity == rod.angular_velocity);
  CHECK(other.lambda == rod.lambda);

  const LinearSystem expected = test::assembled(rod), found = test::assembled(other);
  CHECK(found.rhs() == expected.rhs());
  CHECK(found.matrix().dense() == expected.matrix().dense());
}

TEST_CASE("a system is not put into a rod of another size") {
  StoredSystem system;
  system.position.resize(3);
  system.lambda.resize(12);
  Rod rod = test::random_rod(test::chain(4), {}, 1);
  CHECK_THROWS_WITH(restore(system, rod), Catch::Matchers::ContainsSubstring("3 segments and 2 joints") &&
                                              Catch::Matchers::ContainsSubstring("4 and 3"));
}
