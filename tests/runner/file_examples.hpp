// For tests of results files: a folder that goes away, plans with every kind of dataset, records with a distinct value
// in every place, and what a call refuses with.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <string>

#include "runner/file/columns.hpp"
#include "runner/file/layout.hpp"
#include "runner/file/record.hpp"
#include "runner/file/results_file.hpp"
#include "tests/runner/job_examples.hpp"

namespace rodsweep {

class TemporaryFolder {
 public:
  TemporaryFolder()
      : path_(std::filesystem::temp_directory_path() /
              ("rodsweep-test-" + std::to_string(getpid()) + "-" + std::to_string(std::random_device()()))) {
    std::filesystem::create_directory(path_);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// 6 tasks of 4, 5 and 7 segments; rows in every group of a sweep's file.
inline Json full_job() {
  Json job = with("/scene/segments", R"({"grid": [4, 5, 7]})");
  job["samples"] = 2;
  job["seed"] = 3;
  job["scene"]["length_m"] = uniform(1, 2);
  job["time"] = {{"step_s", 0.02}, {"steps", 3}, {"newton_iterations", 2}};
  job["record"] = {{"trajectory_every", 2}};
  return job;
}

/// The same as a data set, whose file has /systems in place of what is of guesses.
inline Json full_data_job() {
  Json job = without("/guesses", full_job());
  job["kind"] = "dataset";
  job["record"]["systems"] = "all";
  return job;
}

/// Every value of every column differs from its neighbours and from the same place in other tasks.
inline TaskRecord synthetic_record(const Plan& plan, std::int64_t index) {
  const Task& task = plan.task(index);
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

inline Provenance test_provenance() {
  Provenance provenance = provenance_of_this_process("rodsweep run job.json");
  provenance.ranks = 2;
  return provenance;
}

/// A closed file of `plan` in which the first `done` tasks are complete.
inline void make_file(const std::filesystem::path& path, const Plan& plan, std::int64_t done) {
  ResultsFile file = ResultsFile::create(path, plan, test_provenance(), MPI_COMM_SELF);
  for (std::int64_t i = 0; i < done; ++i) file.write(plan.task(i), synthetic_record(plan, i));
  file.close();
}

inline std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Everything outside /timing and /runs, by path.
inline std::map<std::string, std::string> reproducible_bytes(const std::filesystem::path& path, const Plan& plan) {
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

/// The text of the `Error` that `call` throws.
template <class Error, class Call>
std::string message_of(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace rodsweep
