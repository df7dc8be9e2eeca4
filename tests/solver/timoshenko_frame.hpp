// A space frame of straight Timoshenko beams, the reference for lattices. Two-node elements whose shapes solve the
// beam's equations exactly (Przemieniecki 1968; Friedman & Kosmatka 1993):
//   Phi = 12 EI / (kappa G A L^2),   x = s / L,
//   v  = [2x^3 - 3x^2 - Phi x + 1 + Phi,  L (x^3 - (2 + Phi/2) x^2 + (1 + Phi/2) x),
//         -2x^3 + 3x^2 + Phi x,           L (x^3 - (1 - Phi/2) x^2 - Phi/2 x)] / (1 + Phi)
//   psi = [6 (x^2 - x) / L,  3x^2 - (4 + Phi) x + 1 + Phi,  -6 (x^2 - x) / L,  3x^2 - (2 - Phi) x] / (1 + Phi)
// for (v_1, psi_1, v_2, psi_2) in both planes; stretch and twist are linear. Stiffness is B^T D B, consistent mass
// N^T rho N with rotary inertia, both integrated exactly (four Gauss points). Small displacements; SI.
#pragma once

#include <Eigen/SparseCholesky>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "solver/numbers/rotation.hpp"
#include "solver/rod/rod.hpp"
#include "tests/solver/dense.hpp"

namespace rodsweep::test {

/// Stiffness and mass of a beam.
struct BeamSection {
  Section stiffness;
  double mass_per_m;          ///< rho A
  double inertia_kg_m;        ///< rho I about a diameter
  double polar_inertia_kg_m;  ///< rho J
};

inline BeamSection round_beam(double radius_m, double density_kg_m3, double youngs_modulus_pa,
                              double torsion_modulus_pa) {
  const double area = pi * radius_m * radius_m, second_moment = area * radius_m * radius_m / 4;
  return {circular_section(radius_m, youngs_modulus_pa, torsion_modulus_pa), density_kg_m3 * area,
          density_kg_m3 * second_moment, 2 * density_kg_m3 * second_moment};
}

/// Six degrees of freedom per node: displacement, then rotation, in the world.
class TimoshenkoFrame {
 public:
  explicit TimoshenkoFrame(const BeamSection& section) : section_(section) {}

  int add_node(const Vector3& at) {
    nodes_.push_back(at);
    held_.push_back(false);
    return static_cast<int>(nodes_.size()) - 1;
  }
  /// The node within 1e-6 m of a point.
  int node_at(const Vector3& point) const {
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if ((nodes_[i] - point).norm() < 1e-6) return static_cast<int>(i);
    throw std::runtime_error("the frame has no node there");
  }
  void hold(int node) { held_[node] = true; }
  void add_beam(int a, int b) { beams_.push_back({a, b}); }

  /// Call after all nodes and beams are added.
  void assemble() {
    freedom_.assign(nodes_.size(), -1);
    int count = 0;
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (!held_[i]) freedom_[i] = 6 * count++;
    std::vector<Triplet> stiffness, mass;
    for (const Beam& beam : beams_) {
      const auto [k, m] = matrices(beam);
      add(beam, k, stiffness);
      add(beam, m, mass);
    }
    k_.resize(6 * count, 6 * count);
    m_.resize(6 * count, 6 * count);
    k_.setFromTriplets(stiffness.begin(), stiffness.end());
    m_.setFromTriplets(mass.begin(), mass.end());
    factor_.compute(k_);
  }

  VectorX no_load() const { return VectorX::Zero(k_.rows()); }
  /// The six entries of a free node in a vector over all free nodes.
  auto of(VectorX& all, int node) const { return all.segment<6>(freedom_[node]); }
  Vector6 at(const VectorX& all, int node) const {
    const int first = freedom_[node];
    return first < 0 ? Vector6::Zero() : Vector6(all.segment<6>(first));
  }

  VectorX displacements(const VectorX& loads) const { return factor_.solve(loads); }

  struct Mode {
    double angular_frequency;
    VectorX shape;  ///< largest entry 1
  };
  /// The lowest mode that is not orthogonal to `start`, by inverse iteration.
  Mode lowest_mode(VectorX start) const {
    double square = 0;
    for (int i = 0; i < 200; ++i) {
      const VectorX next = factor_.solve(m_ * start);
      const double before = square;
      square = next.dot(k_ * next) / next.dot(m_ * next);
      start = next / next.lpNorm<Eigen::Infinity>();
      if (std::abs(square - before) < 1e-13 * square) break;
    }
    return {std::sqrt(square), start};
  }

 private:
  using Matrix12 = Eigen::Matrix<double, 12, 12>;
  using Shapes = Eigen::Matrix<double, 6, 12>;
  using Triplet = Eigen::Triplet<double>;
  struct Beam {
    int a, b;
  };

  // Local frame: x and y across the beam, z along it. Unknowns: displacement and rotation of both ends.
  std::pair<Matrix12, Matrix12> matrices(const Beam& beam) const {
    const Vector3 way = nodes_[beam.b] - nodes_[beam.a];
    const double length = way.norm();
    const Section& s = section_.stiffness;
    Vector6 rigidity, inertia;  // of strains: shear (2), stretch, bending (2), twist
    rigidity << s.shear_n, s.shear_n, s.axial_n, s.bending_x_nm2, s.bending_y_nm2, s.torsion_nm2;
    inertia << Vector3::Constant(section_.mass_per_m), section_.inertia_kg_m, section_.inertia_kg_m,
        section_.polar_inertia_kg_m;
    const double phi = 12 * s.bending_x_nm2 / (s.shear_n * length * length);
    Matrix12 k = Matrix12::Zero(), m = Matrix12::Zero();
    constexpr double places[] = {0.861136311594053, 0.339981043584856},
                     weights[] = {0.347854845137454, 0.652145154862546};
    for (int i = 0; i < 2; ++i)
      for (const double sign : {-1.0, 1.0}) {
        const auto [n, b] = shapes((1 + sign * places[i]) / 2, length, phi);
        const double weight = weights[i] / 2 * length;
        k += weight * b.transpose() * rigidity.asDiagonal() * b;
        m += weight * n.transpose() * inertia.asDiagonal() * n;
      }
    const Matrix3 frame = turn_between(Vector3::UnitZ(), way).toRotationMatrix();
    Matrix12 to_local = Matrix12::Zero();
    for (int i = 0; i < 12; i += 3) to_local.block<3, 3>(i, i) = frame.transpose();
    return {to_local.transpose() * k * to_local, to_local.transpose() * m * to_local};
  }

  /// N: displacement and rotation at x from those of the ends; B: the strains. Bending along local y rotates about -x.
  static std::pair<Shapes, Shapes> shapes(double x, double length, double phi) {
    const double f = 1 / (1 + phi), l = length;
    const Eigen::Vector4d v = f * Eigen::Vector4d(2 * x * x * x - 3 * x * x - phi * x + 1 + phi,
                                                  l * (x * x * x - (2 + phi / 2) * x * x + (1 + phi / 2) * x),
                                                  -2 * x * x * x + 3 * x * x + phi * x,
                                                  l * (x * x * x - (1 - phi / 2) * x * x - phi / 2 * x));
    const Eigen::Vector4d slope =
        f / l *
        Eigen::Vector4d(6 * x * x - 6 * x - phi, l * (3 * x * x - (4 + phi) * x + 1 + phi / 2),
                        -6 * x * x + 6 * x + phi, l * (3 * x * x - (2 - phi) * x - phi / 2));
    const Eigen::Vector4d psi = f * Eigen::Vector4d(6 * (x * x - x) / l, 3 * x * x - (4 + phi) * x + 1 + phi,
                                                    -6 * (x * x - x) / l, 3 * x * x - (2 - phi) * x);
    const Eigen::Vector4d curvature =
        f / l * Eigen::Vector4d((12 * x - 6) / l, 6 * x - 4 - phi, -(12 * x - 6) / l, 6 * x - 2 + phi);
    Shapes n = Shapes::Zero(), b = Shapes::Zero();
    const auto bend = [&](int shift, int turn, double sign) {
      const int freedoms[] = {shift, 3 + turn, 6 + shift, 9 + turn};
      for (int i = 0; i < 4; ++i) {
        const double of_shift = i % 2 == 0 ? 1 : sign;  // psi = sign * turn
        n(shift, freedoms[i]) = of_shift * v[i];
        n(3 + turn, freedoms[i]) = sign * of_shift * psi[i];
        b(shift, freedoms[i]) = of_shift * (slope[i] - psi[i]);
        b(3 + turn, freedoms[i]) = sign * of_shift * curvature[i];
      }
    };
    bend(0, 1, 1);
    bend(1, 0, -1);
    for (const int k : {2, 5}) {
      n(k, k) = 1 - x;
      n(k, k + 6) = x;
      b(k, k) = -1 / l;
      b(k, k + 6) = 1 / l;
    }
    return {n, b};
  }

  void add(const Beam& beam, const Matrix12& matrix, std::vector<Triplet>& to) const {
    const int ends[] = {freedom_[beam.a], freedom_[beam.b]};
    for (int i = 0; i < 12; ++i)
      for (int j = 0; j < 12; ++j)
        if (ends[i / 6] >= 0 && ends[j / 6] >= 0)
          to.emplace_back(ends[i / 6] + i % 6, ends[j / 6] + j % 6, matrix(i, j));
  }

  BeamSection section_;
  std::vector<Vector3> nodes_;
  std::vector<char> held_;
  std::vector<Beam> beams_;
  std::vector<int> freedom_;  ///< first unknown of a node; -1 if held
  Eigen::SparseMatrix<double> k_, m_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

}  // namespace rodsweep::test
