#include "runner/job/job.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "runner/keys/job_reader.hpp"
#include "runner/keys/key.hpp"
#include "runner/specs/training_job.hpp"
#include "runner/sweep/sweep_space.hpp"
#include "runner/text/strict_json.hpp"
#include "runner/text/words.hpp"

namespace rodsweep {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_bytes = 16 << 20;  // takes a second and a gigabyte to read

void check_guesses(const Job& job, const SweepSpace& space) {
  if (!job.values.contains("guesses")) return;
  const auto& guesses = job.values["guesses"];
  if (!space.can_be("solve.method", "cg")) {
    if (guesses.empty()) return;
    throw job_error(job.path, "guesses", "only solve.method \"cg\" uses initial guesses; remove this key");
  }
  if (job.values["record"].value("norms", "") == "none") return;  // no ratios
  for (const auto& guess : guesses) {
    if (guess.contains("zero")) return;
  }
  throw job_error(
      job.path, "guesses",
      "solve.method \"cg\" needs \"zero\" in this list, the denominator of every ratio, unless record.norms is "
      "\"none\"; for example [\"zero\", \"previous\", \"quadratic\"]");
}

void check_samples(const Job& job, const SweepSpace& space) {
  if (job.samples == 1 || space.every_point_is_random()) return;
  throw job_error(job.path, "samples",
                  "{} is not allowed: at some grid points nothing is random, and all samples are equal; must be 1, or "
                  "make a value random there, such as {{\"uniform\": [a, b]}}",
                  job.samples);
}

/// `look(written, key_path)` returns an input file.
template <class Look>
Job parsed(std::string text, const std::filesystem::path& path, Look look) {
  JobReader reader(path);
  Job job;
  job.values = reader.read(job_key(), parse_strict_json(text, path), "");
  reader.throw_mistakes();
  for (const auto& [file, uses] : reader.files()) {
    InputFile found = look(file, uses.front().key_path);
    found.uses = uses;
    job.files.emplace(file, std::move(found));
  }
  job.warnings = reader.warnings();
  job.path = path;
  job.text = std::move(text);
  job.name = job.values["name"];
  job.seed = job.values["seed"];
  if (is_training(job)) {
    training_job(job.values, path);
    return job;
  }
  job.samples = job.values["samples"];
  const SweepSpace space(job.values, path);
  check_guesses(job, space);
  check_samples(job, space);
  check_obstacles(job.values["scene"], path);
  for (std::string& warning : scene_warnings(job)) job.warnings.push_back(std::move(warning));
  return job;
}

/// By JSON pointer.
Json settings(const Job& job) {
  Json values = job.values;
  for (const char* free : {"name", "description", "$schema"}) values.erase(free);
  return values.flatten();
}

}  // namespace

bool is_training(const Job& job) { return job.values["kind"] == "train"; }

nlohmann::ordered_json Job::guesses() const { return values.value("guesses", nlohmann::ordered_json::array()); }

Job parse_job(std::string text, const std::filesystem::path& path, MissingFiles missing) {
  return parsed(std::move(text), path, [&](const std::string& written, const std::string& key_path) {
    return input_file(path, key_path, written, missing);
  });
}

Job parse_job(std::string text, const std::filesystem::path& path, const InputFiles& files) {
  return parsed(std::move(text), path,
                [&](const std::string& written, const std::string&) { return files.at(written); });
}

std::string read_job_text(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::is_directory(status)) throw job_error(path, "", "is a folder, not a job file");
  if (std::filesystem::is_character_file(status) || std::filesystem::is_block_file(status))
    throw job_error(path, "", "is a device, not a job file");
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  std::string text;
  std::array<char, 1 << 16> block{};
  while (in && text.size() <= most_bytes) {
    in.read(block.data(), block.size());
    text.append(block.data(), static_cast<std::size_t>(in.gcount()));
  }
  if (text.size() > most_bytes)
    throw job_error(path, "",
                    "is too large; must be at most {} MB: replace lists by `samples` of ranges, such as {{\"uniform\": "
                    "[a, b]}}, or split the job",
                    most_bytes >> 20);
  if (!in.eof()) throw job_error(path, "", "cannot be read: {}", std::strerror(errno ? errno : EIO));
  return text;
}

Job read_job(const std::filesystem::path& path, MissingFiles missing) {
  return parse_job(read_job_text(path), path, missing);
}

std::vector<MissingFile> missing_files(const Job& job) {
  std::vector<MissingFile> missing;
  for (const auto& [written, file] : job.files)
    if (file.hash.empty()) missing.push_back({file.uses.front().key_path, written, file.path});
  if (!is_training(job)) return missing;
  const auto& data = job.values["data"];
  const bool listed = data.is_array();
  for (std::size_t i = 0; i < (listed ? data.size() : 1); ++i) {
    const std::string written = listed ? data[i] : data;
    const std::filesystem::path path = job.path.parent_path() / written;
    std::error_code error;
    if (!std::filesystem::exists(path, error)) missing.push_back({listed ? element("data", i) : "data", written, path});
  }
  return missing;
}

std::string shown(const Json& value) { return value.is_null() ? "nothing" : shortened(value.dump(), 80); }

std::optional<JobDifference> first_difference(const Job& now, const Job& before) {
  const Json a = settings(now), b = settings(before);
  for (const Json* keys : {&b, &a})
    for (const auto& [pointer, ignored] : keys->items()) {
      const Json value = a.value(pointer, Json()), earlier = b.value(pointer, Json());
      if (value == earlier) continue;
      std::string key = pointer.substr(1);
      std::replace(key.begin(), key.end(), '/', '.');
      return JobDifference{key, shown(value), shown(earlier)};
    }
  return std::nullopt;
}

}  // namespace rodsweep
