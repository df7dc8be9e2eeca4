#include "runner/dataset/dataset_reader.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "runner/dataset/stored_systems.hpp"
#include "runner/file/columns.hpp"
#include "runner/file/file_reading.hpp"
#include "runner/file/inspect.hpp"
#include "runner/file/stored_plan.hpp"
#include "runner/mpi/mpi_session.hpp"
#include "runner/terminal/formats.hpp"
#include "runner/text/checksum.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

void check_usable(const FileSummary& file) {
  const std::string path = file.path.native();
  if (file.job_kind != "dataset") {
    throw FileError("{} holds the results of a {}, not a data set: give the file of a job of kind \"dataset\"", path,
                    file.job_kind);
  }
  if (file.rerun_of_task) {
    throw FileError("{} holds only one task of a data set, from `rodsweep rerun`: give the file of the data set", path);
  }
  if (file.pending > 0) {
    throw FileError(
        "{} is not complete: {} of {} simulations are missing; finish it with: rodsweep run {} -o {} --resume", path,
        file.pending, file.tasks, shell_quoted(stored_job_path(file).native()), shell_quoted(path));
  }
  if (file.failed == file.tasks) {
    throw FileError("{} holds no usable simulation: all {} failed (rodsweep status {})", path, file.tasks,
                    shell_quoted(path));
  }
}

std::string hash_of(const FileSummary& file) {
  const auto checksums = hdf5::read_all<std::uint64_t>(open_results(file.path).id(), "/tasks/checksum");
  Checksum sum;
  sum.add(file.job_text.data(), file.job_text.size());
  sum.add(checksums.data(), checksums.size() * sizeof(std::uint64_t));
  return fmt::format("{:016x}", sum.value());
}

std::string failures_text(const FileSummary& file) {
  if (file.failed == 0) return "";
  const FailedTask& first = file.failures.front();
  return fmt::format("{} of {} simulations of {} failed and are left out (the first: task {}, {}: {})", file.failed,
                     file.tasks, file.path.native(), first.index, first.outcome, first.message);
}

}  // namespace

DatasetReader::DatasetReader(const fs::path& path, std::optional<MPI_Comm> ranks) : path_(path), ranks_(ranks) {
  by_rank_0(ranks_, [this] { open(); });
  if (!ranks_) return;
  const auto text = [&](std::string value) { return broadcast(std::move(value), *ranks_); };
  const Job job = plan_ ? plan_->job() : Job();
  const std::string job_text = text(job.text), job_path = text(job.path.native()), files = text(to_bytes(job.files));
  hash_ = text(hash_);
  note_ = text(note_);
  broadcast(tasks_, *ranks_);
  if (!plan_) plan_.emplace(parse_job(job_text, job_path, from_bytes(files)));
}

void DatasetReader::open() {
  const FileSummary file = inspect(path_);
  check_usable(file);
  plan_ = stored_plan(file);
  check_same_plan(path_, *plan_, "Use that revision, or make the data set again");
  reader_.emplace(path_);
  for (const Task& task : plan_->tasks())
    if (reader_->outcome(task.index) == TaskOutcome::ok) tasks_.push_back(task.index);
  std::stable_sort(tasks_.begin(), tasks_.end(),
                   [this](std::int64_t a, std::int64_t b) { return plan_->task(a).sample < plan_->task(b).sample; });
  hash_ = hash_of(file);
  note_ = failures_text(file);
}

Task DatasetReader::task(std::int64_t simulation) const {
  return plan_->task(tasks_.at(static_cast<std::size_t>(simulation)));
}

StoredSimulation DatasetReader::read(std::int64_t simulation) const {
  const std::int64_t index = task(simulation).index;
  TaskRecord record;
  record.prepare(plan_->task(index), axis_sizes(*plan_));
  by_rank_0(ranks_, [&] {
    if (reader_->read_intact(index, record)) return;
    throw FileError("{} is damaged: wrong checksum of task {}; make the data set again", path_.native(), index);
  });
  if (ranks_)
    for (const Column& column : columns())
      std::visit([this](auto* values) { broadcast(*values, *ranks_); }, column.values(record));
  const TaskSpec spec = plan_->spec(index);
  StoredSimulation result;
  result.scene = build_scene(spec.scene);
  result.step_s = spec.time.step_s;
  result.newton_iterations = spec.time.newton_iterations;
  result.systems = stored_systems(record, result.scene, spec.output.stored_iterations(spec.time.newton_iterations));
  return result;
}

std::vector<StoredSimulation> DatasetReader::read(std::int64_t first, std::int64_t count) const {
  std::vector<StoredSimulation> simulations;
  for (std::int64_t i = first; i < first + count; ++i) simulations.push_back(read(i));
  return simulations;
}

}  // namespace rodsweep
