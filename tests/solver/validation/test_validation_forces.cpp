// Forces and moments in rods, and of clamps and obstacles, against closed forms, by both integrators and turned in
// space. Forces are the action of a joint's second segment on its first (joint_forces.hpp).
#include <cmath>

#include "solver/rod/joint_forces.hpp"
#include "tests/catch.hpp"
#include "tests/solver/touching.hpp"
#include "tests/solver/turned.hpp"

namespace rodsweep::test_validation_forces {

using test::RigidMotion;

/// The scene at rest. Steps keep the balance of momentum.
class Rest : public Simulation {
 public:
  Rest(const Scene& initial, Integrator integrator, double dt)
      : Simulation(initial, StepSettings{dt, 40, 1e-13, integrator}, 1e-12) {
    relax(1e-12);
  }
};

/// Calls `check(rest, turn)` with the scene at rest, by both integrators, as it is and moved; `turn` maps vectors.
template <class Check>
void at_rest(const Scene& scene, const Check& check) {
  for (const Integrator integrator : {Integrator::euler, Integrator::bdf2})
    for (const RigidMotion& motion :
         {RigidMotion{Quaternion::Identity(), {0, 0, 0}}, test::motions[0], test::motions[2]}) {
      INFO((integrator == Integrator::euler ? "Euler" : "BDF2") << ", turned by " << motion.turn.coeffs().transpose());
      check(Rest(moved(scene, motion), integrator, 0.3), motion);
    }
}

/// An elastic rod of 1 m along +x that a wall holds.
BendingRod rod_on_wall(int segments) {
  BendingRod p = weightless_cantilever(segments, 1e8, 4e7, 1, 0.01);
  p.damping_per_s = 2;
  return p;
}

/// Forces of all clamps hold the weight of all free segments.
void check_weight_is_held(const Simulation& rest, const Vector3& load = Vector3::Zero()) {
  Action outer;
  for (const Rod& rod : rest.scene.rods)
    for (std::size_t s = 0; s < rod.segments.size(); ++s)
      if (!rod.segments[s].is_static) outer.add(rod.position[s], rod.segments[s].mass * rest.scene.gravity_m_s2);
  const Action clamps = rest.reactions().clamps;
  CHECK((clamps.force_n + outer.force_n + load).norm() < 1e-9 * (outer.force_n + load).norm());
  if (load.isZero(0)) CHECK((clamps.moment_nm + outer.moment_nm).norm() < 1e-6 * outer.force_n.norm());
}

TEST_CASE("a hanging rod carries at each joint the weight and the load below it") {
  for (const Stretch stretch : {Stretch::inextensible, Stretch::physical}) {
    BendingRod p = rod_on_wall(10);
    p.stretch = stretch;
    p.gravity_m_s2 = {9.81, 0, 0};
    p.tip_force_n = {2, 0, 0};
    at_rest(build_scene(p), [&](const Simulation& rest, const RigidMotion& motion) {
      const Rod& rod = rest.scene.rods.front();
      const Vector3 down = motion.turn * Vector3::UnitX();
      const double weight_per_m = p.density_kg_m3 * pi * p.radius_m * p.radius_m * 9.81;
      for (int k = 0; k < rod.joint_count(); ++k) {
        const auto [force, moment] = joint_action(rod, k);
        CHECK((force - (weight_per_m * (1 - 0.1 * k) + 2) * down).norm() < 1e-9);
        CHECK(moment.norm() < 1e-9);
      }
      check_weight_is_held(rest, 2 * down);
    });
  }
}

TEST_CASE("a cantilever carries the load at its end, and its moment, to the wall") {
  const double load = 1e-2;  // [N]; P L^2 / EI = .013
  BendingRod p = rod_on_wall(10);
  p.tip_force_n = {0, -load, 0};
  at_rest(build_scene(p), [&](const Simulation& rest, const RigidMotion& motion) {
    const Rod& rod = rest.scene.rods.front();
    const Vector3 down = motion.turn * Vector3(0, -load, 0), about = motion.turn * Vector3(0, 0, -load);
    for (int k = 0; k < rod.joint_count(); ++k) {
      const auto [force, moment] = joint_action(rod, k);
      CHECK((force - down).norm() < 1e-7 * load);
      CHECK((moment - (1 - 0.1 * k) * about).norm() < 1e-4 * load);  // of the straight rod
      const Vector3 arm = tip(rod) - point_on_b(rod, rod.joints[at(k)]);
      CHECK((moment - arm.cross(down)).norm() < 1e-7 * load);  // of the bent one
    }
    const Action clamp = rest.reactions().clamps;
    CHECK((clamp.force_n + down).norm() < 1e-7 * load);
    CHECK((clamp.moment_nm + tip(rod).cross(down)).norm() < 1e-6 * load);
  });
}

TEST_CASE("a rod whose end is turned by theta carries the torque GJ theta / L, and its clamps cancel") {
  const double theta = 0.2;
  BendingRod p = rod_on_wall(20);
  p.tip_motion = TipMotion{{0, 0, 0}, {theta * 180 / pi, 0, 0}, 0.1};
  const double torque = p.torsion_modulus_pa * pi * std::pow(p.radius_m, 4) / 2 * theta;  // L = 1 m
  at_rest(build_scene(p), [&](const Simulation& rest, const RigidMotion& motion) {
    const Rod& rod = rest.scene.rods.front();
    for (int k = 0; k < rod.joint_count(); ++k)
      CHECK((joint_action(rod, k).moment_nm - torque * (motion.turn * Vector3::UnitX())).norm() < 1e-4 * torque);
    CHECK(rest.reactions().clamps.moment_nm.norm() < 1e-6 * torque);
  });
}

TEST_CASE("clamps carry the weight of nets, rings and helices at rest") {
  Net net;
  net.rows = net.columns = 3;
  Ring ring;
  ring.segments = 16;
  Helix helix;
  helix.segments = 20;
  const auto held = [](auto p, double modulus_pa) {
    p.youngs_modulus_pa = p.torsion_modulus_pa = modulus_pa;
    at_rest(build_scene(p), [&](const Simulation& rest, const RigidMotion&) { check_weight_is_held(rest); });
  };
  held(net, 1e7);
  held(ring, 1e7);
  held(helix, 1e9);
}

TEST_CASE("the floor carries the weight of a rod that lies on it") {
  for (const Integrator integrator : {Integrator::euler, Integrator::bdf2})
    for (const bool balance : {false, true}) {
      const Rod rod = test::roller(6, 0.02);
      Scene scene = test::contact_scene({rod}, 0.3, {0, -9.81, 0});
      scene.obstacles = {HalfSpace{}};
      test::Touching at(scene, 0.01, integrator, balance);
      at.run(60);
      double weight = 0;
      for (const Segment& segment : rod.segments) weight += 9.81 * segment.mass;
      CHECK((at.reactions().obstacles.force_n - weight * Vector3::UnitY()).norm() < 1e-3 * weight);
      CHECK(at.reactions().clamps.force_n.isZero(0));
    }
}

}  // namespace rodsweep::test_validation_forces
