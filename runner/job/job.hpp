// A job file, read strictly. Unknown, missing, duplicate, mistyped, non-finite and out-of-range keys are errors before
// the run. The message contains file, key path, value, the allowed values and the nearest known key.
//
// A sweep replaces a value: {"grid": [values]}, {"zip": [values]}, {"uniform": [a, b]}, {"log_uniform": [a, b]},
// {"integer": [a, b]}. runner/sweep/sweep_space.hpp explains their expansion.
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runner/inputs/input_file.hpp"
#include "runner/text/job_error.hpp"

namespace rodsweep {

struct Job : JobFiles {
  std::string text;  ///< the unchanged file content, stored in /job/text
  std::string name;
  std::uint64_t seed = 0;
  std::int64_t samples = 1;           ///< 1 in a training
  nlohmann::ordered_json values;      ///< validated, with all defaults; sweeps not expanded
  std::vector<std::string> warnings;  ///< one line for each implausible value, ready to print

  /// The list of guesses; empty if the kind of job has none.
  nlohmann::ordered_json guesses() const;
};

/// Whether the job trains a network. Then it becomes a TrainingJob (runner/specs/training_job.hpp), not a Plan.
bool is_training(const Job& job);

/// Reads and validates all keys and all values of sweeps; throws JobError. Plan (runner/plan/plan.hpp) checks conditions
/// on several values at one parameter point, such as a duration of a whole number of steps.
Job read_job(const std::filesystem::path& path, MissingFiles missing = MissingFiles::refused);
std::string read_job_text(const std::filesystem::path& path);  ///< throws JobError if not a file, or too large
Job parse_job(std::string text, const std::filesystem::path& path, MissingFiles missing = MissingFiles::refused);
/// For a job whose files another rank has read.
Job parse_job(std::string text, const std::filesystem::path& path, const InputFiles& files);

/// The missing files of a job read with MissingFiles::accepted, and missing data sets of a training.
std::vector<MissingFile> missing_files(const Job& job);

/// Where the values of two jobs differ. Values include defaults; the layout of the JSON text, the order of keys and the
/// form of a number (1000, 1e3) make no difference.
struct JobDifference {
  std::string key;          ///< "scene.length_m"
  std::string now, before;  ///< shown() values
};

/// A value for a message: its JSON, shortened; "nothing" for null, which stands for a missing key.
std::string shown(const nlohmann::ordered_json& value);

/// The first difference; none if the jobs are the same. Names, descriptions and $schema may differ.
std::optional<JobDifference> first_difference(const Job& now, const Job& before);

// Checks of several keys of a validated job's scenes, in scene_checks.cpp: what is refused, and what is warned of.

/// Throws JobError if a scene has obstacles without contact. `scenes`: the scene of a validated job, or a sweep of them.
/// If contact is swept, obstacles are allowed: "none" is then the case to compare with.
void check_obstacles(const nlohmann::ordered_json& scenes, const std::filesystem::path& file);

/// A line for each value of a scene that is probably not meant, or that the job's steps get wrong.
std::vector<std::string> scene_warnings(const Job& job);

}  // namespace rodsweep
