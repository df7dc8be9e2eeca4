// For tests of contacts: capsules and straight rods, scenes of them advanced by direct solves, and distances.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "solver/contact/contact_bodies.hpp"
#include "solver/scene/scene_parts.hpp"
#include "solver/step/observables.hpp"
#include "tests/solver/simulation.hpp"

namespace rodsweep::test {

/// A straight rod from one point to another.
inline Rod straight_rod(const Vector3& from, const Vector3& to, int segments, const RodParameters& p) {
  const std::vector<SegmentSpec> specs = segments_through(straight_line(from, to, segments), p);
  return rodsweep::chain(specs, p, weight(specs, p));
}

/// A free rigid capsule with a velocity.
inline Rod capsule(const Vector3& from, const Vector3& to, const Vector3& velocity, const RodParameters& p = {}) {
  Rod rod = straight_rod(from, to, 1, p);
  rod.velocity[0] = velocity;
  return rod;
}

inline Scene contact_scene(std::vector<Rod> rods, double friction = 0, const Vector3& gravity = Vector3::Zero()) {
  Scene scene;
  scene.rods = std::move(rods);
  scene.gravity_m_s2 = gravity;
  scene.contact = ContactSettings{};
  scene.contact->friction = friction;
  return scene;
}

/// A stiff straight rod of 20 radii along z, on the plane y = 0.
inline Rod roller(int segments, double radius) {
  RodParameters p;
  p.radius_m = radius;
  p.youngs_modulus_pa = 1e9;
  p.torsion_modulus_pa = 4e8;
  return straight_rod({0, radius, -10 * radius}, {0, radius, 10 * radius}, segments, p);
}

class Touching : public Simulation {
 public:
  Touching(Scene initial, double dt, int newton_iterations = 10, std::optional<double> momentum_tolerance = {})
      : Simulation(std::move(initial), StepSettings{dt, newton_iterations, 1e-9}, momentum_tolerance) {}
  Touching(Scene initial, double dt, Integrator integrator, bool balance = false)
      : Simulation(std::move(initial), StepSettings{dt, 10, 1e-9, integrator},
                   balance ? std::optional(1e-8) : std::nullopt) {}
  /// Returns the deepest penetration after any step.
  double run(int steps) {
    double deepest = 0;
    for (int i = 0; i < steps; ++i) deepest = std::max(deepest, step().penetration);
    return deepest;
  }
};

/// The smallest distance of two axes over the sum of their radii, over all pairs that can touch. 1 means contact.
inline double nearest(const Scene& scene) {
  const ContactBodies bodies(scene);
  std::vector<CapsuleAxis> axes;
  bodies.place(scene, axes);
  double least = HUGE_VAL;
  for (int a = 0; a < bodies.count(); ++a)
    for (int b = a + 1; b < bodies.count(); ++b)
      if (bodies.matter(a, b))
        least = std::min(least, separation(axes[a], axes[b]).norm() / (bodies.body(a).radius + bodies.body(b).radius));
  return least;
}

inline double kinetic_energy(const Scene& scene) {
  double sum = 0;
  for (const Rod& rod : scene.rods) sum += rodsweep::kinetic_energy(rod);
  return sum;
}
inline Vector3 linear_momentum(const Scene& scene) {
  Vector3 sum = Vector3::Zero();
  for (const Rod& rod : scene.rods) sum += rodsweep::linear_momentum(rod);
  return sum;
}
inline Vector3 angular_momentum(const Scene& scene) {
  Vector3 sum = Vector3::Zero();
  for (const Rod& rod : scene.rods) sum += rodsweep::angular_momentum(rod);
  return sum;
}

}  // namespace rodsweep::test
