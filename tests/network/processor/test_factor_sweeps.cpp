// Learned factors: gradients, the properties that they share with A^-1, inference.
#include <Eigen/Eigenvalues>

#include "network/encoding/feature_encoder.hpp"
#include "network/processor/factor_inference.hpp"
#include "tests/catch.hpp"
#include "tests/network/gradient_check.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_factor_sweeps {

using namespace test;

/// Two trees, a chain and a cut ring side by side.
JointForest some_forest() {
  const JointForest a = joint_forest(random_rod(tree(2, 3), {0}, 1)), b = joint_forest(random_rod(chain(6), {0}, 2)),
                    c = joint_forest(random_rod(tree(3, 2), {}, 3)), d = joint_forest(random_rod(ring(5), {}, 4));
  return side_by_side(std::vector<const JointForest*>{&a, &b, &c, &d});
}

template <class T>
struct Net {
  Parameters<T> weights;
  FactorSweeps<T> sweeps;
  typename FactorSweeps<T>::Tape tape;

  /// Shifts the weights away from their start, where T = 0.
  explicit Net(int latent, std::uint64_t seed = 1) {
    WeightSource source(seed);
    sweeps = FactorSweeps<T>(weights, latent, source);
    for (T& w : weights.values()) w += T(0.05);
  }
  Tensor<T> operator()(const JointForest& forest, const Tensor<T>& x) {
    Tensor<T> y;
    sweeps.forward(weights, forest, x, tape, y);
    return y;
  }
};

/// Features in the order of places; couplings are small, as in scaled systems.
Matrix features(const JointForest& forest, unsigned seed, double size = 0.3) {
  return size * random_matrix(57, forest.size(), seed);
}

TEST_CASE("the gradients of factors are those of central differences") {
  const JointForest forest = some_forest();
  Net<double> net(5);
  const Matrix x = features(forest, 2), weights = random_matrix(6, forest.size(), 3);
  const auto loss = [&] { return net(forest, x).cwiseProduct(weights).sum(); };
  loss();
  Parameters<double> gradient = net.weights.zeros();
  net.sweeps.backward(net.weights, forest, x, net.tape, weights, gradient);
  CHECK(gradient_error(net.weights.values(), gradient.values(), loss) < 1e-7);
  Parameters<double> twice = gradient;
  loss();
  net.sweeps.backward(net.weights, forest, x, net.tape, weights, twice);
  for (std::size_t i = 0; i < twice.values().size(); ++i)  // a second backward pass adds the same
    CHECK(twice.values()[i] == Approx(2 * gradient.values()[i]).margin(1e-14));
}

TEST_CASE("a tree's factors are the same alone and beside others") {
  const JointForest alone = joint_forest(random_rod(chain(6), {0}, 2)),
                    other = joint_forest(random_rod(tree(2, 3), {0}, 1));
  const JointForest both = side_by_side(std::vector{&other, &alone});
  Net<double> net(6);
  const Matrix x = features(both, 4);
  Matrix ordered(x.rows(), x.cols());
  for (int i = 0; i < both.size(); ++i) ordered.col(i) = x.col(both.order[i]);
  const Matrix together = net(both, ordered), expected = net(alone, x.rightCols(alone.size()));
  for (int i = 0; i < both.size(); ++i) {
    const int place = both.order[i] - other.size();
    if (place >= 0) CHECK((together.col(i) - expected.col(place)).norm() < 1e-14);
  }
}

TEST_CASE("answers are linear in the residual and symmetric, and see the whole tree") {
  const JointForest forest = some_forest();
  Net<double> net(6);
  Matrix x = features(forest, 4);
  const int n = forest.size();
  Matrix operators(6 * n, 6 * n);
  for (int i = 0; i < n; ++i)
    for (int row = 0; row < 6; ++row) {
      x.topRows(6).setZero();
      x(row, i) = 1;
      operators.col(6 * i + row) = net(forest, x).reshaped();
    }
  CHECK((operators - operators.transpose()).norm() < 1e-12 * operators.norm());
  x.topRows(6) = random_matrix(6, n, 5);
  CHECK((operators * x.topRows(6).reshaped() - net(forest, x).reshaped()).norm() < 1e-12 * operators.norm());
  const auto root_of = [&](int place) {
    while (forest.parent[place] >= 0) place = forest.parent[place];
    return place;
  };
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) CHECK((operators.block<6, 6>(6 * i, 6 * k).norm() > 0) == (root_of(i) == root_of(k)));
}

TEST_CASE("untrained factors are Jacobi's: the residual itself, whatever is beside the diagonal") {
  const JointForest forest = some_forest();
  Parameters<double> weights;
  WeightSource source(3);
  const FactorSweeps<double> sweeps(weights, 4, source);
  weights[sweeps.layers().factors.weight()].setZero();
  const Matrix x = features(forest, 6);
  FactorSweeps<double>::Tape tape;
  Matrix y;
  sweeps.forward(weights, forest, x, tape, y);
  CHECK(y == x.topRows(6));
}

TEST_CASE("a state that has grown too long is not carried on, and gradients stay finite") {
  const JointForest forest = joint_forest(random_rod(chain(200), {0}, 1));
  Net<float> net(4);
  for (float& w : net.weights.values()) w *= 8;
  const Tensor<float> x = features(forest, 7).cast<float>();
  const Tensor<float> y = net(forest, x);
  CHECK(y.allFinite());
  CHECK(y.norm() > FactorSweeps<float>::longest_state);
  Parameters<float> gradient = net.weights.zeros();
  net.sweeps.backward(net.weights, forest, x, net.tape, y / y.norm(), gradient);
  for (const float g : gradient.values()) REQUIRE(std::isfinite(g));
}

TEST_CASE("inference of factors gives the training code's answers, as exactly as its operands, to any residual") {
  const CopingNetSettings settings;
  for (const int latent : {16, 32, 48})
    for (const Edges& edges : {chain(5), chain(20), tree(3, 2), ring(7)}) {
      const Rod rod = random_rod(edges, {0}, 3);
      const LinearSystem system = assembled(rod);
      FeatureEncoder encoder(settings, rod, system.matrix());
      const JointForest& forest = encoder.topology().forest;
      Net<float> net(latent);
      net.weights[net.sweeps.layers().factors.weight()] *= 0.02F;  // keeps the states of long chains bounded
      FactorInference inference(net.sweeps, net.weights, forest, encoder.pattern());
      Tensor<float> nodes(0, rod.segment_count()), x(SystemEncoding::size, forest.size());
      for (const unsigned seed : {2U, 9U}) {
        const VectorX r = random_matrix(6 * forest.size(), 1, seed).col(0);
        encoder.encode(rod, system, 0, VectorX(), r, nodes, x);
        const Tensor<float> y = net(forest, x);
        VectorX expected(r.size()), d(r.size());
        for (int place = 0; place < forest.size(); ++place) {
          Lane8 answer{};
          for (int row = 0; row < 6; ++row) answer[row] = y(row, place);
          store6(expected.data() + 6 * encoder.pattern().joint[place], encoder.system()->from_unit(place, answer));
        }
        if (seed == 2) inference.factorise(x, encoder.system()->frames(), system.matrix());
        inference.solve(r, d);
        CHECK((d - expected).norm() < (narrow_bits == 16 ? 3e-3 : 1e-5) * expected.norm());
      }
    }
}

TEST_CASE("factors that are made positive are positive definite, and the same where they were") {
  const Rod rod = random_rod(tree(3, 2), {0}, 3);
  const LinearSystem system = assembled(rod);
  const CopingNetSettings settings;
  FeatureEncoder encoder(settings, rod, system.matrix());
  const JointForest& forest = encoder.topology().forest;
  Tensor<float> nodes(0, rod.segment_count()), x(SystemEncoding::size, forest.size());
  const int size = 6 * forest.size();
  encoder.encode(rod, system, 0, VectorX(), VectorX::Ones(size), nodes, x);
  for (const float scale : {0.001F, 1.0F}) {
    Net<float> net(16);
    net.weights[net.sweeps.layers().factors.weight()] *= scale;
    FactorInference inference(net.sweeps, net.weights, forest, encoder.pattern());
    const auto dense = [&](bool positive) {
      inference.factorise(x, encoder.system()->frames(), system.matrix(), positive);
      MatrixX out(size, size);
      VectorX column(size);
      for (int k = 0; k < size; ++k) {
        inference.solve(VectorX::Unit(size, k), column);
        out.col(k) = column;
      }
      // In the metric of A's diagonal, where single precision resolves all eigenvalues.
      const VectorX d = system.matrix().dense().diagonal().cwiseSqrt();
      return MatrixX(d.asDiagonal() * (out + out.transpose()) / 2 * d.asDiagonal());
    };
    const MatrixX as_predicted = dense(false), positive = dense(true);
    const auto least = [](const MatrixX& m) {
      return Eigen::SelfAdjointEigenSolver<MatrixX>(m).eigenvalues().minCoeff();
    };
    CHECK((least(as_predicted) > 0) == (scale < 1));
    CHECK(least(positive) > 0);
    CHECK(positive.isApprox(as_predicted, 1e-6) == (scale < 1));
  }
}

TEST_CASE("a latent size without a kernel for factors is refused") {
  const Net<float> net(24);
  const JointForest forest = some_forest();
  const SystemPattern pattern;
  CHECK_THROWS_WITH(FactorInference(net.sweeps, net.weights, forest, pattern),
                    Catch::Matchers::ContainsSubstring("24"));
}

}  // namespace rodsweep::test_factor_sweeps
