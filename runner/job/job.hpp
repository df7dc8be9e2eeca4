// A job file, read strictly: unknown, missing, duplicate, mistyped, non-finite and out-of-range keys are refused before
// anything runs, with a message that names file, key path, value, what is allowed and the nearest known key.
//
// A sweep stands in place of a value: {"grid": [values]}, {"zip": [values]}, {"uniform": [a, b]}, {"log_uniform": [a,
// b]},
// {"integer": [a, b]}; see runner/job/sweep_space.hpp for what they expand to.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "runner/job/input_file.hpp"

namespace rodsweep {

/// Something in a job file that its author must change. what() is the whole message for the user, ready to print: one
/// line per mistake, each beginning with the file.
class JobError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// "FILE: KEY.PATH: TEXT"; without a path "FILE: TEXT".
JobError job_error(const std::filesystem::path& file, const std::string& key_path, const std::string& text);

struct Job {
  std::filesystem::path path;  ///< as given by the user; relative paths in the job are relative to its folder
  std::string text;            ///< the file as it was read, byte for byte: stored in /job/text
  std::string name;
  std::uint64_t seed = 0;
  std::int64_t samples = 1;           ///< of a training 1
  InputFiles files;                   ///< that it names
  nlohmann::ordered_json values;      ///< validated, every default filled in, sweeps still in place
  std::vector<std::string> warnings;  ///< of values that are not plausible, a line each, ready to print

  /// The list of guesses; empty in a kind of job that has none.
  nlohmann::ordered_json guesses() const;
};

/// Is a network trained? Then it is a TrainingJob (runner/job/training_job.hpp), not a Plan.
bool is_training(const Job& job);

/// Reads and validates every key and every value that a sweep can take; throws JobError. What depends on several values
/// at one parameter point (such as a duration of a whole number of steps) is checked by Plan (runner/plan/plan.hpp).
Job read_job(const std::filesystem::path& path, MissingFiles missing = MissingFiles::refused);
std::string read_job_text(const std::filesystem::path& path);  ///< refuses what is no file, or larger than a job may be
Job parse_job(std::string text, const std::filesystem::path& path, MissingFiles missing = MissingFiles::refused);
/// Of a job that another rank has read with its files.
Job parse_job(std::string text, const std::filesystem::path& path, const InputFiles& files);

}  // namespace rodsweep
