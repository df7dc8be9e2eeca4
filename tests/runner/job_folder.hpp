// For tests of jobs that name files: a temporary folder with a job.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/runner/job_examples.hpp"

namespace rodsweep {

/// A temporary folder for job.json and the files that the job names.
class JobFolder {
 public:
  JobFolder() : path_(std::filesystem::temp_directory_path() / ("rodsweep-inputs-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(path_ / "models");
  }
  ~JobFolder() { std::filesystem::remove_all(path_); }
  void write(const char* name, const char* text) const { std::ofstream(path_ / name) << text; }
  Job job(const Json& job) const { return parse_job(job.dump(), path_ / "job.json"); }
  std::string refusal(const Json& of) const {
    return message_of<JobError>([&] { const Plan plan(job(of)); });
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace rodsweep
