// A network instead of the solve: the increments that are applied, the segments that they move, refusals.
#include <limits>

#include "network/guess/coping_net_guess.hpp"
#include "network/guess/end_to_end.hpp"
#include "solver/step/observables.hpp"
#include "solver/step/time_step.hpp"
#include "tests/catch.hpp"
#include "tests/network/models.hpp"
#include "tests/solver/simulation.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_end_to_end {

/// An increment source that returns the exact solution.
class ExactIncrements : public IncrementSource {
 public:
  explicit ExactIncrements(const Scene& scene) : direct_(scene) {}
  bool predict(const Rod& rod, const LinearSystem& system, const SolvePosition& at, VectorX& delta_lambda,
               std::vector<Lane8>& moves) override {
    direct_.solve(system, at, 0, delta_lambda);
    system.displacements(rod, delta_lambda, moves);
    return true;
  }

 private:
  DirectSolve direct_;
};

std::unique_ptr<IncrementSource> of_network(const std::shared_ptr<const Model>& model, const Scene& scene) {
  return std::make_unique<CopingNetIncrements>(model, scene, 2);
}

void fill(Model& model, float value) {
  std::fill(model.net.parameters().values().begin(), model.net.parameters().values().end(), value);
}

TEST_CASE("exact increments give the trajectory of the direct solve") {
  Scene scene = build_scene(test::bending_rod(12));
  Simulation direct(scene, {0.02, 4, 1e-9});
  EndToEndProjection projection(scene, std::make_unique<ExactIncrements>(scene));
  TimeStepper stepper(scene, {0.02, 4, 1e-9});
  for (int step = 0; step < 20; ++step) {
    const StepReport report = stepper.step(projection);
    CHECK(report.outcome == SolveOutcome::converged);
    CHECK(report.newton_iterations == direct.step().newton_iterations);
  }
  const Scene& reference = direct.scene;
  for (std::size_t s = 0; s < 12; ++s) {
    CHECK((scene.rods[0].position[s] - reference.rods[0].position[s]).norm() == 0);
    CHECK((scene.rods[0].orientation[s].coeffs() - reference.rods[0].orientation[s].coeffs()).norm() == 0);
  }
}

TEST_CASE("without moves of its own a network moves the segments as its multipliers do") {
  for (const CopingNetSettings& settings : test::kinds_of_networks()) {
    CAPTURE(static_cast<int>(settings.encoding), static_cast<int>(settings.processor), static_cast<int>(settings.base));
    Scene scene = test::moving_scene(8);
    for (Vector3& x : scene.rods[0].position) x += Vector3(0, 0.01 * x.x() * x.x(), 0);  // a nonzero residual
    const auto model = test::random_model(settings);
    Rod expected = scene.rods[0];
    LinearSystem system(expected);
    system.assemble(expected, 0.02);
    VectorX x0(system.rhs().size());
    CopingNetGuess(model, scene, 2).propose(system, {}, x0);
    system.apply(expected, x0);

    EndToEndProjection projection(scene, of_network(model, scene));
    const ProjectionReport report = projection.project(scene.rods[0], {}, 0.02, 1e-9);
    CHECK(report.outcome == SolveOutcome::converged);
    CHECK(report.newton_residual == system.newton_residual());
    CHECK(x0.norm() > 0);
    CHECK(scene.rods[0].lambda == expected.lambda);
    for (std::size_t s = 0; s < 8; ++s) CHECK(scene.rods[0].position[s] == expected.position[s]);
  }
}

TEST_CASE("predicted moves are in the units of the training set and leave static segments where they are") {
  Scene scene = test::moving_scene(6);
  const Rod before = scene.rods[0];
  const auto model = test::random_model(test::message_passing(Encoding::paper_residual, true));
  model->scales.moves.deviation << 0.1F, 0.2F, 0.3F, 0.4F, 0.5F, 0.6F;
  model->scales.multipliers.deviation << 1, 2, 3, 4, 5, 6;

  const LinearSystem system = test::assembled(before);
  FeatureEncoder encoder(model->net.settings(), before, system.matrix());
  const VectorX none = VectorX::Zero(system.rhs().size());
  Tensor<float> nodes(node_features(model->net.settings()), 6), edges(edge_features(model->net.settings()), 5), y,
      moves;
  encoder.encode(before, system, 0, none, system.rhs(), nodes, edges);
  CopingNet<float>::Tape tape;
  model->net.forward(encoder.topology(), nodes, edges, tape, y, &moves);

  EndToEndProjection projection(scene, of_network(model, scene));
  CHECK(projection.project(scene.rods[0], {}, 0.02, 0).outcome == SolveOutcome::converged);
  const Rod& after = scene.rods[0];
  CHECK(after.position[0] == before.position[0]);
  CHECK(after.orientation[0].coeffs() == before.orientation[0].coeffs());
  const Eigen::Vector3d unit(0.1, 0.2, 0.3);
  for (std::size_t s = 1; s < 6; ++s) {
    const Vector3 own = moves.col(static_cast<Eigen::Index>(s)).head<3>().cast<double>().cwiseProduct(unit);
    const Vector3 expected = before.orientation[s] * own;
    CHECK(expected.norm() > 1e-4);
    CHECK((after.position[s] - before.position[s] - expected).norm() < 1e-6 * expected.norm());
    CHECK(after.orientation[s].norm() == Approx(1));
    CHECK(after.orientation[s].angularDistance(before.orientation[s]) > 1e-4);
  }
  for (Eigen::Index place = 0; place < 5; ++place) {
    const int joint = encoder.topology().joint[place];
    const Vector6 expected = y.col(place).cast<double>().cwiseProduct(Vector6(1, 2, 3, 4, 5, 6));
    CHECK((after.lambda.segment<6>(6 * joint) - before.lambda.segment<6>(6 * joint) - expected).norm() <
          1e-6 * expected.norm());
  }
}

TEST_CASE("an answer, or a rod, that is not a number is an outcome and moves nothing") {
  const bool moves = GENERATE(false, true);
  Scene scene = test::moving_scene(5);
  const auto model = test::random_model(test::message_passing(Encoding::paper_residual, moves));
  const Rod before = scene.rods[0];
  SECTION("weights") { fill(*model, std::numeric_limits<float>::quiet_NaN()); }
  SECTION("the unit of the moves") {
    model->scales.moves.deviation[3] = std::numeric_limits<float>::infinity();
    if (!moves) model->scales.multipliers.deviation[3] = std::numeric_limits<float>::infinity();
  }
  SECTION("the state") { scene.rods[0].lambda[0] = std::numeric_limits<double>::quiet_NaN(); }
  EndToEndProjection projection(scene, of_network(model, scene));
  CHECK(projection.project(scene.rods[0], {}, 0.02, 0).outcome == SolveOutcome::not_a_number);
  for (std::size_t s = 0; s < 5; ++s) CHECK(scene.rods[0].position[s] == before.position[s]);
}

TEST_CASE("a rod whose residual is below the tolerance is left alone") {
  Scene scene = test::moving_scene(5);
  const Rod before = scene.rods[0];
  EndToEndProjection projection(
      scene, of_network(test::random_model(test::message_passing(Encoding::paper_residual, true)), scene));
  CHECK(projection.project(scene.rods[0], {}, 0.02, 1).outcome == SolveOutcome::not_run);
  for (std::size_t s = 0; s < 5; ++s) CHECK(scene.rods[0].position[s] == before.position[s]);
}

}  // namespace rodsweep::test_end_to_end
