// Inference of sweeps against the training code.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "network/layers/float_lanes.hpp"
#include "network/processor/sweeps_inference.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep {
namespace test_sweeps_inference {

Tensor<float> random_features(int rows, int columns, unsigned seed) {
  test::Random random(seed);
  Tensor<float> out(rows, columns);
  for (float& entry : out.reshaped()) entry = static_cast<float>(random.uniform(-1, 1));
  return out;
}

TEST_CASE("the exponential of gates is exact to a few units of the last place, and clamped") {
  for (float x = -25; x < 25; x += 0.0173F) {
    const float exact = std::exp(std::clamp(x, -20.F, 20.F));
    CHECK(std::abs(clamped_exp(broadcast_lane(x))[3] - exact) < 3e-7F * exact);
  }
}

TEST_CASE("inference gives the training code's outputs, for chains and trees and every latent size") {
  const Recurrence recurrence = GENERATE(Recurrence::gated, Recurrence::linear);
  for (const int latent : {16, 32, 48, 64}) {
    for (const test::Edges& edges : {test::chain(2), test::chain(20), test::tree(3, 2)}) {
      const JointForest one = joint_forest(test::random_rod(edges, {0}, 3));
      const JointForest forest = side_by_side(std::vector<const JointForest*>{&one});
      Parameters<float> weights;
      WeightSource source(5);
      const Sweeps<float> sweeps(weights, 57, latent, 6, recurrence, source);
      for (float& w : weights.values()) w += 0.01F;  // biases too
      const Tensor<float> x = random_features(57, forest.size(), 2);
      Sweeps<float>::Tape tape;
      Tensor<float> expected, y(6, forest.size());
      sweeps.forward(weights, forest, x, tape, expected);
      SweepsInference inference(sweeps, weights, forest.size());
      inference.run(forest, x, y);
      CHECK((y - expected).norm() < 2e-6F * (1 + expected.norm()));
    }
  }
}

TEST_CASE("a latent size without a kernel is refused") {
  Parameters<float> weights;
  WeightSource source(1);
  const Sweeps<float> sweeps(weights, 3, 24, 6, Recurrence::gated, source);
  CHECK_THROWS_WITH(SweepsInference(sweeps, weights, 4), Catch::Contains("24"));
}

}  // namespace test_sweeps_inference
}  // namespace rodsweep
