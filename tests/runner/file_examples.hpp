// For tests of results files: plans with every kind of dataset, and records whose values identify their place.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "runner/file/hdf5.hpp"
#include "runner/file/record.hpp"
#include "runner/file/results_file.hpp"
#include "tests/runner/job_folder.hpp"

namespace rodsweep {

/// 6 tasks of 4, 5 and 7 segments, with rows in every group of a sweep's file.
Json full_job();

/// The same job as a data set: the file has /systems instead of the groups of guesses.
Json full_data_job();

/// Every value differs from its neighbours and from the same place in other columns and tasks.
TaskRecord synthetic_record(const Plan& plan, std::int64_t index);

Provenance test_provenance();

/// A closed file of `plan` in which the first `done` tasks are complete.
void make_file(const std::filesystem::path& path, const Plan& plan, std::int64_t done);

/// A results file in its own temporary folder.
struct FullFile {
  explicit FullFile(std::int64_t done, const Json& job = full_job()) : plan(plan_of(job)) {
    make_file(path, plan, done);
  }

  TemporaryFolder folder;
  Plan plan;
  std::filesystem::path path = folder / "a.h5";
};

/// Replaces an attribute of an object in an open file.
template <class Value>
void set_attribute(hid_t file, const char* object, const char* name, const Value& value) {
  H5Adelete_by_name(file, object, name, H5P_DEFAULT);
  hdf5::write_attribute(hdf5::Object(H5Oopen(file, object, H5P_DEFAULT)).id(), name, value);
}

/// Makes a compressed copy with h5repack, as a user does.
void compress(const std::filesystem::path& from, const std::filesystem::path& to);

std::size_t entries(const std::filesystem::path& folder);

std::string bytes_of(const std::filesystem::path& path);

/// Everything outside /timing and /runs, by path.
std::map<std::string, std::string> reproducible_bytes(const std::filesystem::path& path, const Plan& plan);

}  // namespace rodsweep
