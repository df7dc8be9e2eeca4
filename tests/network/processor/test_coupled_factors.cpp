// Factors of all couplings: gradients, the properties that they share with A^-1, incomplete Cholesky as a special case,
// inference.

#include <Eigen/Dense>
#include <map>

#include "network/encoding/feature_encoder.hpp"
#include "network/processor/coupled_inference.hpp"
#include "network/training/correction_loss.hpp"
#include "network/training/example.hpp"
#include "solver/scene/scenes.hpp"
#include "tests/catch.hpp"
#include "tests/network/gradient_check.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_coupled_factors {

using namespace test;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using System = ScaledSystem<double>;

/// The scaled system of a rod, with a random residual.
ScaledSystem<float> system_of(const Rod& rod, unsigned seed = 1) {
  const CopingNetSettings settings;
  const LinearSystem system = assembled(rod);
  FeatureEncoder encoder(settings, rod, system.matrix());
  CanonicalFrames frames(encoder.pattern(), Alignment::matrix);
  const VectorX r = random_matrix(system.matrix().unknowns(), 1, seed).col(0);
  frames.find(encoder.pattern(), system.matrix(), r);
  return canonical_system(encoder.pattern(), frames, system.matrix(), r, r, 1);
}

Rod lattice(int nodes) {
  return build_scene(slender_lattice(Lattice::Cell::cubic, nodes, 2, Held::corners)).rods.front();
}

/// A lattice, a tree and a net side by side.
System some_systems() {
  const ScaledSystem<float> a = system_of(lattice(2)), b = system_of(random_rod(tree(2, 3), {0}, 1)),
                            c = system_of(random_rod(net(3, 3), {0}, 2));
  return side_by_side<double>({&a, &b, &c});
}

Matrix6 coupling(const System& a, const SystemPattern::Coupling& c) {
  return Eigen::Map<const Matrix6>(a.coupling.col(c.block).data());
}

Matrix dense(const System& a) {
  const Eigen::Index n = a.diagonal.cols();
  Matrix out = Matrix::Zero(6 * n, 6 * n);
  for (Eigen::Index k = 0; k < n; ++k)
    out.block<6, 6>(6 * k, 6 * k) = Eigen::Map<const Matrix6>(a.diagonal.col(k).data());
  for (const auto& c : a.couplings) {
    out.block<6, 6>(6 * c.row, 6 * c.column) = coupling(a, c);
    out.block<6, 6>(6 * c.column, 6 * c.row) = coupling(a, c).transpose();
  }
  return out;
}

/// The matrix that `answer` applies.
template <class Answer>
Matrix operators(const Answer& answer, Eigen::Index places) {
  Matrix out(6 * places, 6 * places);
  for (Eigen::Index i = 0; i < 6 * places; ++i) {
    Matrix r = Matrix::Zero(6, places);
    r.reshaped()[i] = 1;
    out.col(i) = answer(r).reshaped();
  }
  return out;
}

/// Incomplete block Cholesky without fill, eliminated from the last place to the first. Has the inverse of each pivot,
/// and for each coupling its block by row and column.
struct Incomplete {
  std::vector<Matrix6> pivot_inverse;
  std::map<std::pair<int, int>, Matrix6> block;
};
Incomplete incomplete(const System& a) {
  Incomplete out;
  std::vector<Matrix6> pivot;
  for (Eigen::Index k = 0; k < a.diagonal.cols(); ++k)
    pivot.emplace_back(Eigen::Map<const Matrix6>(a.diagonal.col(k).data()));
  for (const auto& c : a.couplings) out.block[{c.row, c.column}] = coupling(a, c);
  out.pivot_inverse.resize(pivot.size());
  for (int k = static_cast<int>(pivot.size()) - 1; k >= 0; --k) {
    const Matrix6 inverse = out.pivot_inverse[k] = pivot[k].inverse();
    for (auto i = out.block.lower_bound({k, 0}); i != out.block.end() && i->first.first == k; ++i)
      for (auto j = out.block.lower_bound({k, 0}); j != out.block.end() && j->first.first == k; ++j) {
        const int row = i->first.second, column = j->first.second;
        const Matrix6 less = i->second.transpose() * inverse * j->second;
        if (row == column) pivot[row] -= less;
        if (const auto at = out.block.find({row, column}); at != out.block.end()) at->second -= less;
      }
  }
  return out;
}

/// The factors that represent incomplete Cholesky: one coupling per side determines T.
Matrix factors_of(const System& a, const Incomplete& cholesky) {
  Matrix out = Matrix::Zero(CoupledPasses<double>::size, a.diagonal.cols());
  for (Eigen::Index k = 0; k < out.cols(); ++k)
    for (int c = 0, to = 0; c < 6; ++c)
      for (int r = c; r < 6; ++r) out(to++, k) = cholesky.pivot_inverse[k](r, c);
  for (const auto& c : a.couplings)
    Eigen::Map<Matrix6>(&out(21 + 36 * c.side, c.row)) =
        cholesky.pivot_inverse[c.row] * cholesky.block.at({c.row, c.column}) * coupling(a, c).inverse();
  return out;
}

TEST_CASE("with the pivots of elimination a chain and a tree are solved exactly") {
  for (const Rod& rod : {random_rod(chain(12), {0}, 1), random_rod(tree(3, 2), {0}, 2)}) {
    const ScaledSystem<float> one = system_of(rod);
    const System a = side_by_side<double>({&one});
    CoupledPasses<double> passes;
    passes.forward(a, factors_of(a, incomplete(a)), a.residual);
    const VectorX exact = dense(a).ldlt().solve(a.residual.reshaped());
    CHECK((passes.y.reshaped() - exact).norm() < 1e-4 * exact.norm());
  }
}

template <class T>
struct Net {
  Parameters<T> weights;
  CoupledFactors<T> factors;
  typename CoupledFactors<T>::Tape tape;

  /// Shifts the weights away from their start, where T = 0.
  explicit Net(int latent, std::uint64_t seed = 1) {
    WeightSource source(seed);
    factors = CoupledFactors<T>(weights, latent, source);
    for (T& w : weights.values()) w += T(0.02);
  }
  Tensor<T> operator()(const ScaledSystem<T>& systems) {
    Tensor<T> y;
    factors.forward(weights, systems, tape, y);
    return y;
  }
};

TEST_CASE("the gradients of factors of all couplings are those of central differences") {
  const System a = some_systems();
  Net<double> net(3);
  const Matrix weights = random_matrix(6, static_cast<int>(a.diagonal.cols()), 3);
  const auto loss = [&] { return net(a).cwiseProduct(weights).sum(); };
  loss();
  Parameters<double> gradient = net.weights.zeros();
  net.factors.backward(net.weights, a, net.tape, weights, gradient);
  CHECK(gradient_error(net.weights.values(), gradient.values(), loss) < 1e-6);
}

TEST_CASE("the gradient of what several corrections leave is that of central differences") {
  System a = some_systems();
  a.residual = random_matrix(6, static_cast<int>(a.diagonal.cols()), 7);
  a.base_energy = a.unit_energy = {1e4, 2e4, 3e4};
  Net<double> net(3);
  CorrectionLoss<double> loss(3);
  const auto value = [&] {
    net.factors.predict(net.weights, a, net.tape);
    return loss(a, net.tape.factors, nullptr);
  };
  Matrix d_factors;
  net.factors.predict(net.weights, a, net.tape);
  loss(a, net.tape.factors, &d_factors);
  Parameters<double> gradient = net.weights.zeros();
  net.factors.learn(net.weights, a, net.tape, d_factors, gradient);
  CHECK(gradient_error(net.weights.values(), gradient.values(), value) < 1e-5);
}

TEST_CASE("enough corrections leave nothing, and of exact factors one") {
  const ScaledSystem<float> one = system_of(random_rod(chain(4), {0}, 1));
  System a = side_by_side<double>({&one});
  const double energy = a.residual.reshaped().dot(dense(a).ldlt().solve(a.residual.reshaped()));
  a.base_energy = a.unit_energy = {energy};
  Parameters<double> weights;
  WeightSource source(3);
  const CoupledFactors<double> untrained(weights, 4, source);
  CoupledFactors<double>::Tape tape;
  untrained.predict(weights, a, tape);
  CHECK(CorrectionLoss<double>(1)(a, tape.factors, nullptr) > 0.1);
  CHECK(CorrectionLoss<double>(30)(a, tape.factors, nullptr) < 1e-3);
  CHECK(CorrectionLoss<double>(1)(a, factors_of(a, incomplete(a)), nullptr) < 1e-3);
}

TEST_CASE("answers of all couplings are linear in the residual, symmetric and positive definite") {
  System a = some_systems();
  Net<double> net(4);
  const auto answer = [&](const Matrix& r) {
    a.residual = r;
    return net(a);
  };
  const Eigen::Index n = a.diagonal.cols();
  const Matrix f = operators(answer, n), r = random_matrix(6, static_cast<int>(n), 5);
  CHECK((f - f.transpose()).norm() < 1e-12 * f.norm());
  CHECK((f * r.reshaped() - answer(r).reshaped()).norm() < 1e-12 * f.norm() * r.norm());
  CHECK(f.llt().info() == Eigen::Success);
}

TEST_CASE("untrained factors of all couplings are Jacobi's: the residual itself") {
  const System a = some_systems();
  Parameters<double> weights;
  WeightSource source(3);
  const CoupledFactors<double> factors(weights, 4, source);
  weights[factors.layers().factors.weight()].setZero();
  CoupledFactors<double>::Tape tape;
  Matrix y;
  factors.forward(weights, a, tape, y);
  CHECK(y == a.residual);
}

TEST_CASE("inference of factors of all couplings gives the training code's answers, as exactly as its operands") {
  CopingNetSettings settings;
  settings.couplings = Couplings::all;
  for (const int latent : {16, 32})
    for (const Rod& rod :
         {random_rod(chain(20), {0}, 3), random_rod(tree(3, 2), {0}, 3), random_rod(net(3, 3), {0}, 3), lattice(3)}) {
      const LinearSystem system = assembled(rod);
      FeatureEncoder encoder(settings, rod, system.matrix());
      const SystemPattern& pattern = encoder.pattern();
      CanonicalFrames frames(pattern, Alignment::matrix);
      Net<float> net(latent);
      net.weights[net.factors.layers().factors.weight()] *= 0.1F;
      CoupledInference inference(net.factors, net.weights, pattern);
      const VectorX r = random_matrix(system.matrix().unknowns(), 1, 2).col(0);
      frames.find(pattern, system.matrix(), r);
      const Tensor<float> y = net(canonical_system(pattern, frames, system.matrix(), r, r, 1));
      VectorX expected(r.size()), d(r.size());
      for (int place = 0; place < static_cast<int>(pattern.joint.size()); ++place) {
        Lane8 answer{};
        for (int row = 0; row < 6; ++row) answer[row] = y(row, place);
        store6(expected.data() + 6 * pattern.joint[place],
               frames.rho() * frames.scale(place) * frames.frame(place).back(answer));
      }
      inference.factorise(frames, system.matrix());
      inference.solve(r, d);
      CHECK((d - expected).norm() < (narrow_bits == 16 ? 1e-2 : 1e-5) * expected.norm());
    }
}

TEST_CASE("a latent size without a kernel for factors of all couplings is refused") {
  const Net<float> net(24);
  const SystemPattern pattern;
  CHECK_THROWS_WITH(CoupledInference(net.factors, net.weights, pattern), Catch::Matchers::ContainsSubstring("24"));
}

}  // namespace rodsweep::test_coupled_factors
