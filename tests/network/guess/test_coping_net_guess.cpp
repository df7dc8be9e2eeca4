// COPINGNet as an initial guess in moving simulations: its guarantees and its cost.
#include <algorithm>
#include <limits>

#include "network/guess/base_guess.hpp"
#include "network/guess/coping_net_guess.hpp"
#include "solver/factor/block_factor.hpp"
#include "tests/catch.hpp"
#include "tests/network/models.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_coping_net_guess {

double energy_error(const LinearSystem& system, const VectorX& x, const VectorX& solution) {
  VectorX scratch(x.size());
  return energy_norm_squared(system.matrix(), x - solution, scratch);
}

TEST_CASE("with the best length what is left of the error is A-orthogonal to the correction") {
  for (CopingNetSettings settings : test::kinds_of_networks()) {
    CAPTURE(static_cast<int>(settings.encoding), static_cast<int>(settings.processor), static_cast<int>(settings.base));
    Scene scene = build_scene(test::bending_rod(8));
    CopingNetGuess guess(test::random_model(settings), scene, 2);
    const auto base = base_guess(settings, scene, 2);
    int corrected = 0;
    observe(scene, {0.02, 2, 0}, 4, [&](const LinearSystem& system, const SolvePosition& at, const VectorX& solution) {
      VectorX x0(solution.size()), alone(solution.size());
      const Proposal without = base->propose(system, at, alone);
      const Proposal with = guess.propose(system, at, x0);
      CHECK(with.products == without.products + (without.nonzero ? 1 : 0) + 1);
      REQUIRE(with.residual);
      const VectorX left = test::residual(system.matrix(), system.rhs(), x0);
      CHECK((left - *with.residual).norm() < 1e-11 * system.rhs().norm() + 1e-24);
      const double before = energy_error(system, alone, solution), after = energy_error(system, x0, solution);
      CHECK(after <= before * (1 + 1e-6) + 1e-24);
      // The correction has optimal length: (x0 - x) is A-orthogonal to it.
      const VectorX correction = x0 - alone;
      VectorX product(x0.size());
      system.matrix().multiply(correction.data(), product.data());
      const double length = std::sqrt(correction.dot(product));
      CHECK(std::abs(product.dot(x0 - solution)) <= 1e-6 * length * std::sqrt(before) + 1e-24);
      corrected += length > 1e-4 * std::sqrt(before);
      VectorX again(solution.size());
      guess.propose(system, at, again);
      CHECK(again == x0);
      guess.accept(system, at, solution);
      base->accept(system, at, solution);
    });
    CHECK(corrected > 0);
  }
}

TEST_CASE("weights that are not numbers leave the base guess") {
  const CopingNetSettings settings;
  const auto model = test::random_model(settings);
  std::fill(model->net.parameters().values().begin(), model->net.parameters().values().end(),
            std::numeric_limits<float>::quiet_NaN());
  Scene scene = build_scene(test::bending_rod(6));
  CopingNetGuess guess(model, scene, 2);
  const auto base = base_guess(settings, scene, 2);
  observe(scene, {0.02, 2, 0}, 3, [&](const LinearSystem& system, const SolvePosition& at, const VectorX& solution) {
    VectorX x0(solution.size()), alone(solution.size());
    base->propose(system, at, alone);
    guess.propose(system, at, x0);
    CHECK(x0 == alone);
    guess.accept(system, at, solution);
    base->accept(system, at, solution);
  });
}

TEST_CASE("a right-hand side of zero is answered with zero") {
  Scene scene = build_scene(test::bending_rod(5));
  scene.gravity_m_s2.setZero();
  for (const CopingNetSettings& settings : test::kinds_of_networks()) {
    CopingNetGuess guess(test::random_model(settings), scene, 1);
    const LinearSystem system = test::assembled(scene.rods.front());
    VectorX x0(system.rhs().size());
    const Proposal proposal = guess.propose(system, {}, x0);
    CHECK(x0.allFinite());
    CHECK(x0.norm() < 1e-12);
    CHECK(proposal.nonzero == (x0.norm() > 0));
  }
}

TEST_CASE("where loops are cut a network proposes what lowers the residual, or nothing") {
  const Scene scene = test::scene_of(test::random_rod(test::ring(6), {}, 3));
  const LinearSystem system = test::assembled(scene.rods.front());
  VectorX x0(system.rhs().size());
  int proposed = 0;
  for (const CopingNetSettings& settings : test::kinds_of_networks()) {
    CopingNetGuess guess(test::random_model(settings), scene, 1);
    const Proposal proposal = guess.propose(system, {}, x0);
    proposed += proposal.nonzero;
    CHECK(x0.allFinite());
    if (settings.processor == Processor::message_passing || has_all_couplings(settings)) continue;  // these see loops
    const VectorX residual = test::residual(system.matrix(), system.rhs(), x0);
    CHECK(jacobi_norm_squared(system.matrix(), residual) <= jacobi_norm_squared(system.matrix(), system.rhs()));
    if (proposal.residual) CHECK((residual - *proposal.residual).norm() < 1e-11 * system.rhs().norm());
  }
  CHECK(proposed > 0);
}

CopingNetSettings with_factors() {
  CopingNetSettings settings;
  settings.base = BaseGuess::none;
  return settings;
}

TEST_CASE("factors that lag are those of the first solve of every so many steps") {
  const auto model = test::random_model(with_factors());
  Scene scene = build_scene(test::bending_rod(9));
  std::vector<LinearSystem> systems;
  for (int i = 0; i < 3; ++i) {
    systems.push_back(test::assembled(scene.rods.front()));
    for (std::size_t s = 1; s < scene.rods.front().segments.size(); ++s) {
      const double bend = 0.02 * static_cast<double>(s * s);
      Quaternion& q = scene.rods.front().orientation[s];
      q = Quaternion(Eigen::AngleAxisd(bend, Vector3(1, 0.3, 0.2).normalized())) * q;
      scene.rods.front().position[s] += Vector3(0.01, -0.03, 0.02) * static_cast<double>(s);
    }
  }
  const auto proposed = [&](CopingNetGuess& guess, int system, const SolvePosition& at) {
    VectorX x0(systems.front().rhs().size());
    guess.propose(systems[system], at, x0);
    return x0;
  };
  CopingNetGuess lagging(model, scene, 1, {1, 3}), always(model, scene, 1);
  CHECK(proposed(lagging, 0, {4, 1, 0}) == proposed(always, 0, {4, 1, 0}));  // no earlier factors exist
  CHECK(proposed(lagging, 0, {4, 1, 0}) == proposed(always, 0, {4, 1, 0}));  // the same again
  const VectorX later = proposed(lagging, 1, {4, 2, 0});
  CHECK(later == proposed(lagging, 1, {6, 0, 0}));
  CHECK(later != proposed(always, 1, {6, 0, 0}));
  CHECK(proposed(lagging, 2, {7, 0, 0}) == proposed(always, 2, {7, 0, 0}));
  VectorX x0(systems.front().rhs().size());
  CHECK(lagging.propose(systems[2], {7, 0, 0}, x0).renewed);
  CHECK_FALSE(lagging.propose(systems[2], {7, 1, 0}, x0).renewed);
  CHECK_FALSE(always.propose(systems[2], {7, 0, 0}, x0).renewed);
}

TEST_CASE("corrections stop where the residual is small enough") {
  Scene scene = build_scene(test::bending_rod(9));
  const LinearSystem system = test::assembled(scene.rods.front());
  const auto left = [&](double stop_at, int corrections) {
    CopingNetGuess guess(test::random_model(with_factors()), scene, 1, {corrections, 0, stop_at});
    VectorX x0(system.rhs().size());
    const Proposal proposal = guess.propose(system, {}, x0);
    return std::pair(proposal.products, proposal.residual->norm() / system.rhs().norm());
  };
  CHECK(left(1, 100) == std::pair(0, 1.0));  // zero meets the tolerance
  const auto [products, residual] = left(0.1, 100);
  CHECK(residual <= 0.1);
  CHECK(left(0.1, products - 1).second > 0.1);  // one correction less misses the tolerance
}

TEST_CASE("corrections with factors are steps of conjugate gradients: each lowers the energy, all of them solve") {
  Scene scene = build_scene(test::bending_rod(9));
  const LinearSystem system = test::assembled(scene.rods.front());
  VectorX exact = system.rhs(), error, scratch(exact.size());
  BlockFactor factor(system.matrix(), {0, 1, 2, 3, 4, 5, 6, 7});
  REQUIRE(factor.factorise(system.matrix()));
  factor.substitute(exact);
  CopingNetSettings settings = with_factors();
  double before = energy_norm_squared(system.matrix(), exact, scratch);
  const double all = before;
  for (const int corrections : {1, 2, 3, 5, 8, 200}) {
    CopingNetGuess guess(test::random_model(settings), scene, 1, {corrections});
    VectorX x0(exact.size());
    const Proposal proposal = guess.propose(system, {}, x0);
    CHECK((corrections < 200 ? proposal.products == corrections : proposal.products < 200));  // converges before 200
    error = x0 - exact;
    const double left = energy_norm_squared(system.matrix(), error, scratch);
    CHECK(left < before);
    before = left;
  }
  CHECK(before < 1e-12 * all);

  settings.processor = Processor::message_passing;
  VectorX x0(exact.size());
  CHECK_THROWS_WITH(CopingNetGuess(test::random_model(settings), scene, 1, {2}).propose(system, {}, x0),
                    Catch::Matchers::ContainsSubstring("lag_steps"));
}

TEST_CASE("the joints' order does not matter") {
  // A tree with its joints numbered in reverse gets the same corrections in reverse order.
  const Rod rod = test::random_rod(test::tree(2, 2), {0}, 5);
  Rod other = rod;
  std::reverse(other.joints.begin(), other.joints.end());
  const int count = rod.joint_count();
  for (int j = 0; j < count; ++j) other.lambda.segment<6>(6 * (count - 1 - j)) = rod.lambda.segment<6>(6 * j);
  for (const CopingNetSettings& settings : test::kinds_of_networks()) {
    if (has_all_couplings(settings)) continue;  // the numbering decides which of two siblings is eliminated first
    const auto model = test::random_model(settings);
    const auto guess_of = [&](const Rod& one) {
      const LinearSystem system = test::assembled(one);
      VectorX x0(system.rhs().size());
      CopingNetGuess(model, test::scene_of(one), 1).propose(system, {}, x0);
      return x0;
    };
    const VectorX x = guess_of(rod), y = guess_of(other);
    for (int j = 0; j < count; ++j)
      CHECK((x.segment<6>(6 * j) - y.segment<6>(6 * (count - 1 - j))).norm() < 1e-4 * x.norm());
  }
}

}  // namespace rodsweep::test_coping_net_guess
