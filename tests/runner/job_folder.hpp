// Temporary folders for tests, and those of jobs that name files.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <string>

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

/// A folder for job.json and the files that the job names.
class JobFolder : public TemporaryFolder {
 public:
  JobFolder() { std::filesystem::create_directory(*this / "models"); }

  void write(const char* name, const char* text) const { std::ofstream(*this / name) << text; }
  Job job(const Json& job) const { return parse_job(job.dump(), *this / "job.json"); }
  std::string refusal(const Json& of) const {
    return message_of<JobError>([&] { const Plan plan(job(of)); });
  }
};

}  // namespace rodsweep
