#include "runner/file/systems_file.hpp"

#include <fmt/format.h>

#include "runner/file/hdf5.hpp"
#include "runner/file/unfinished_file.hpp"

namespace rodsweep {
namespace {

void append(std::vector<double>& to, const VectorX& values) { to.insert(to.end(), values.begin(), values.end()); }

}  // namespace

void SystemsFile::add(const Rod& rod, const LinearSystem& system, const SolvePosition& at, const VectorX& solution) {
  const BlockMatrix& a = system.matrix();
  if (rods_.size() <= static_cast<std::size_t>(at.rod)) rods_.resize(static_cast<std::size_t>(at.rod) + 1);
  Systems& to = rods_[static_cast<std::size_t>(at.rod)];
  if (to.row_begin.empty()) {
    to.rod = RodArrays(rod);
    to.row_begin.assign(a.row_starts(), a.row_starts() + a.block_rows() + 1);
    to.columns.assign(a.columns(), a.columns() + a.block_count());
  }
  to.step.push_back(at.step);
  to.newton.push_back(at.newton);
  to.dt.push_back(system.dt());
  for (const Block6& block : a.blocks)
    for (int row = 0; row < 6; ++row)
      for (int column = 0; column < 6; ++column) to.blocks.push_back(block.column[column][row]);
  append(to.b, system.rhs());
  append(to.x, solution);
  append(to.lambda, rod.lambda);
  for (const Vector3& position : rod.position) append(to.position, position);
  for (const Quaternion& q : rod.orientation) to.orientation.insert(to.orientation.end(), {q.w(), q.x(), q.y(), q.z()});
}

std::size_t SystemsFile::count() const {
  std::size_t sum = 0;
  for (const Systems& rod : rods_) sum += rod.step.size();
  return sum;
}

void SystemsFile::write(const std::filesystem::path& path,
                        const std::vector<std::pair<const char*, std::string>>& attributes) const {
  const UnfinishedFile unfinished(path);
  unfinished.check_creatable();
  hdf5::File file = hdf5::create_file(unfinished.path());
  for (const auto& [name, text] : attributes) hdf5::write_attribute(file.id(), name, text);
  for (std::size_t r = 0; r < rods_.size(); ++r) {
    const Systems& of = rods_[r];
    if (of.step.empty()) continue;
    const auto put = [&](const char* name, const auto& values, const std::vector<hsize_t>& extent,
                         const char* meaning) {
      using Number = typename std::decay_t<decltype(values)>::value_type;
      const std::string at = fmt::format("/rods/{}/{}", r, name);
      const hdf5::Dataset dataset = hdf5::create_dataset(file.id(), at, hdf5::type_of<Number>(), extent);
      hdf5::write_attribute(dataset.id(), "meaning", meaning);
      hdf5::write_all(file.id(), at, values);
    };
    const hsize_t joints = of.row_begin.size() - 1, blocks = of.columns.size(), segments = of.rod.length_m.size();
    const hsize_t systems = of.step.size();
    put("row_begin", of.row_begin, {joints + 1}, "first block of each block row");
    put("columns", of.columns, {blocks}, "block column of each block");
    put("segments", of.rod.joint_segments, {joints, 2}, "segments that each joint connects");
    put("compliance_per_j", of.rod.compliance, {joints, 6}, "alpha of each row of A");
    put("length_m", of.rod.length_m, {segments}, "of each segment");
    put("radius_m", of.rod.radius_m, {segments}, "of each segment");
    put("mass_kg", of.rod.mass_kg, {segments}, "of each segment");
    put("step", of.step, {systems}, "time step, from 0");
    put("newton", of.newton, {systems}, "Newton iteration, from 0");
    put("dt_s", of.dt, {systems}, "time step of A: with bdf2 two thirds of that of the job");
    put("blocks", of.blocks, {systems, blocks, 6, 6}, "blocks of A, row by row");
    put("b", of.b, {systems, joints, 6}, "right-hand side");
    put("x", of.x, {systems, joints, 6}, "solution: increments of the multipliers");
    put("lambda", of.lambda, {systems, joints, 6}, "multipliers before the solve");
    put("position_m", of.position, {systems, segments, 3}, "centres of segments before the solve");
    put("orientation", of.orientation, {systems, segments, 4}, "their quaternions (w, x, y, z)");
  }
  hdf5::close(file, "H5Fclose", path.native());
  unfinished.publish();
}

}  // namespace rodsweep
