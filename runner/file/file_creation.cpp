#include "runner/file/results_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <cerrno>
#include <system_error>

#include "runner/file/durable.hpp"
#include "runner/file/file_reading.hpp"
#include "runner/file/hdf5.hpp"
#include "runner/file/layout.hpp"
#include "runner/file/runs.hpp"
#include "runner/file/unfinished_file.hpp"
#include "runner/plan/task_outcome.hpp"
#include "runner/terminal/formats.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

// Measured with HDF5 1.10: object headers with two attributes, and symbol tables of groups.
constexpr std::int64_t metadata_bytes_per_dataset = 480;
constexpr std::int64_t metadata_bytes_of_file = 6000;

std::string system_text(int code) { return std::system_category().message(code); }

FileError space_error(const fs::path& path, std::int64_t bytes, const std::string& found) {
  return FileError(
      "{} needs {}, but {}: free some space, name a file on another disk with -o FILE, or record less (record.solves: "
      "\"summary\", record.systems: \"first\", a larger record.trajectory_every)",
      path.native(), bytes_text(bytes), found);
}

std::int64_t file_bytes(const std::vector<Field>& fields) {
  std::int64_t bytes = metadata_bytes_of_file;
  for (const Field& field : fields) bytes += data_bytes(field) + metadata_bytes_per_dataset;
  return bytes;
}

void create_datasets(hid_t file, const std::vector<Field>& fields) {
  for (const Field& field : fields) {
    const std::vector<hsize_t> extent(field.extent.begin(), field.extent.end());
    const hdf5::Dataset dataset = hdf5::create_dataset(file, field.path, type_of(field).id(), extent);
    hdf5::write_attribute(dataset.id(), "unit", field.unit);
    hdf5::write_attribute(dataset.id(), "meaning", field.meaning);
  }
}

void write_parameters(hid_t file, const std::vector<ParameterColumn>& parameters) {
  for (const ParameterColumn& parameter : parameters) {
    const std::string path = "/tasks/parameters/" + parameter.path;
    std::visit([&](const auto& values) { hdf5::write_all(file, path, values.all()); }, parameter.values);
    hdf5::write_attribute(hdf5::open_dataset(file, path).id(), "swept", parameter.swept ? 1 : 0);
  }
}

/// Writes all data known from the plan.
void write_constants(hid_t file, const Plan& plan, const std::vector<ParameterColumn>& parameters) {
  hdf5::write_attribute(file, "program", "rodsweep");
  hdf5::write_attribute(file, "schema_version", schema_version);
  hdf5::write_attribute(file, "kind", plan.job().values["kind"].get<std::string>());
  hdf5::write_attribute(file, "title", "rodsweep results: " + plan.job().name);
  hdf5::write_all(file, "/job/text", {plan.job().text});
  const hdf5::Object job(hdf5::check(H5Oopen(file, "/job", H5P_DEFAULT), "H5Oopen", "/job"));
  hdf5::write_attribute(job.id(), "name", plan.job().name);
  hdf5::write_attribute(job.id(), "plan_hash", plan_hash(plan, parameters));
  hdf5::write_attribute(job.id(), "text_checksum", job_checksum(plan.job().text));
  if (plan.task_alone())
    hdf5::write_attribute(job.id(), "rerun_of_task", static_cast<std::int32_t>(*plan.task_alone()));

  if (!plan.guess_labels().empty()) hdf5::write_all(file, "/axes/guess", plan.guess_labels());
  hdf5::write_all(file, "/axes/tolerance", tolerance_ladder());
  write_parameters(file, parameters);
  visit_planned_values(plan,
                       [&](const char* path, const char*, const auto& values) { hdf5::write_all(file, path, values); });
  const auto tasks = static_cast<std::size_t>(plan.size());
  hdf5::write_all(file, "/tasks/state", std::vector<std::uint8_t>(tasks, 0));
  hdf5::write_all(file, "/tasks/outcome", std::vector<std::string>(tasks, to_string(TaskOutcome::pending)));
}

/// Copies the runs of earlier files; each row gets its source file unless it has one already.
int copy_runs(const hdf5::File& file, const std::vector<fs::path>& earlier) {
  int row = 0;
  for (const fs::path& path : earlier)
    for (RunRow& run : read_runs(open_results(path))) {
      if (row == run_rows - 1) return row;
      if (run.source.empty()) run.source = path.native();
      write_run(file, static_cast<std::size_t>(row++), run);
    }
  return row;
}

/// Allocates blocks for the sparse file. Without support by the file system, only the free-space check protects.
void reserve_blocks(const fs::path& file, const fs::path& path) {
  const auto bytes = static_cast<std::int64_t>(fs::file_size(file));
  const Descriptor descriptor(open(file.c_str(), O_RDWR | O_CLOEXEC));
  if (!descriptor) throw creation_error(path, system_text(errno));
  const int error = fallocate(descriptor.number(), 0, 0, bytes) == 0 ? 0 : errno;
  if (error == ENOSPC || error == EDQUOT)
    throw space_error(path, bytes, "the file system reports: " + system_text(error));
  if (error == EFBIG) throw space_error(path, bytes, "the file system does not allow files of this size");
}

}  // namespace

std::uintmax_t free_bytes(const fs::path& folder) { return fs::space(folder).available; }

std::int64_t file_bytes(const Plan& plan) { return file_bytes(layout(plan, plan.parameters())); }

int create_results_file(const fs::path& path, const Plan& plan, const FreeSpace& free_space,
                        const std::vector<fs::path>& earlier) {
  refuse_existing(path, resume_advice);
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  make_folder_of(path);

  const std::vector<ParameterColumn> parameters = plan.parameters();
  const std::vector<Field> fields = layout(plan, parameters);
  const std::int64_t bytes = file_bytes(fields);
  if (const std::uintmax_t available = free_space(folder); available < static_cast<std::uintmax_t>(bytes)) {
    throw space_error(
        path, bytes,
        fmt::format("only {} are free in {}", bytes_text(static_cast<std::int64_t>(available)), folder.native()));
  }

  const UnfinishedFile unfinished(path);
  unfinished.check_creatable();
  int runs = 0;
  try {
    hdf5::File file = hdf5::create_file(unfinished.path());
    create_datasets(file.id(), fields);
    write_constants(file.id(), plan, parameters);
    runs = copy_runs(file, earlier);
    hdf5::close(file, "H5Fclose", unfinished.path().native());
  } catch (const Hdf5Error& failure) {
    throw writing_error(path, failure.what());
  }
  reserve_blocks(unfinished.path(), path);
  unfinished.publish();
  return runs;
}

}  // namespace rodsweep
