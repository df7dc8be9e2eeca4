// A guess that receives the sums of whole steps.
#include <catch2/catch.hpp>
#include <vector>

#include "solver/guess/guarded_guess.hpp"
#include "solver/guess/regression_guess.hpp"
#include "solver/guess/totals_guess.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_totals_guess {

struct Told {
  int step, newton, rod;
  VectorX solution;
  const LinearSystem* system;  ///< null: a total
};

/// Records all accepted solutions and totals; proposes their number.
class Listener : public InitialGuess {
 public:
  explicit Listener(std::vector<Told>& told) : told_(told) {}
  Proposal propose(const LinearSystem&, const SolvePosition&, VectorX& x0) override {
    x0.setConstant(static_cast<double>(told_.size()));
    return {true, 0};
  }
  void accept(const LinearSystem& system, const SolvePosition& at, const VectorX& solution) override {
    told_.push_back({at.step, at.newton, at.rod, solution, &system});
  }
  void accept_total(int rod, int step, const VectorX& total) override {
    told_.push_back({step, 0, rod, total, nullptr});
  }

 private:
  std::vector<Told>& told_;
};

Scene two_rods() {
  Scene scene = build_scene(test::bending_rod(4));
  scene.rods.push_back(scene.rods.front());
  return scene;
}

TEST_CASE("proposing tells nothing: totals are told before, once") {
  const Scene scene = two_rods();
  const LinearSystem system(scene.rods[0]);
  std::vector<Told> told;
  TotalsGuess guess(scene, std::make_unique<Listener>(told));
  VectorX x0(18), again(18);
  guess.prepare({0, 0, 0});
  guess.propose(system, {0, 0, 0}, x0);
  guess.accept(system, {0, 0, 0}, VectorX::Ones(18));
  CHECK(told.size() == 1);
  guess.prepare({1, 0, 0});
  CHECK(told.size() == 2);
  guess.propose(system, {1, 0, 0}, x0);
  guess.propose(system, {1, 0, 0}, again);
  guess.prepare({1, 1, 0});
  CHECK(told.size() == 2);
  CHECK(x0 == again);
}

TEST_CASE("a guess around totals has them told") {
  const Scene scene = two_rods();
  const LinearSystem system(scene.rods[0]);
  std::vector<Told> told;
  GuardedGuess guess(scene, std::make_unique<TotalsGuess>(scene, std::make_unique<Listener>(told)), 1);
  guess.accept(system, {0, 0, 0}, VectorX::Ones(18));
  guess.prepare({1, 0, 0});
  CHECK(told.size() == 2);
}

TEST_CASE("a regression combines totals as the first right-hand sides of their steps make up today's") {
  Scene scene = build_scene(test::bending_rod(6));
  Rod& rod = scene.rods[0];
  LinearSystem system(rod);
  test::Random random(4);
  TotalsGuess guess(scene, std::make_unique<RegressionGuess>(scene, 2, 2, 0));
  VectorX x0(30), lambda[2], first[2], later[2];
  for (int step = 0; step < 2; ++step) {
    rod.lambda = lambda[step] = random.entries(30);
    system.assemble(rod, 0.02);
    first[step] = random.entries(30);
    later[step] = random.entries(30);
    guess.prepare({step, 0, 0});
    guess.propose(system, {step, 0, 0}, x0);
    guess.accept(system, {step, 0, 0}, first[step]);
    rod.lambda = random.entries(30);
    system.assemble(rod, 0.02);
    guess.prepare({step, 1, 0});
    guess.propose(system, {step, 1, 0}, x0);
    guess.accept(system, {step, 1, 0}, later[step]);
  }
  rod.lambda = 3 * lambda[0] - 2 * lambda[1];  // b is -C - alpha~ lambda with C = 0 in all steps
  system.assemble(rod, 0.02);
  guess.prepare({2, 0, 0});
  guess.propose(system, {2, 0, 0}, x0);
  CHECK((x0 - (3 * (first[0] + later[0]) - 2 * (first[1] + later[1]))).norm() < 1e-9 * x0.norm());
}

}  // namespace rodsweep::test_totals_guess
