// Statics of forks, kinks and cones against beams: small deflections under a weight of 1e-5 of gravity.
#include <cmath>

#include "tests/catch.hpp"
#include "tests/solver/simulation.hpp"

namespace rodsweep::test_validation_trees {

constexpr double youngs = 1e9, density = 1000, radius = 0.01, gravity = 9.81e-5;
constexpr double area = pi * radius * radius, stiffness = youngs * area * radius * radius / 4;
constexpr double load = density * area * gravity;  ///< w [N/m]

/// Branches are lists of nodes; every branch begins at a node of those before it.
class Branches {
 public:
  Branches() : skeleton_{{-1, {0, 0, 0}, radius}} {}

  /// A straight branch; returns its last node.
  int grow(int from, const Vector3& edges_sum, int edges, double end_radius = radius) {
    const Vector3 start = skeleton_[at(from)].position_m;
    const double begin = skeleton_[at(from)].radius_m;
    for (int i = 1; i <= edges; ++i) {
      const double share = static_cast<double>(i) / edges;
      skeleton_.push_back({from, start + share * edges_sum, begin + share * (end_radius - begin)});
      from = static_cast<int>(skeleton_.size()) - 1;
    }
    return from;
  }

  /// Settled under a weight along `direction`; returns displacements of all nodes' edges' upper ends.
  std::vector<Vector3> sag(const Vector3& direction, double torsion_modulus = youngs / 2.6) const {
    SkeletonTree p;
    p.trees = std::make_shared<const std::vector<Skeleton>>(1, skeleton_);
    p.density_kg_m3 = density;
    p.youngs_modulus_pa = youngs;
    p.torsion_modulus_pa = torsion_modulus;
    p.gravity_m_s2 = gravity * direction;
    Simulation simulation(build_scene(p), 1.0, 20, 1e-10);  // a second: relaxation takes few steps
    simulation.relax(1e-14);
    const Rod& rod = simulation.rod();
    std::vector<Vector3> out{Vector3::Zero()};
    for (std::size_t i = 1; i < skeleton_.size(); ++i)
      out.push_back(rod.position[i] + rod.orientation[i] * Vector3(0, 0, rod.segments[i].length_m / 2) -
                    skeleton_[i].position_m);
    return out;
  }

 private:
  Skeleton skeleton_;
};

/// Towards the root, or up, as seen from a horizontal beam along x.
Vector3 at_angle(double degrees, bool level) {
  const double angle = degrees * pi / 180;
  return {std::cos(angle), level ? 0 : std::sin(angle), level ? std::sin(angle) : 0};
}

TEST_CASE("a cantilever sags as if no other branch left its root, in whatever direction it leaves and is listed") {
  const double theory = load / (8 * stiffness);
  for (const double degrees : {30.0, 60.0, 90.0, 135.0, 160.0, 180.0})
    for (const bool level : {false, true}) {
      CAPTURE(degrees, level);
      const Vector3 stub = 0.2 * at_angle(degrees, level), beam = Vector3::UnitX(), down = -Vector3::UnitY();
      Branches stub_first, beam_first;
      stub_first.grow(0, stub, 1);
      const int one = stub_first.grow(0, beam, 16), other = beam_first.grow(0, beam, 16);
      beam_first.grow(0, stub, 1);
      const double sag = -stub_first.sag(down)[at(one)].y();
      CHECK(sag == Approx(theory).epsilon(5e-3));
      CHECK(sag == Approx(-beam_first.sag(down)[at(other)].y()).epsilon(1e-9));
    }
}

/// Error of a deflection at 8, 16 and 32 edges.
template <class Deflection>
void check_second_order(const Deflection& deflection, double theory, double greatest_at_16) {
  const double error[] = {deflection(8) / theory - 1, deflection(16) / theory - 1, deflection(32) / theory - 1};
  CAPTURE(error[0], error[1], error[2]);
  CHECK(std::abs(error[1]) < greatest_at_16);
  CHECK(std::abs(error[0]) > 3 * std::abs(error[1]));
  CHECK(std::abs(error[1]) > 3 * std::abs(error[2]));
}

TEST_CASE("the tip of an L frame sinks by 5/8 w L^4 / EI, to second order in its edges") {
  check_second_order(
      [](int edges) {
        Branches frame;
        const int tip = frame.grow(frame.grow(0, Vector3::UnitY(), edges), Vector3::UnitX(), edges);
        return -frame.sag(-Vector3::UnitY())[at(tip)].y();
      },
      0.625 * load / stiffness, 5e-3);
}

TEST_CASE("a level L frame bends and twists: its tip sinks as beams do, for any torsion modulus") {
  for (const double torsion_modulus : {youngs / 3, youngs, 10 * youngs}) {
    const double torsion = torsion_modulus * 2 * stiffness / youngs;
    // First arm along x: its own weight, the second's weight w L at its end and the torque w L^2 / 2 about it. Second
    // arm along z: clamped to the first's end, which sinks and twists.
    const double theory = load / stiffness * (1.0 / 8 + 1.0 / 3 + 1.0 / 8) + load / (2 * torsion);
    check_second_order(
        [&](int edges) {
          Branches frame;
          const int tip = frame.grow(frame.grow(0, Vector3::UnitX(), edges), Vector3::UnitZ(), edges);
          return -frame.sag(-Vector3::UnitY(), torsion_modulus)[at(tip)].y();
        },
        theory, 8e-3);
  }
}

TEST_CASE("a fork bends its stem by the moments of all branches, to second order in its edges") {
  const double half_angle = pi / 4;
  // Stem along x: its own weight, that of both branches at its end, and their moments across and along it; the latter
  // cancel. Branches: clamped to the stem's end, which sinks and tilts.
  const double moment = 2 * load / 2 * std::cos(half_angle), force = 2 * load;
  const double sink = (load / 8 + force / 3 + moment / 2) / stiffness;
  const double tilt = (load / 6 + force / 2 + moment) / stiffness;
  const double theory = sink + tilt * std::cos(half_angle) + load / (8 * stiffness);
  check_second_order(
      [&](int edges) {
        Branches fork;
        const int end = fork.grow(0, Vector3::UnitX(), edges);
        const int left = fork.grow(end, at_angle(45, true), edges), right = fork.grow(end, at_angle(-45, true), edges);
        const std::vector<Vector3> sag = fork.sag(-Vector3::UnitY());
        CHECK(sag[at(left)].y() == Approx(sag[at(right)].y()).epsilon(1e-9));
        return -sag[at(left)].y();
      },
      theory, 8e-3);
}

TEST_CASE("a cone's sag is a tapered cantilever's to second order in its edges, which have its mass at any number") {
  // E I y'' = M with I ~ r^4, from the tip; r in units of the root's.
  const int steps = 20000;
  double shear = 0, moment = 0, theory = 0;
  for (int i = steps - 1; i >= 0; --i) {
    const double h = 1.0 / steps, s = (i + 0.5) * h, r = 1 - s / 2;
    moment += h * (shear + h * load * r * r / 2);
    shear += h * load * r * r;
    theory += h * (1 - s) * (moment - h * shear / 2) / (stiffness * std::pow(r, 4));
  }
  check_second_order(
      [](int edges) {
        Branches cone;
        const int tip = cone.grow(0, Vector3::UnitX(), edges, radius / 2);
        return -cone.sag(-Vector3::UnitY())[at(tip)].y();
      },
      theory, 8e-3);
  for (const int edges : {1, 5}) {
    SkeletonTree p;
    Skeleton cone{{-1, {0, 0, 0}, radius}};
    for (int i = 1; i <= edges; ++i)
      cone.push_back({i - 1, {static_cast<double>(i) / edges, 0, 0}, radius * (1 - 0.5 * i / edges)});
    p.trees = std::make_shared<const std::vector<Skeleton>>(1, cone);
    p.density_kg_m3 = density;
    double mass = 0;
    const Scene scene = build_scene(p);
    for (const Segment& s : scene.rods[0].segments) mass += s.mass;
    CHECK(mass == Approx(density * area * 7 / 12).epsilon(1e-12));
  }
}

}  // namespace rodsweep::test_validation_trees
