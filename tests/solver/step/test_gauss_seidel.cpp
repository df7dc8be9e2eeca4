// Gauss-Seidel projections: what both conserve and refuse on any graph of joints; XPBD against Newton; PBD in closed
// form.
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "solver/step/gauss_seidel.hpp"
#include "solver/step/observables.hpp"
#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"
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

/// A rod of six segments after a smooth fall of 0.1 s.
Scene falling(double modulus_pa, std::optional<double> stretch_compliance_per_j = std::nullopt) {
  BendingRod spec = test::bending_rod(6);
  spec.youngs_modulus_pa = spec.torsion_modulus_pa = modulus_pa;
  spec.stretch_compliance_per_j = stretch_compliance_per_j;
  Simulation simulation(build_scene(spec), 1e-3, 20);
  simulation.run(100);
  return simulation.scene;
}

/// Orders in the step of the distance of one XPBD step from Newton's, for three halvings of `longest_s`.
std::vector<double> orders(const Scene& start, std::vector<Vector3> Rod::*of, double longest_s, int iterations) {
  std::vector<double> found;
  double before = 0;
  for (int halvings = 0; halvings < 4; ++halvings) {
    const double dt = longest_s / (1 << halvings);
    const double apart =
        test::distance(test::after<XpbdProjection>(start, dt, iterations), test::after_newton(start, dt), of);
    if (halvings > 0) found.push_back(std::log2(before / apart));
    before = apart;
  }
  return found;
}

TEST_CASE("with a single joint an XPBD iteration is a Newton iteration") {
  for (const int iterations : {1, 2, 3}) {
    const Scene start = test::moving_scene(2);
    Simulation newton(start, {0.02, iterations, 0});
    newton.step();
    const Scene xpbd = test::after<XpbdProjection>(start, 0.02, iterations);
    REQUIRE(test::distance(newton.scene, start, &Rod::position) > 1e-3);
    CHECK(test::distance(xpbd, newton.scene, &Rod::position) < 1e-14);
    CHECK((xpbd.rods[0].lambda - newton.rod().lambda).norm() < 1e-10 * newton.rod().lambda.norm());
  }
}

TEST_CASE("converged XPBD is Newton's step, to O(dt^4) in positions and O(dt^3) in velocities") {
  // They differ in the positions at which J is evaluated. These are O(dt^2) apart.
  const Scene start = falling(1e6);
  for (const double order : orders(start, &Rod::position, 0.01, 5000)) CHECK(order == Approx(4).margin(0.6));
  for (const double order : orders(start, &Rod::velocity, 0.01, 5000)) CHECK(order == Approx(3).margin(0.6));
  const Scene newton = test::after_newton(start, 1e-3), xpbd = test::after<XpbdProjection>(start, 1e-3, 5000);
  CHECK(test::distance(xpbd, newton, &Rod::position) < 1e-10);
}

TEST_CASE("where steps resolve all stiffness, every XPBD iteration gains two orders of the step on Newton") {
  // alpha~ = alpha/dt^2 outgrows J M^-1 J^T: an iteration leaves a fraction O(dt^2) of a correction of O(dt^2).
  const Scene start = falling(1e4, 1e-4);
  for (const double order : orders(start, &Rod::position, 1e-3, 1)) CHECK(order == Approx(4).margin(0.5));
  for (const double order : orders(start, &Rod::position, 2e-3, 2)) CHECK(order == Approx(6).margin(0.7));
}

/// Two free coaxial segments of 0.2 m and radius 0.05 m, joined end to end, at rest.
Scene pair() {
  SegmentSpec a{{0, 0, 0}, Quaternion::Identity(), 0.2, 0.05, 1000, false}, b = a;
  b.position_m.z() = 0.2;
  Scene scene;
  scene.rods.emplace_back(std::vector{a, b},
                          std::vector{JointSpec{0, 1, {0, 0, 0.1}, {0, 0, -0.1}, Vector6::Zero(), std::nullopt}});
  return scene;
}

/// One iteration on the first rod.
ProjectionReport iterate(Scene& scene, const PbdStiffness& stiffness) {
  return PbdProjection(scene, stiffness).project(scene.rods[0], {}, 0.02, 0);
}

TEST_CASE("a shear gap closes by its stiffness, a stretched joint by the share that positions have") {
  const double r2 = 0.05 * 0.05, l2 = 0.2 * 0.2;
  const double turning = 2 * 12 / (3 * r2 + l2) * l2 / 4;  // i arm^2 of both sides, per w
  for (const double stiffness : {0.25, 1.0}) {
    Scene sheared = pair(), stretched = pair();
    sheared.rods[0].position[1].x() += 1e-6;
    stretched.rods[0].position[1].z() += 1e-6;
    CHECK(iterate(sheared, {stiffness, 0}).newton_residual == Approx(1e-6 / 0.2));
    iterate(stretched, {stiffness, 0});
    CHECK(0.2 * joint_gap(sheared.rods[0]) == Approx(1e-6 * (1 - stiffness)).margin(1e-11));
    CHECK(0.2 * joint_gap(stretched.rods[0]) == Approx(1e-6 * (1 - stiffness * 2 / (2 + turning))));
  }
}

TEST_CASE("bend and twist are undone by their stiffness") {
  for (const Vector3& axis : {Vector3(1, 0, 0), Vector3(0, 0, 1)})
    for (const double stiffness : {0.25, 1.0}) {
      Scene scene = pair();
      const double angle = 1e-3;
      scene.rods[0].orientation[1] = Quaternion(Eigen::AngleAxisd(angle, axis));
      CHECK(iterate(scene, {0, stiffness}).newton_residual == Approx(2 * std::sin(angle / 2)));
      const Quaternion& a = scene.rods[0].orientation[0];
      CHECK(a.angularDistance(scene.rods[0].orientation[1]) == Approx(angle * (1 - stiffness)).margin(1e-8));
      CHECK(a.angularDistance(Quaternion::Identity()) == Approx(angle * stiffness / 2).epsilon(1e-5));
    }
}

TEST_CASE("PBD knows no moduli: it is Newton's step only as they and the stretching stiffness grow without bound") {
  const double dt = 0.01;
  const auto cantilever = [](double modulus_pa) {
    BendingRod spec = test::bending_rod(4);
    spec.youngs_modulus_pa = spec.torsion_modulus_pa = modulus_pa;
    spec.stretch_compliance_per_j = 0;
    return build_scene(spec);
  };
  const Scene pbd = test::after<PbdProjection>(cantilever(1e4), dt, 20000, PbdStiffness{});
  const auto apart = [&](double modulus_pa) {
    return test::distance(pbd, test::after_newton(cantilever(modulus_pa), dt), &Rod::position);
  };
  CHECK(apart(1e4) > 1e-4);
  for (const double modulus : {1e13, 1e14}) CHECK(apart(modulus) / apart(10 * modulus) == Approx(10).epsilon(0.01));
  CHECK(apart(1e17) < 1e-9);
}

TEST_CASE("more iterations make a PBD rod stiffer") {
  double sag = 3;
  for (const int iterations : {1, 4, 16, 64}) {
    Scene scene = build_scene(test::bending_rod(8));
    const double height = scene.rods[0].position.back().y();
    PbdProjection pbd(scene, {});
    TimeStepper stepper(scene, {0.02, iterations, 0});
    for (int step = 0; step < 400; ++step) stepper.step(pbd);
    const double now = height - scene.rods[0].position.back().y();
    CHECK(now < 0.9 * sag);
    sag = now;
  }
}

}  // namespace rodsweep::test_gauss_seidel
