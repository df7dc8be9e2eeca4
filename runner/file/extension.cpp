#include "runner/file/extension.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <string_view>
#include <unordered_map>

#include "runner/file/columns.hpp"
#include "runner/file/file_reading.hpp"
#include "runner/file/inspect.hpp"
#include "runner/file/runs.hpp"
#include "runner/file/stored_plan.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {

namespace fs = std::filesystem;

Extension::Extension(const fs::path& path, const Plan& plan) : path_(path), plan_(&plan) {
  {
    const FileSummary file = inspect(path);
    const std::string revision = file.runs.empty() ? "" : file.runs.back().provenance.revision;
    if (revision != source_revision()) {
      note_ = fmt::format("{} was made by revision {}, and this is {}: copied results are from the first",
                          path.native(), revision, source_revision());
    }
    Job before = stored_job(file, plan.job().path);
    before.path = path;  // for messages
    check_extends(plan.job(), before);
    before_.emplace(std::move(before));
    if (file.rerun_of_task)
      throw FileError("{} holds only one task of a sweep, from `rodsweep rerun`: extend the file of the sweep",
                      path.native());
  }
  check_same_plan(path, *before_, "Extend it with that revision, or run the whole job without --extend");
  reader_.emplace(path);

  std::unordered_multimap<std::size_t, std::int64_t> by_trajectory;
  const std::hash<std::string> hash;
  for (const Task& task : before_->tasks())
    if (!may_change(reader_->outcome(task.index)))
      by_trajectory.emplace(hash(before_->inputs(task.index).trajectory), task.index);
  for (const Task& task : plan.tasks()) {
    const TaskInputs wanted = plan.inputs(task.index);
    const auto [first, last] = by_trajectory.equal_range(hash(wanted.trajectory));
    const auto same = std::find_if(first, last, [&](const auto& at) { return before_->inputs(at.second) == wanted; });
    sources_.push_back(same == last ? -1 : same->second);
  }
}

std::int64_t Extension::copied() const {
  return std::count_if(sources_.begin(), sources_.end(), [](std::int64_t source) { return source >= 0; });
}

void Extension::check_started(const fs::path& path) const {
  const std::vector<RunRow> here = read_runs(open_results(path)), there = read_runs(open_results(path_));
  const auto same_begin = [](const RunRow& a, const RunRow& b) {
    return a.provenance.begin_utc == b.provenance.begin_utc;
  };
  if (here.empty() || here.front().source.empty() || here.size() < there.size() ||
      !std::equal(there.begin(), there.end(), here.begin(), same_begin)) {
    throw FileError(
        "{} was not started with --extend {}, or that file was resumed since; use --resume without --extend",
        path.native(), path_.native());
  }
}

double Extension::cost(std::int64_t task) const {
  constexpr double copying = 1e-3;
  return source(task) < 0 ? 1 : copying;
}

bool Extension::take(std::int64_t index, TaskRecord& record) const {
  TaskRecord earlier;
  const Task task = plan_->task(index), from = before_->task(source(index));
  if (!reader_->read_intact(from.index, earlier)) return false;
  record.outcome = earlier.outcome;
  record.message = earlier.message;
  for (const Column& column : columns()) {  // the frame axes of the two plans may differ in length
    const std::string_view source = bytes_of(column, earlier);
    const std::size_t bytes = std::min(source.size(), bytes_of(column, record).size());
    std::copy_n(source.begin(), bytes, data_of(column, record));
  }
  for (std::int64_t& row : record.trajectories.first_row)
    if (row >= 0) row += task.rows[Rows::frame_segment].first - from.rows[Rows::frame_segment].first;
  record.timing.source_task[0] = from.index;
  return true;
}

}  // namespace rodsweep
