// The nodes of a lattice, computed independently of the lattice builder.
#pragma once

#include <array>
#include <map>
#include <set>
#include <vector>

#include "solver/scene/scenes.hpp"

namespace rodsweep::test {

inline constexpr Lattice::Cell cells[] = {Lattice::Cell::cubic, Lattice::Cell::body_centred, Lattice::Cell::octet};

/// A point in units of half a cell edge.
using Place = std::array<int, 3>;

inline Place moved(const Place& p, const Place& by, int times = 1) {
  return {p[0] + times * by[0], p[1] + times * by[1], p[2] + times * by[2]};
}

inline Vector3 point(const Place& at, const Lattice& p) { return p.mesh_m / 2 * Vector3(at[0], at[1], at[2]); }

/// The vectors from a node to its nearest neighbours in an infinite lattice.
inline std::set<Place> ways_of(Lattice::Cell cell) {
  const int square = cell == Lattice::Cell::cubic ? 4 : cell == Lattice::Cell::body_centred ? 3 : 2;  // of the distance
  std::set<Place> out;
  for (int x = -2; x <= 2; ++x)
    for (int y = -2; y <= 2; ++y)
      for (int z = -2; z <= 2; ++z)
        if (x * x + y * y + z * z == square) out.insert({x, y, z});
  return out;
}

/// The corner with the largest coordinates.
inline Place last_corner(const Lattice& p) {
  return {2 * p.nodes_x - 2, 2 * (p.nodes_y ? p.nodes_y : p.nodes_x) - 2, 2 * (p.nodes_z ? p.nodes_z : p.nodes_x) - 2};
}

/// All nodes (corners of cells, their centres or face centres), each with the vectors to its nearest neighbours.
inline std::map<Place, std::set<Place>> nodes_of(const Lattice& p) {
  const Place last = last_corner(p);
  std::map<Place, std::set<Place>> nodes;
  for (int x = 0; x <= last[0]; ++x)
    for (int y = 0; y <= last[1]; ++y)
      for (int z = 0; z <= last[2]; ++z) {
        const int odd = x % 2 + y % 2 + z % 2;
        if (odd == 0 || (p.cell == Lattice::Cell::body_centred && odd == 3) ||
            (p.cell == Lattice::Cell::octet && odd == 2))
          nodes[{x, y, z}];
      }
  for (auto& [at, ways] : nodes)
    for (const Place& way : ways_of(p.cell))
      if (nodes.count(moved(at, way))) ways.insert(way);
  return nodes;
}

inline bool is_crossing(const Joint& joint) { return joint.arm_a.isZero(); }

}  // namespace rodsweep::test
