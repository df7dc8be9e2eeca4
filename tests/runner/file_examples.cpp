#include "tests/runner/file_examples.hpp"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "runner/file/columns.hpp"
#include "runner/file/layout.hpp"

namespace rodsweep {

Json full_job() {
  Json job = with("/scene/segments", R"({"grid": [4, 5, 7]})");
  job["samples"] = 2;
  job["seed"] = 3;
  job["scene"]["length_m"] = uniform(1, 2);
  job["time"] = {{"step_s", 0.02}, {"steps", 3}, {"newton_iterations", 2}};
  job["record"] = {{"trajectory_every", 2}};
  return job;
}

Json full_data_job() {
  Json job = without("/guesses", full_job());
  job["kind"] = "dataset";
  job["record"]["systems"] = "all";
  return job;
}

TaskRecord synthetic_record(const Plan& plan, std::int64_t index) {
  const Task task = plan.task(index);
  TaskRecord record;
  record.prepare(task, axis_sizes(plan));
  record.outcome = TaskOutcome::ok;
  std::int64_t column_number = 0;
  for (const Column& column : columns()) {
    ++column_number;
    std::visit(
        [&](auto* values) {
          using T = typename std::decay_t<decltype(*values)>::value_type;
          for (std::size_t i = 0; i < values->size(); ++i)
            (*values)[i] = static_cast<T>((7 * index + 3 * column_number + static_cast<std::int64_t>(i)) % 120);
        },
        column.values(record));
  }
  return record;
}

Provenance test_provenance() {
  Provenance provenance = provenance_of_this_process("rodsweep run job.json");
  provenance.ranks = 2;
  return provenance;
}

void make_file(const std::filesystem::path& path, const Plan& plan, std::int64_t done) {
  ResultsFile file = ResultsFile::create(path, plan, test_provenance(), MPI_COMM_SELF);
  for (std::int64_t i = 0; i < done; ++i) file.write(plan.task(i), synthetic_record(plan, i));
  file.close();
}

void compress(const std::filesystem::path& from, const std::filesystem::path& to) {
  const std::string command = "h5repack -f SHUF -f GZIP=4 '" + from.native() + "' '" + to.native() + "'";
  if (std::system(command.c_str()) != 0) throw std::runtime_error("failed: " + command);
}

std::size_t entries(const std::filesystem::path& folder) {
  using Entries = std::filesystem::directory_iterator;
  return static_cast<std::size_t>(std::distance(Entries(folder), Entries()));
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::map<std::string, std::string> reproducible_bytes(const std::filesystem::path& path, const Plan& plan) {
  std::map<std::string, std::string> all;
  const std::string bytes = bytes_of(path);
  const hdf5::File file = hdf5::open_file(path, H5F_ACC_RDONLY);
  for (const Field& field : layout(plan, plan.parameters())) {
    if (field.path.rfind("/timing/", 0) == 0 || field.path.rfind("/runs/", 0) == 0) continue;
    const hdf5::Dataset dataset = hdf5::open_dataset(file.id(), field.path);
    all[field.path] = bytes.substr(H5Dget_offset(dataset.id()), static_cast<std::size_t>(data_bytes(field)));
  }
  return all;
}

}  // namespace rodsweep
