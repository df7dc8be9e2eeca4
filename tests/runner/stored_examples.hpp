// For tests of data sets: a solve that keeps its systems, for comparison with the recorded ones.
#pragma once

#include <catch2/catch.hpp>

#include "network/encoding/stored_simulation.hpp"
#include "solver/step/time_step.hpp"

namespace rodsweep {

/// The direct solve; keeps every system and its solution.
class SolveProbe : public LinearSolve {
 public:
  struct Solved {
    SolvePosition at;
    bool balanced;
    BlockMatrix a;
    VectorX b, solution;
    std::vector<Vector3> velocity, angular_velocity;
  };

  explicit SolveProbe(const Scene& scene) : scene_(scene), direct_(scene) {}

  SolveOutcome solve(const LinearSystem& system, const SolvePosition& at, double assemble_s,
                     VectorX& delta_lambda) override {
    const SolveOutcome outcome = direct_.solve(system, at, assemble_s, delta_lambda);
    const Rod& rod = scene_.rods[static_cast<std::size_t>(at.rod)];
    solved_.push_back(
        {at, system.keeps_balance(), system.matrix(), system.rhs(), delta_lambda, rod.velocity, rod.angular_velocity});
    return outcome;
  }

  /// Of every step, the solves of the first `count` Newton iterations.
  std::vector<Solved> first_iterations(int count) const {
    std::vector<Solved> chosen;
    for (const Solved& s : solved_)
      if (s.at.newton < count) chosen.push_back(s);
    return chosen;
  }

 private:
  const Scene& scene_;
  DirectSolve direct_;
  std::vector<Solved> solved_;
};

inline bool same_bits(const BlockMatrix& a, const BlockMatrix& b) {
  if (a.block_count() != b.block_count()) return false;
  for (int block = 0; block < a.block_count(); ++block)
    for (int column = 0; column < 6; ++column)
      for (int row = 0; row < 6; ++row) {
        const auto i = static_cast<std::size_t>(block);
        if (a.blocks[i].column[column][row] != b.blocks[i].column[column][row]) return false;
      }
  return true;
}

/// Assembles each stored system again in a rod of `scene` and compares it with the solved one, bit for bit.
inline void check_same(const std::vector<StoredSystem>& systems, Scene scene,
                       const std::vector<SolveProbe::Solved>& solved) {
  REQUIRE(systems.size() == solved.size());
  for (std::size_t i = 0; i < systems.size(); ++i) {
    const StoredSystem& system = systems[i];
    CAPTURE(i, system.at.step, system.at.newton, system.at.rod);
    CHECK(system.at.step == solved[i].at.step);
    CHECK(system.at.newton == solved[i].at.newton);
    CHECK(system.at.rod == solved[i].at.rod);
    Rod& rod = scene.rods[static_cast<std::size_t>(system.at.rod)];
    LinearSystem again(rod);
    assemble_again(system, rod, again);
    CHECK(again.keeps_balance() == solved[i].balanced);
    CHECK(same_bits(again.matrix(), solved[i].a));
    CHECK(again.rhs() == solved[i].b);
    CHECK(system.solution == solved[i].solution);
    CHECK(rod.velocity == solved[i].velocity);
    CHECK(rod.angular_velocity == solved[i].angular_velocity);
    VectorX product = VectorX::Zero(again.rhs().size());
    again.matrix().multiply(system.solution.data(), product.data());
    CHECK((product - again.rhs()).norm() <= 1e-10 * again.rhs().norm());
  }
}

}  // namespace rodsweep
