#include "runner/file/systems_file.hpp"

#include <fmt/format.h>

#include "runner/file/hdf5.hpp"
#include "runner/file/unfinished_file.hpp"

namespace rodsweep {
namespace {

void append(std::vector<double>& to, const VectorX& values) { to.insert(to.end(), values.begin(), values.end()); }

}  // namespace

SystemsFile::Systems SystemsFile::of(const Rod& rod, const BlockMatrix& a) {
  Systems made;
  for (int row = 0; row < a.block_rows(); ++row) made.row_begin.push_back(a.row_begin(row));
  made.row_begin.push_back(a.block_count());
  for (int block = 0; block < a.block_count(); ++block) made.columns.push_back(a.column(block));
  for (const Joint& joint : rod.joints) {
    made.segments.insert(made.segments.end(), {joint.a, joint.b});
    append(made.compliance, joint.compliance);
  }
  for (const Segment& segment : rod.segments) {
    made.length.push_back(segment.length_m);
    made.radius.push_back(segment.radius_m);
    made.mass.push_back(segment.mass);
  }
  return made;
}

void SystemsFile::add(const Rod& rod, const LinearSystem& system, const SolvePosition& at, const VectorX& solution) {
  const BlockMatrix& a = system.matrix();
  if (rods_.size() <= static_cast<std::size_t>(at.rod)) rods_.resize(static_cast<std::size_t>(at.rod) + 1);
  Systems& to = rods_[static_cast<std::size_t>(at.rod)];
  if (to.row_begin.empty()) to = of(rod, a);
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
    const Systems& rod = rods_[r];
    if (rod.step.empty()) continue;
    const auto put = [&](const char* name, const auto& values, const std::vector<hsize_t>& extent,
                         const char* meaning) {
      using Number = typename std::decay_t<decltype(values)>::value_type;
      const std::string at = fmt::format("/rods/{}/{}", r, name);
      const hdf5::Dataset dataset = hdf5::create_dataset(file.id(), at, hdf5::type_of<Number>(), extent);
      hdf5::write_attribute(dataset.id(), "meaning", meaning);
      hdf5::write_all(file.id(), at, values);
    };
    const hsize_t joints = rod.row_begin.size() - 1, blocks = rod.columns.size(), segments = rod.length.size();
    const hsize_t systems = rod.step.size();
    put("row_begin", rod.row_begin, {joints + 1}, "first block of each block row");
    put("columns", rod.columns, {blocks}, "block column of each block");
    put("segments", rod.segments, {joints, 2}, "segments that each joint connects");
    put("compliance_per_j", rod.compliance, {joints, 6}, "alpha of each row of A");
    put("length_m", rod.length, {segments}, "of each segment");
    put("radius_m", rod.radius, {segments}, "of each segment");
    put("mass_kg", rod.mass, {segments}, "of each segment");
    put("step", rod.step, {systems}, "time step, from 0");
    put("newton", rod.newton, {systems}, "Newton iteration, from 0");
    put("dt_s", rod.dt, {systems}, "time step of A: with bdf2 two thirds of that of the job");
    put("blocks", rod.blocks, {systems, blocks, 6, 6}, "blocks of A, row by row");
    put("b", rod.b, {systems, joints, 6}, "right-hand side");
    put("x", rod.x, {systems, joints, 6}, "solution: increments of the multipliers");
    put("lambda", rod.lambda, {systems, joints, 6}, "multipliers before the solve");
    put("position_m", rod.position, {systems, segments, 3}, "centres of segments before the solve");
    put("orientation", rod.orientation, {systems, segments, 4}, "their quaternions (w, x, y, z)");
  }
  hdf5::close(file, "H5Fclose", path.native());
  unfinished.publish();
}

}  // namespace rodsweep
