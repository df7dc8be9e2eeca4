// Backward passes against central differences, in double precision; and what a sweep sees.
#include <catch2/catch.hpp>

#include "network/processor/sweeps.hpp"
#include "tests/network/gradient_check.hpp"

namespace rodsweep {
namespace test_gradients {

using namespace test;

TEST_CASE("the gradients of an MLP are those of central differences, for weights and inputs") {
  const int hidden_layers = GENERATE(1, 2, 3);
  CAPTURE(hidden_layers);
  Parameters<double> p;
  WeightSource source(1);
  const Mlp<double> mlp(p, "mlp", 4, 7, 3, source, 1, hidden_layers);
  REQUIRE(static_cast<int>(p.entries().size()) == 4 + 2 * (hidden_layers - 1));
  for (double& v : p.values()) v += 0.1;  // biases too
  std::vector<double> inputs(4 * 5);
  Eigen::Map<Matrix> x(inputs.data(), 4, 5);
  x = random_matrix(4, 5, 2);
  const Matrix weights = random_matrix(3, 5, 3);
  Mlp<double>::Tape tape;
  Matrix y;
  const auto loss = [&] {
    mlp.forward(p, x, tape, y);
    return y.cwiseProduct(weights).sum();
  };
  loss();
  Parameters<double> gradient = p.zeros();
  Matrix dx = Matrix::Zero(4, 5);
  mlp.backward(p, x, tape, weights, gradient, &dx);
  CHECK(gradient_error(p.values(), gradient.values(), loss) < 1e-8);
  CHECK(gradient_error(inputs, std::vector<double>(dx.data(), dx.data() + dx.size()), loss) < 1e-8);
}

/// Two trees and a chain, side by side.
JointForest some_forest() {
  const JointForest a = joint_forest(test::random_rod(test::tree(2, 3), {0}, 1));
  const JointForest b = joint_forest(test::random_rod(test::chain(6), {0}, 2));
  const JointForest c = joint_forest(test::random_rod(test::tree(3, 2), {}, 3));
  return side_by_side(std::vector<const JointForest*>{&a, &b, &c});
}

TEST_CASE("the gradients of sweeps are those of central differences") {
  const Recurrence recurrence = GENERATE(Recurrence::gated, Recurrence::linear);
  const JointForest forest = some_forest();
  Parameters<double> p;
  WeightSource source(1);
  const Sweeps<double> sweeps(p, 3, 5, 2, recurrence, source);
  for (double& v : p.values()) v += 0.05;
  const Matrix x = random_matrix(3, forest.size(), 2), weights = random_matrix(2, forest.size(), 3);
  Sweeps<double>::Tape tape;
  Matrix y;
  const auto loss = [&] {
    sweeps.forward(p, forest, x, tape, y);
    return y.cwiseProduct(weights).sum();
  };
  loss();
  Parameters<double> gradient = p.zeros();
  sweeps.backward(p, forest, x, tape, weights, gradient);
  CHECK(gradient_error(p.values(), gradient.values(), loss) < 1e-7);
}

TEST_CASE("gradients add up: a second backward doubles them") {
  const JointForest forest = some_forest();
  Parameters<double> p;
  WeightSource source(4);
  const Sweeps<double> sweeps(p, 3, 4, 2, Recurrence::gated, source);
  const Matrix x = random_matrix(3, forest.size(), 5), dy = random_matrix(2, forest.size(), 6);
  Sweeps<double>::Tape tape;
  Matrix y;
  sweeps.forward(p, forest, x, tape, y);
  Parameters<double> once = p.zeros(), twice = p.zeros();
  sweeps.backward(p, forest, x, tape, dy, once);
  for (int i = 0; i < 2; ++i) sweeps.backward(p, forest, x, tape, dy, twice);
  for (std::size_t i = 0; i < once.values().size(); ++i)
    CHECK(twice.values()[i] == Approx(2 * once.values()[i]).margin(1e-14));
}

TEST_CASE("every output sees every input of its own tree, and none of another") {
  const Recurrence recurrence = GENERATE(Recurrence::gated, Recurrence::linear);
  const JointForest forest = some_forest();
  Parameters<double> p;
  WeightSource source(7);
  const Sweeps<double> sweeps(p, 3, 6, 2, recurrence, source);
  Matrix x = random_matrix(3, forest.size(), 8), before, after;
  Sweeps<double>::Tape tape;
  sweeps.forward(p, forest, x, tape, before);
  const auto tree_of = [&](int place) {
    while (forest.parent[static_cast<std::size_t>(place)] >= 0) place = forest.parent[static_cast<std::size_t>(place)];
    return place;
  };
  const int changed = forest.size() - 1;  // a tip
  x(0, changed) += 1;
  sweeps.forward(p, forest, x, tape, after);
  int same_tree = 0;
  for (int i = 0; i < forest.size(); ++i) {
    const double difference = (after.col(i) - before.col(i)).norm();
    if (tree_of(i) == tree_of(changed)) {
      CHECK(difference > 0);
      ++same_tree;
    } else {
      CHECK(difference == 0);
    }
  }
  CHECK(same_tree > 4);
}

TEST_CASE("a rod's outputs are the same alone and beside others") {
  const JointForest tree = joint_forest(test::random_rod(test::tree(2, 3), {0}, 1));
  const JointForest chain = joint_forest(test::random_rod(test::chain(6), {0}, 2));
  const JointForest both = side_by_side(std::vector<const JointForest*>{&tree, &chain});
  Parameters<double> p;
  WeightSource source(9);
  const Sweeps<double> sweeps(p, 3, 6, 2, Recurrence::gated, source);
  const Matrix x = random_matrix(3, both.size(), 4);
  Matrix ordered(3, both.size()), together, alone;
  for (int i = 0; i < both.size(); ++i) ordered.col(i) = x.col(both.order[static_cast<std::size_t>(i)]);
  Sweeps<double>::Tape tape;
  sweeps.forward(p, both, ordered, tape, together);
  sweeps.forward(p, chain, x.rightCols(chain.size()), tape, alone);
  for (int i = 0; i < both.size(); ++i) {
    const int place = both.order[static_cast<std::size_t>(i)] - tree.size();
    if (place >= 0) CHECK((together.col(i) - alone.col(place)).norm() < 1e-14);
  }
}

}  // namespace test_gradients
}  // namespace rodsweep
