#include "runner/file/stored_plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <system_error>

#include "runner/file/file_reading.hpp"
#include "runner/file/layout.hpp"
#include "runner/file/provenance.hpp"
#include "runner/file/runs.hpp"
#include "runner/job/job.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

FileError not_accepted(const FileSummary& file, const JobError& error) {
  const std::string revision = file.runs.empty() ? "unknown" : file.runs.front().provenance.revision;
  return FileError(
      "{} holds a job that this rodsweep does not accept; use the revision that wrote it ({}), or restore the input "
      "files of the job:\n"
      "{}",
      file.path.native(), revision, error.what());
}

/// Math libraries differ in the last digits, also between machines.
constexpr double rounding = 1e-9;

constexpr const char* other_revision = "Use that revision, or run into another file with -o FILE";

void check_job(const hdf5::File& file, const fs::path& path, const Plan& plan) {
  const std::string text = stored_job_text(file, path);
  const Job& job = plan.job();
  if (text == job.text) return;
  const auto refuse = [&](const std::string& difference, const char* advice) {
    throw FileError(
        "{} holds the results of another job than {}: {}. {}, or run this job into another file with -o FILE",
        path.native(), job.path.native(), difference, advice);
  };
  try {
    const Job before = parse_job(text, job.path, MissingFiles::accepted);
    const auto found = first_difference(job, before);
    if (!found) return;
    refuse(fmt::format("{} was {} and is {}", found->key, found->before, found->now),
           found->key == "task_time_limit_s" ? "Use --task-time-limit to change only the time limit"
           : found->key == "time.steps"      ? "A task cannot go on beyond its last step: resume with the original job"
           : extends(job, before)            ? "Add --extend OLD -o NEW to use its results for this larger job"
                                             : "Resume with the original job (rodsweep info FILE --job)");
  } catch (const JobError& error) {
    refuse(fmt::format("this rodsweep does not accept its job ({})", error.what()),
           "Resume with the revision that wrote it");
  }
}

FileError other_program(const hdf5::File& file, const fs::path& path, const std::string& difference,
                        const char* advice) {
  return FileError("{} was made by a rodsweep that expands the job differently (revision {}): {}. {}", path.native(),
                   hdf5::RowDataset(file.id(), "/runs/revision").text(0), difference, advice);
}

/// The error for a different expansion of the job in the file. If the revision is the same, the file is damaged.
FileError other_value(const hdf5::File& file, const fs::path& path, const std::string& difference, const char* advice) {
  const std::string own = source_revision();
  const bool is_known = own != "unknown" && own.find("-dirty") == std::string::npos;
  if (is_known && hdf5::RowDataset(file.id(), "/runs/revision").text(0) == own)
    return damaged_error(path, difference + ", although the revision is the same");
  return other_program(file, path, difference, advice);
}

void check_layout(const hdf5::File& file, const fs::path& path, const std::vector<Field>& fields, const char* advice) {
  for (const Field& field : fields) {
    if (field.path == "/job/text") continue;  // the same job may be written in another way
    if (!hdf5::exists(file.id(), field.path)) {
      if (field.path == "/runs/left_s") continue;  // write_run() skips it
      throw other_value(file, path, "it has no " + field.path, advice);
    }
    const hdf5::Dataset dataset = hdf5::open_dataset(file.id(), field.path);
    const std::vector<hsize_t> extent = hdf5::extent(dataset, field.path);
    const hdf5::Datatype type(hdf5::check(H5Dget_type(dataset.id()), "H5Dget_type", field.path));
    if (!std::equal(extent.begin(), extent.end(), field.extent.begin(), field.extent.end(),
                    [](hsize_t a, std::int64_t b) { return a == static_cast<hsize_t>(b); }) ||
        H5Tequal(type.id(), type_of(field).id()) <= 0) {
      throw other_value(file, path, field.path + " has another shape or type", advice);
    }
  }
}

template <class Value>
bool same(const Value& a, const Value& b) {
  return a == b;
}
bool same(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) || a == b || std::abs(a - b) <= rounding * std::max(std::abs(a), std::abs(b));
}

/// Checked first, because all other checks may depend on the job's input files.
void check_hash(const hdf5::File& file, const fs::path& path, const Plan& plan,
                const std::vector<ParameterColumn>& parameters, const char* advice) {
  if (hdf5::read_text_attribute(file.id(), "/job", "plan_hash") == plan_hash(plan, parameters)) return;
  std::string difference = "its tasks differ (/job, plan_hash)";
  if (const InputFiles& inputs = plan.job().files; !inputs.empty()) {
    std::vector<std::string> names;
    for (const auto& [written, input] : inputs) names.push_back(written);
    difference += fmt::format(", or input files of the job have changed: {}", fmt::join(names, ", "));
  }
  throw other_program(file, path, difference, advice);
}

void check_parameters(const hdf5::File& file, const fs::path& path, const Plan& plan,
                      const std::vector<ParameterColumn>& parameters, const char* advice) {
  if (!plan.guess_labels().empty() && hdf5::read_all<std::string>(file.id(), "/axes/guess") != plan.guess_labels())
    throw other_program(file, path, "the labels of its guesses differ (/axes/guess)", advice);
  if (hdf5::read_all<double>(file.id(), "/axes/tolerance") != tolerance_ladder())
    throw other_value(file, path, "its tolerances differ (/axes/tolerance)", advice);
  const auto compare = [&](const std::string& name, int width, const auto& here, const auto& there) {
    const auto [a, b] = std::mismatch(here.begin(), here.end(), there.begin(), there.end(),
                                      [](const auto& x, const auto& y) { return same(x, y); });
    if (a == here.end() && b == there.end()) return;
    if (a == here.end() || b == there.end())
      throw other_value(file, path, fmt::format("{} has another length", name), advice);
    throw other_value(
        file, path,
        fmt::format("{} of task {} is {} here and {} in the file", name, (a - here.begin()) / width, *a, *b), advice);
  };
  for (const ParameterColumn& parameter : parameters)
    std::visit(
        [&](const auto& values) {
          using Value = typename std::decay_t<decltype(values)>::value_type;
          compare(parameter.path, parameter.width, values.all(),
                  hdf5::read_all<Value>(file.id(), "/tasks/parameters/" + parameter.path));
        },
        parameter.values);
  visit_planned_values(plan, [&](const char* column, const char*, const auto& values) {
    using Value = typename std::decay_t<decltype(values)>::value_type;
    if (!hdf5::exists(file.id(), column)) return;  // the file is older than this kind of rows
    compare(column, 1, values, hdf5::read_all<Value>(file.id(), column));
  });
}

/// Returns the plan's layout.
std::vector<Field> check_plan(const hdf5::File& file, const fs::path& path, const Plan& plan, const char* advice) {
  const std::vector<ParameterColumn> parameters = plan.parameters();
  check_hash(file, path, plan, parameters, advice);
  std::vector<Field> fields = layout(plan, parameters);
  check_layout(file, path, fields, advice);
  check_parameters(file, path, plan, parameters, advice);
  return fields;
}

/// Ranks cannot write chunks independently.
void refuse_chunks(const hdf5::File& file, const fs::path& path, const std::vector<Field>& fields) {
  for (const Field& field : fields)
    if (hdf5::exists(file.id(), field.path) && !hdf5::is_contiguous(file.id(), field.path))
      throw FileError(
          "{} is a compressed copy ({} is stored in chunks), which cannot be resumed: resume the original, decompress "
          "the copy with h5repack -f NONE -l CONTI, or run into another file with -o FILE",
          path.native(), field.path);
}

void refuse_single_task(const hdf5::File& file, const fs::path& path) {
  if (hdf5::has_attribute(file.id(), "/job", "rerun_of_task")) {
    throw FileError(
        "{} holds only one task of a sweep, from `rodsweep rerun`: resume the file of the sweep, or run into another "
        "file with -o FILE",
        path.native());
  }
}

}  // namespace

fs::path stored_job_path(const FileSummary& file) {
  for (auto run = file.runs.rbegin(); run != file.runs.rend(); ++run)
    if (!run->provenance.job.empty()) return run->provenance.job;
  return file.path;
}

Job stored_job(const FileSummary& file, const fs::path& other, MissingFiles missing) {
  try {
    return parse_job(file.job_text, stored_job_path(file), missing);
  } catch (const JobError& error) {
    if (!other.empty()) {
      try {
        return parse_job(file.job_text, other);
      } catch (const JobError&) {  // report the first error
      }
    }
    throw not_accepted(file, error);
  }
}

Plan planned(const FileSummary& file, Job job) {
  try {
    return Plan(std::move(job));
  } catch (const JobError& error) {
    throw not_accepted(file, error);
  }
}

Plan stored_plan(const FileSummary& file) { return planned(file, stored_job(file)); }

void check_same_tasks(const fs::path& path, const Plan& plan) {
  const hdf5::File file = open_results(path);
  reading(path, [&] {
    const std::vector<ParameterColumn> parameters = plan.parameters();
    check_hash(file, path, plan, parameters, other_revision);
    check_parameters(file, path, plan, parameters, other_revision);
  });
}

void check_same_plan(const fs::path& path, const Plan& plan, const char* advice) {
  const hdf5::File file = open_results(path);
  reading(path, [&] { check_plan(file, path, plan, advice); });
}

ResumePoint check_resumable(const fs::path& path, const Plan& plan) {
  const hdf5::File file = open_results(path);
  if (access(path.c_str(), W_OK) != 0) {
    throw FileError("{} cannot be written: {}", path.native(), std::system_category().message(errno));
  }
  return reading(path, [&] {
    refuse_single_task(file, path);
    check_job(file, path, plan);
    refuse_chunks(file, path, check_plan(file, path, plan, other_revision));
    return ResumePoint{hdf5::read_all<std::uint8_t>(file.id(), "/tasks/state"),
                       hdf5::read_all<std::uint8_t>(file.id(), "/timing/tasks/tries"),
                       static_cast<int>(read_runs(file).size())};
  });
}

}  // namespace rodsweep
