// A scene that is turned and shifted as a whole, with all that acts on it, is the same scene: its linear systems are,
// to rounding, and CG takes as many iterations.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <variant>

#include "solver/batch/batched_step.hpp"
#include "solver/linear/conjugate_gradient.hpp"
#include "solver/step/pbd_projection.hpp"
#include "solver/step/xpbd_projection.hpp"
#include "tests/solver/support.hpp"

namespace rodsweep {
namespace {

struct RigidMotion {
  Quaternion turn;
  Vector3 shift;

  Vector3 operator()(const Vector3& point) const { return turn * point + shift; }
};

Scene moved(Scene scene, const RigidMotion& to) {
  for (Rod& rod : scene.rods)
    for (int s = 0; s < rod.segment_count(); ++s) {
      rod.position[s] = to(rod.position[s]);
      rod.orientation[s] = to.turn * rod.orientation[s];
      rod.velocity[s] = to.turn * rod.velocity[s];
      rod.angular_velocity[s] = to.turn * rod.angular_velocity[s];
    }
  scene.gravity_m_s2 = to.turn * scene.gravity_m_s2;
  for (PointLoad& load : scene.loads) {
    load.force_n = to.turn * load.force_n;
    load.torque_nm = to.turn * load.torque_nm;
  }
  for (MovingClamp& clamp : scene.clamps)
    clamp.pose = [to, before = clamp.pose](double time_s) {
      const Pose pose = before(time_s);
      return Pose{to(pose.position), to.turn * pose.orientation};
    };
  for (Obstacle& obstacle : scene.obstacles) {
    HalfSpace& floor = std::get<HalfSpace>(obstacle);
    floor = {to(floor.point_m), to.turn * floor.normal};
  }
  return scene;
}

/// Moves the rods as the direct solve does, and looks at every system: its entries, and CG's iterations from zero.
class Observer : public LinearSolve {
 public:
  explicit Observer(const Scene& scene) : direct_(scene) {}

  struct Seen {
    test::MatrixX a;
    VectorX b;
    std::vector<int> iterations;
  };
  std::vector<Seen> seen;

  SolveOutcome solve(const LinearSystem& system, const SolvePosition& at, double assemble_s,
                     VectorX& delta_lambda) override {
    seen.push_back({system.matrix().dense(), system.rhs(), {}});
    ConjugateGradient cg(system.matrix(), {});
    VectorX x(system.rhs().size());
    for (const double tolerance : {1e-1, 1e-2, 1e-3})
      seen.back().iterations.push_back(
          cg.solve(system.rhs(), x.setZero(), false, tolerance, system.rhs().norm()).iterations);
    return direct_.solve(system, at, assemble_s, delta_lambda);
  }

 private:
  DirectSolve direct_;
};

struct Case {
  const char* name;
  Scene scene;
  bool batched = false;
};

std::vector<Case> cases() {
  std::vector<Case> out;
  BendingRod bending = test::bending_rod(12, Clamp::wall);
  out.push_back({"bending rod", build_scene(bending), true});
  bending.tip_force_n = {1, 2, -20};
  bending.stretch = Stretch::physical;
  out.push_back({"rod that stretches and shears", build_scene(bending)});
  Helix helix;
  helix.segments = 24;
  out.push_back({"helix", build_scene(helix), true});
  Ring ring;
  ring.segments = 10;
  out.push_back({"ring", build_scene(ring)});
  Tree tree;
  tree.shape.depth = 2;
  tree.youngs_modulus_pa = tree.torsion_modulus_pa = 1e7;
  tree.gravity_m_s2 = {3, -9, 1};
  out.push_back({"tree", build_scene(tree)});
  return out;
}

const RigidMotion motions[] = {
    {Quaternion(Eigen::AngleAxisd(1.1, Vector3(1, 2, -1).normalized())), {0.3, -1, 2}},
    {Quaternion(Eigen::AngleAxisd(3.1, Vector3(0, 1, 0.2).normalized())), {0, 0, 0}},
    {Quaternion(Eigen::AngleAxisd(-2.0, Vector3(1, 0, 0.7).normalized())), {-2, 5, 1}},
};

TEST_CASE("a turned scene has the same systems, entry by entry, and CG takes as many iterations") {
  for (const Case& each : cases()) {
    INFO(each.name);
    Scene scene = each.scene;
    Observer original(scene);
    LinearProjection projection(scene, original);
    TimeStepper stepper(scene, {0.02, 3, 0});
    for (int step = 0; step < 6; ++step) REQUIRE(stepper.step(projection).outcome == SolveOutcome::converged);
    for (const RigidMotion& motion : motions) {
      Scene turned = moved(each.scene, motion);
      Observer observer(turned);
      LinearProjection turned_projection(turned, observer);
      TimeStepper turned_stepper(turned, {0.02, 3, 0});
      for (int step = 0; step < 6; ++step) turned_stepper.step(turned_projection);
      REQUIRE(observer.seen.size() == original.seen.size());
      for (std::size_t i = 0; i < observer.seen.size(); ++i) {
        const Observer::Seen &here = observer.seen[i], &there = original.seen[i];
        CHECK(test::scaled_difference(here.a, there.a) < 1e-9);
        CHECK((here.b - there.b).lpNorm<Eigen::Infinity>() < 1e-9);
        if (there.b.norm() < 1e-8) continue;  // noise beside what b is made of
        for (std::size_t t = 0; t < here.iterations.size(); ++t)
          CHECK(std::abs(here.iterations[t] - there.iterations[t]) <= 1);
      }
      for (int s = 0; s < scene.rods[0].segment_count(); ++s)
        CHECK((turned.rods[0].position[s] - motion(scene.rods[0].position[s])).norm() < 1e-9);
      CHECK((turned.rods[0].lambda - scene.rods[0].lambda).norm() < 1e-7 * scene.rods[0].lambda.norm());
    }
  }
}

template <class P>
double apart_after_ten_steps(const Scene& start, const RigidMotion& motion, P project) {
  Scene scene = start, turned = moved(start, motion);
  for (Scene* each : {&scene, &turned}) project(*each);
  double out = 0;
  for (std::size_t r = 0; r < scene.rods.size(); ++r)
    for (int s = 0; s < scene.rods[r].segment_count(); ++s)
      out = std::max(out, (turned.rods[r].position[s] - motion(scene.rods[r].position[s])).norm());
  return out;
}

TEST_CASE("turned scenes move alike under every projection") {
  for (const Case& each : cases())
    for (const RigidMotion& motion : motions) {
      INFO(each.name);
      CHECK(apart_after_ten_steps(each.scene, motion, [](Scene& scene) {
              XpbdProjection xpbd(scene);
              TimeStepper stepper(scene, {0.01, 20, 0});
              for (int step = 0; step < 10; ++step) stepper.step(xpbd);
            }) < 1e-9);
      CHECK(apart_after_ten_steps(each.scene, motion, [](Scene& scene) {
              PbdProjection pbd(scene, {});
              TimeStepper stepper(scene, {0.01, 20, 0});
              for (int step = 0; step < 10; ++step) stepper.step(pbd);
            }) < 1e-9);
      CHECK(apart_after_ten_steps(each.scene, motion, [](Scene& scene) {
              DirectSolve direct(scene);
              LinearProjection balanced(scene, direct, 1e-9);
              TimeStepper stepper(scene, {0.01, 20, 1e-12});
              for (int step = 0; step < 10; ++step) stepper.step(balanced);
            }) < 1e-9);
      if (!each.batched) continue;
      CHECK(apart_after_ten_steps(each.scene, motion, [](Scene& scene) {
              BatchedStepper stepper({scene}, {0.02, 6, 1e-9});
              for (int step = 0; step < 10; ++step) stepper.step();
              stepper.write(0, scene);
            }) < 1e-9);
    }
}

TEST_CASE("turned heaps of falling rods fall alike, contacts and friction included") {
  FallingRods falling;
  falling.rods = 2;
  falling.segments = 6;
  falling.contact.emplace();
  const Scene start = build_scene(falling);
  REQUIRE(!start.obstacles.empty());
  for (const RigidMotion& motion : motions)
    CHECK(apart_after_ten_steps(start, motion, [](Scene& scene) {
            DirectSolve direct(scene);
            LinearProjection projection(scene, direct);
            TimeStepper stepper(scene, {0.01, 6, 1e-9});
            int contacts = 0;
            for (int step = 0; step < 60; ++step) contacts += stepper.step(projection).contacts;
            CHECK(contacts > 0);
          }) < 1e-6);
}

}  // namespace
}  // namespace rodsweep
