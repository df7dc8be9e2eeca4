// A file of linear systems A x = b, in groups /rods/0, /rods/1, ... A is symmetric, in blocks of 6x6 in compressed block
// rows; its pattern stands once per rod. Joint k of a rod has block row k, six unknowns: multipliers of stretch and
// shear (3), of bending and twisting (3), in the joint's frame [kg m^2]. Numbers are doubles.
//
//   /rods/R/row_begin [joints + 1], columns [blocks]                    the pattern
//   /rods/R/segments [joints, 2]                                        that a joint connects
//   /rods/R/compliance_per_j [joints, 6]                                alpha: A has alpha / dt^2 on its diagonal
//   /rods/R/length_m, radius_m, mass_kg [segments]
//   /rods/R/step, newton [systems], dt_s [systems]
//   /rods/R/blocks [systems, blocks, 6, 6], b, x, lambda [systems, joints, 6]
//   /rods/R/position_m [systems, segments, 3], orientation [systems, segments, 4] (w x y z)
//
// The systems are kept in memory until write(). Throws FileError and Hdf5Error.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "solver/linear/linear_system.hpp"
#include "solver/rod/rod_arrays.hpp"
#include "solver/step/projection.hpp"

namespace rodsweep {

class SystemsFile {
 public:
  void add(const Rod& rod, const LinearSystem& system, const SolvePosition& at, const VectorX& solution);
  std::size_t count() const;

  /// Creates the file. `attributes`: names and texts of its root.
  void write(const std::filesystem::path& path,
             const std::vector<std::pair<const char*, std::string>>& attributes) const;

 private:
  struct Systems {
    RodArrays rod;
    std::vector<std::int32_t> row_begin, columns, step, newton;
    std::vector<double> dt, blocks, b, x, lambda, position, orientation;
  };

  std::vector<Systems> rods_;
};

}  // namespace rodsweep
