// For tests of results files: a folder that goes away, plans with every kind of dataset, records with a distinct value
// in every place.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "runner/file/hdf5.hpp"
#include "runner/file/record.hpp"
#include "runner/file/results_file.hpp"
#include "tests/runner/job_examples.hpp"

namespace rodsweep {

class TemporaryFolder {
 public:
  TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// 6 tasks of 4, 5 and 7 segments; rows in every group of a sweep's file.
Json full_job();

/// The same as a data set, whose file has /systems in place of what is of guesses.
Json full_data_job();

/// Every value of every column differs from its neighbours and from the same place in other tasks.
TaskRecord synthetic_record(const Plan& plan, std::int64_t index);

Provenance test_provenance();

/// A closed file of `plan` in which the first `done` tasks are complete.
void make_file(const std::filesystem::path& path, const Plan& plan, std::int64_t done);

/// A file of a job in a folder of its own.
struct FullFile {
  explicit FullFile(std::int64_t done, const Json& job = full_job()) : plan(plan_of(job)) {
    make_file(path, plan, done);
  }

  TemporaryFolder folder;
  Plan plan;
  std::filesystem::path path = folder / "a.h5";
};

/// Replaces an attribute of an open file's object.
template <class Value>
void set_attribute(hid_t file, const char* object, const char* name, const Value& value) {
  H5Adelete_by_name(file, object, name, H5P_DEFAULT);
  hdf5::write_attribute(hdf5::Object(H5Oopen(file, object, H5P_DEFAULT)).id(), name, value);
}

std::size_t entries(const std::filesystem::path& folder);

std::string bytes_of(const std::filesystem::path& path);

/// Everything outside /timing and /runs, by path.
std::map<std::string, std::string> reproducible_bytes(const std::filesystem::path& path, const Plan& plan);

}  // namespace rodsweep
