// Scenes of contact that several benchmarks simulate.
#pragma once

#include "solver/scene/scenes.hpp"

namespace rodsweep {

template <class Spec>
Spec touching(double radius_m, double youngs_modulus_pa, double torsion_modulus_pa) {
  Spec p;
  p.radius_m = radius_m;
  p.youngs_modulus_pa = youngs_modulus_pa;
  p.torsion_modulus_pa = torsion_modulus_pa;
  p.contact = ContactSettings{};
  return p;
}

/// 3^3 nodes, tilted, above a floor.
inline Lattice dropped_octet_lattice() {
  auto lattice = touching<Lattice>(0.015, 1e7, 4e6);
  lattice.cell = Lattice::Cell::octet;
  lattice.nodes_x = 3;
  lattice.mesh_m = 0.3;
  lattice.held = Held::free;
  lattice.initial_angle_deg = 30;
  lattice.damping_per_s = 2;
  lattice.obstacles = {HalfSpace{{0, -0.4, 0}, {0, 1, 0}, {0, 0, 0}}};
  return lattice;
}

}  // namespace rodsweep
