// The features and training data of a linear system, and the loss of a correction against dense algebra.
#include <numeric>

#include "network/encoding/system_encoding.hpp"
#include "network/training/energy_loss.hpp"
#include "tests/catch.hpp"
#include "tests/network/gradient_check.hpp"

namespace rodsweep::test_scaled_system {

using test::Matrix;

/// A random rod's system with a base guess, dense and scaled, in the order of the forest.
struct Case {
  Rod rod;
  JointForest forest;
  LinearSystem system;
  SystemPattern pattern;
  VectorX solution, base, residual, scale;
  ScaledSystem<float> scaled;
  Eigen::MatrixXd a;  ///< A^, dense

  explicit Case(const test::Edges& edges, unsigned seed, bool with_base = true)
      : rod(test::random_rod(edges, {0}, seed)),
        forest(joint_forest(rod)),
        system(test::assembled(rod)),
        pattern(system_pattern(forest, system.matrix())) {
    const Eigen::MatrixXd dense = system.matrix().dense();
    solution = test::dense_solve(dense, system.rhs());
    test::Random random(seed + 7);
    base = with_base ? VectorX(solution + 0.3 * solution.norm() / std::sqrt(double(solution.size())) *
                                              random.entries(static_cast<int>(solution.size())))
                     : VectorX(VectorX::Zero(solution.size()));
    residual = system.rhs() - dense * base;
    scale.resize(solution.size());
    const double rho = correction_scale(system.matrix(), residual, scale);
    scaled = scaled_system(pattern, system.matrix(), residual, solution - base, solution.dot(system.rhs()));
    const Eigen::MatrixXd unscaled = scale.asDiagonal() * dense * scale.asDiagonal() / (rho * rho);
    a.resizeLike(unscaled);
    for (int i = 0; i < forest.size(); ++i)
      for (int k = 0; k < forest.size(); ++k)
        a.block<6, 6>(6 * i, 6 * k) =
            unscaled.block<6, 6>(6 * forest.order[std::size_t(i)], 6 * forest.order[std::size_t(k)]);
  }
  /// d = scale * d^, where d^ is the network's output.
  VectorX unscaled(const Matrix& d) const {
    VectorX out(solution.size());
    for (int i = 0; i < forest.size(); ++i) {
      const int joint = forest.order[std::size_t(i)];
      out.segment<6>(6 * joint) = scale.segment<6>(6 * joint).cwiseProduct(d.col(i));
    }
    return out;
  }
};

TEST_CASE("the scaled matrix has a unit diagonal, its product is the dense one, its residual a unit mean square") {
  for (const test::Edges& edges : {test::chain(7), test::tree(2, 3)}) {
    const Case c(edges, 3);
    CHECK((c.a.diagonal().array() - 1).abs().maxCoeff() < 1e-12);
    CHECK(c.scaled.residual.array().square().mean() == Approx(1).epsilon(1e-6));
    const Matrix x = test::random_matrix(6, c.forest.size(), 1);
    Matrix y(6, x.cols());
    multiply<double>(side_by_side<double>({&c.scaled}), x, y);
    CHECK((y.reshaped() - c.a * x.reshaped()).norm() < 1e-6 * y.norm());
  }
}

TEST_CASE("the features are the residual, the diagonal blocks' off-diagonals and the blocks with the parents") {
  const Case c(test::tree(2, 2), 5);
  JointForest places = c.forest;
  std::iota(places.order.begin(), places.order.end(), 0);
  const Tensor<float> features = system_features(c.scaled, places);
  for (int i = 0; i < c.forest.size(); ++i) {
    CHECK((features.col(i).head<6>() - c.scaled.residual.col(i)).norm() < 1e-6);
    int row = 6;
    for (int k = 0; k < 6; ++k)
      for (int r = 0; r < k; ++r) CHECK(features(row++, i) == Approx(c.a(6 * i + r, 6 * i + k)).margin(1e-6));
    const int parent = c.forest.parent[std::size_t(i)];
    for (int k = 0; k < 6; ++k)
      for (int r = 0; r < 6; ++r)
        CHECK(features(row++, i) == Approx(parent < 0 ? 0 : c.a(6 * i + r, 6 * parent + k)).margin(1e-6));
  }
}

TEST_CASE("a residual of zero has features, a scale and a loss without NaN") {
  Case c(test::chain(4), 2);
  Tensor<float> features(SystemEncoding::size, c.forest.size());
  SystemEncoding(c.pattern, Alignment::residual)
      .encode(c.pattern, c.system.matrix(), VectorX::Zero(c.solution.size()), features);
  CHECK(features.allFinite());
  CHECK(correction_scale(c.system.matrix(), VectorX::Zero(c.solution.size()), c.scale) == 0);
  CHECK(c.scale.isZero());
}

TEST_CASE("features do not change with the units of length, mass and time") {
  // Scales segments, arms and compliances to another unit of length and mass; compliance and 1/mass scale alike. A^ and
  // r^ of the dimensionless constraints do not change.
  const Rod rod = test::random_rod(test::chain(5), {0}, 4);
  std::vector<SegmentSpec> segments;
  std::vector<JointSpec> joints;
  const double metre = 3, kilogram = 5;
  for (std::size_t i = 0; i < rod.segments.size(); ++i) {
    const Segment& s = rod.segments[i];
    segments.push_back({rod.position[i] * metre, rod.orientation[i], s.length_m * metre, s.radius_m * metre,
                        s.density_kg_m3 * kilogram / std::pow(metre, 3), s.is_static});
  }
  for (const Joint& j : rod.joints)
    joints.push_back(
        {j.a, j.b, j.arm_a * metre, j.arm_b * metre, j.compliance / (kilogram * metre * metre), j.rest(), j.frame_a});
  Rod other(segments, joints);
  other.lambda = rod.lambda * kilogram * metre * metre;

  const auto features = [](const Rod& of) {
    const LinearSystem system = test::assembled(of);
    const SystemPattern pattern = system_pattern(joint_forest(of), system.matrix());
    Tensor<float> out(SystemEncoding::size, of.joint_count());
    SystemEncoding(pattern, Alignment::residual).encode(pattern, system.matrix(), system.rhs(), out);
    return out;
  };
  CHECK((features(rod) - features(other)).norm() < 1e-5 * features(rod).norm());
}

/// The loss by dense algebra in double precision: adds the best multiple of d to the base, then takes k steps of CG.
double dense_loss(const Case& c, const VectorX& d, int steps) {
  const Eigen::MatrixXd a = c.system.matrix().dense();
  VectorX x = c.base + d.dot(c.residual) / d.dot(a * d) * d;
  const VectorX inverse = a.diagonal().cwiseInverse();
  VectorX r = c.system.rhs() - a * x, z = inverse.cwiseProduct(r), p = z;
  for (int k = 0; k < steps; ++k) {
    const double rz = r.dot(z), alpha = rz / p.dot(a * p);
    x += alpha * p;
    r -= alpha * a * p;
    z = inverse.cwiseProduct(r);
    p = z + r.dot(z) / rz * p;
  }
  const VectorX e = c.solution - x;
  return std::sqrt(e.dot(a * e) / c.solution.dot(c.system.rhs()));
}

TEST_CASE("the loss is the energy norm of what the best multiple and some steps of CG leave") {
  for (const int steps : {0, 1, 4}) {
    for (const bool with_base : {true, false}) {
      const Case c(test::tree(2, 2), 8, with_base);
      const Matrix d = test::random_matrix(6, c.forest.size(), 2);
      EnergyLoss<double> loss(steps);
      CHECK(loss(side_by_side<double>({&c.scaled}), d, nullptr) ==
            Approx(dense_loss(c, c.unscaled(d), steps)).epsilon(1e-4));
      CHECK(loss(side_by_side<double>({&c.scaled}), 7 * d, nullptr) ==
            Approx(loss(side_by_side<double>({&c.scaled}), d, nullptr)).epsilon(1e-10));
    }
  }
}

TEST_CASE("the loss of several systems is the sum of theirs, its gradient that of central differences") {
  const Case one(test::chain(5), 1), two(test::tree(2, 2), 2, false);
  const ScaledSystem<double> both = side_by_side<double>({&one.scaled, &two.scaled});
  const int places = one.forest.size() + two.forest.size();
  std::vector<double> values(static_cast<std::size_t>(6 * places));
  Eigen::Map<Matrix> d(values.data(), 6, places);
  d = test::random_matrix(6, places, 3);
  for (const int steps : {0, 1, 3}) {
    EnergyLoss<double> loss(steps);
    const double together = loss(both, d, nullptr);
    CHECK(together == Approx(loss(side_by_side<double>({&one.scaled}), d.leftCols(one.forest.size()), nullptr) +
                             loss(side_by_side<double>({&two.scaled}), d.rightCols(two.forest.size()), nullptr))
                          .epsilon(1e-12));
    Matrix gradient;
    loss(both, d, &gradient);
    CHECK(test::gradient_error(values, {gradient.data(), gradient.data() + gradient.size()},
                               [&] { return loss(both, d, nullptr); }) < 1e-6);
  }
}

}  // namespace rodsweep::test_scaled_system
