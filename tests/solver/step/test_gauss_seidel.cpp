// What both Gauss-Seidel projections conserve and refuse, on any graph of joints.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include "solver/step/gauss_seidel.hpp"
#include "solver/step/observables.hpp"
#include "tests/solver/stepping.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep::test_gauss_seidel {

std::unique_ptr<Projection> make(const std::string& name, const Scene& scene) {
  if (name == "xpbd") return std::make_unique<XpbdProjection>(scene);
  return std::make_unique<PbdProjection>(scene, PbdStiffness{0.8, 0.5});
}

/// Moving segments in random poses; each joint is at rest, halfway between its segments.
Scene jointed(const test::Edges& edges, const std::vector<int>& static_segments) {
  test::Random random(11);
  std::vector<SegmentSpec> segments;
  for (int i = 0; i < test::segments_of(edges); ++i)
    segments.push_back({0.2 * i * Vector3::UnitZ() + random.vector(0.1), random.quaternion(), 0.2, 0.05, 1000, false});
  for (const int i : static_segments) segments[i].is_static = true;
  std::vector<JointSpec> joints;
  for (const auto& [a, b] : edges) {
    const Vector3 half = (segments[b].position_m - segments[a].position_m) / 2;
    joints.push_back({a, b, segments[a].orientation.conjugate() * half, segments[b].orientation.conjugate() * -half,
                      joint_compliance(0.2, circular_section(0.05, 1e6, 1e6), 1e-6), std::nullopt});
  }
  Scene scene = test::scene_of(Rod(segments, joints));
  for (Vector3& v : scene.rods[0].velocity) v = random.vector(0.05);
  for (const int i : static_segments) scene.rods[0].velocity[i].setZero();
  return scene;
}

const char* const methods[] = {"pbd", "xpbd"};

TEST_CASE("joints take turns from both ends, every one once an iteration") {
  using Order = std::vector<int>;
  CHECK(bilateral_order(0) == Order{});
  CHECK(bilateral_order(1) == Order{0});
  CHECK(bilateral_order(2) == Order{0, 1});
  CHECK(bilateral_order(6) == Order{0, 5, 2, 3, 4, 1});
  CHECK(bilateral_order(7) == Order{0, 5, 2, 3, 4, 1, 6});
}

TEST_CASE("Gauss-Seidel conserves the linear momentum of a free rod to rounding") {
  for (const char* method : methods) {
    INFO(method);
    Scene scene = jointed(test::chain(8), {});
    scene.gravity_m_s2.setZero();
    const Vector3 before = linear_momentum(scene.rods[0]);
    const auto projection = make(method, scene);
    TimeStepper stepper(scene, {0.01, 20, 0});
    for (int step = 0; step < 50; ++step) stepper.step(*projection);
    REQUIRE(joint_gap(scene.rods[0]) > 0);
    CHECK((linear_momentum(scene.rods[0]) - before).norm() < 1e-11 * before.norm());
  }
}

TEST_CASE("chains held at both ends, trees, rings and nets are projected alike") {
  const std::pair<test::Edges, std::vector<int>> graphs[] = {
      {test::chain(6), {0, 5}}, {test::tree(2, 2), {0}}, {test::ring(6), {}}, {test::net(2, 3), {0}}};
  for (const auto& [edges, held] : graphs) {
    INFO(edges.size() << " joints, " << held.size() << " held");
    const Scene start = jointed(edges, held);
    const Scene newton = test::after_newton(start, 1e-3);
    const Scene xpbd = test::after<XpbdProjection>(start, 1e-3, 3000);
    CHECK(newton_residual(xpbd.rods[0], 1e-3) < 1e-13);
    CHECK(test::distance(newton, start, &Rod::position) > 2e-5);
    CHECK(test::distance(xpbd, newton, &Rod::position) < 1e-7);

    Scene closed = start;
    PbdProjection pbd(closed, {});
    test::Recorder recorder(pbd);
    TimeStepper(closed, {1e-3, 300, 0}).step(recorder);
    CHECK(recorder.residuals().back() < 0.1 * recorder.residuals().front());
  }
}

TEST_CASE("a step ends below the tolerance, and says how many iterations that took") {
  for (const char* method : methods) {
    INFO(method);
    Scene scene = jointed(test::chain(3), {0});
    const auto projection = make(method, scene);
    test::Recorder recorder(*projection);
    const StepReport report = TimeStepper(scene, {0.005, 5000, 1e-6}).step(recorder);
    CHECK(report.outcome == SolveOutcome::converged);
    CHECK(report.newton_iterations > 3);
    CHECK(report.newton_iterations + 1 == static_cast<int>(recorder.reports.size()));
    CHECK(recorder.reports.back().outcome == SolveOutcome::not_run);
    CHECK(recorder.reports.back().newton_residual < 1e-6);
    CHECK(recorder.reports[recorder.reports.size() - 2].newton_residual >= 1e-6);
  }
}

TEST_CASE("a NaN in the state ends a Gauss-Seidel step") {
  for (const char* method : methods) {
    Scene scene = test::moving_scene(6);
    scene.rods[0].velocity[3].y() = std::numeric_limits<double>::quiet_NaN();
    const auto projection = make(method, scene);
    const StepReport report = TimeStepper(scene, {0.02, 10, 1e-9}).step(*projection);
    CHECK(report.outcome == SolveOutcome::not_a_number);
    CHECK(report.newton_iterations == 1);
  }
}

TEST_CASE("Gauss-Seidel refuses a joint that nothing can move") {
  const Scene scene = jointed(test::chain(4), {1, 2});
  for (const char* method : methods)
    CHECK_THROWS_WITH(make(method, scene), "joint 1 joins two static segments; remove it or free one of them");
}

}  // namespace rodsweep::test_gauss_seidel
