#include "runner/file/extension.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <string_view>
#include <unordered_map>

#include "runner/file/columns.hpp"
#include "runner/file/file_reading.hpp"
#include "runner/file/inspect.hpp"
#include "runner/file/resume_check.hpp"
#include "runner/file/runs.hpp"
#include "runner/file/stored_plan.hpp"
#include "runner/plan/job_extension.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

/// An index on a guess axis, and the length of that axis.
struct GuessPlace {
  std::size_t guess, guesses;
};

/// Copies one guess in every row; the two columns differ only in the length of their guess axis.
void copy_guess(const Column& column, const Task& task, const TaskRecord& source, const GuessPlace& from,
                TaskRecord& target, const GuessPlace& to) {
  const auto rows = static_cast<std::size_t>(task.rows[column.rows].count);
  if (rows == 0) return;
  const std::string_view bytes = bytes_of(column, source);
  const std::size_t block = bytes.size() / (rows * from.guesses);
  for (std::size_t row = 0; row < rows; ++row) {
    std::memcpy(data_of(column, target) + (row * to.guesses + to.guess) * block,
                bytes.data() + (row * from.guesses + from.guess) * block, block);
  }
}

}  // namespace

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
      throw FileError(fmt::format(
          "{} holds only one task of a sweep, from `rodsweep rerun`: extend the file of the sweep", path.native()));
  }
  check_same_plan(path, *before_, "Extend it with that revision, or run the whole job without --extend");
  reader_.emplace(path);

  std::unordered_map<std::size_t, std::vector<std::int64_t>> by_trajectory;
  const std::hash<std::string> hash;
  for (const Task& task : before_->tasks())
    if (!may_change(reader_->outcome(task.index)))
      by_trajectory[hash(before_->identity(task.index).trajectory)].push_back(task.index);
  for (const Task& task : plan.tasks()) {
    const TaskIdentity wanted = plan.identity(task.index);
    const auto same = by_trajectory.find(hash(wanted.trajectory));
    uses_.push_back(same == by_trajectory.end() ? Source{} : find(task, wanted, same->second));
  }
}

/// Per guess: the column of the same guess in the source, -1 if the source does not have it, -2 if the task does not
/// try it.
std::vector<int> Extension::sources(const Task& task, const TaskIdentity& wanted, const Task& source,
                                    const TaskIdentity& found) const {
  std::vector<int> columns(plan_->guess_labels().size(), -2);
  for (std::size_t g = 0; g < wanted.guesses.size(); ++g) {
    if (task.own_guess >= 0) {
      if (static_cast<int>(g) == task.own_guess) columns[g] = source.own_guess;
      continue;
    }
    const auto same = std::find(found.guesses.begin(), found.guesses.end(), wanted.guesses[g]);
    columns[g] = same == found.guesses.end() ? -1 : static_cast<int>(same - found.guesses.begin());
  }
  return columns;
}

Extension::Source Extension::find(const Task& task, const TaskIdentity& wanted,
                                  const std::vector<std::int64_t>& candidates) const {
  Source best;
  for (const std::int64_t candidate : candidates) {
    const TaskIdentity found = before_->identity(candidate);
    if (found.trajectory != wanted.trajectory) continue;
    const std::vector<int> places = sources(task, wanted, before_->task(candidate), found);
    const auto missing = static_cast<int>(std::count(places.begin(), places.end(), -1));
    // A failed task cannot be completed: what another guess would have been given is unknown.
    if (missing > 0 && reader_->outcome(candidate) != TaskOutcome::ok) continue;
    if (best.task < 0 || missing < best.missing) best = {candidate, missing == 0 ? Use::copy : Use::complete, missing};
    if (missing == 0) break;
  }
  return best;
}

std::int64_t Extension::count(Use use) const {
  return std::count_if(uses_.begin(), uses_.end(), [&](const Source& source) { return source.use == use; });
}

void Extension::check_started(const fs::path& path) const {
  const std::vector<RunRow> here = read_runs(open_results(path)), there = read_runs(open_results(path_));
  const auto same_begin = [](const RunRow& a, const RunRow& b) {
    return a.provenance.begin_utc == b.provenance.begin_utc;
  };
  if (here.empty() || here.front().source.empty() || here.size() < there.size() ||
      !std::equal(there.begin(), there.end(), here.begin(), same_begin)) {
    throw FileError(fmt::format(
        "{} was not started with --extend {}, or that file was resumed since; use --resume without --extend",
        path.native(), path_.native()));
  }
}

double Extension::cost(std::int64_t task) const {
  const Source& source = uses_[static_cast<std::size_t>(task)];
  constexpr double copying = 1e-3;
  if (source.use == Use::copy) return copying;
  if (source.use == Use::run) return 1;
  return (1.0 + source.missing) / (1.0 + static_cast<double>(plan_->guess_labels().size()));
}

bool Extension::take(std::int64_t index, TaskRecord& record) const {
  TaskRecord earlier;
  const Task task = plan_->task(index), from = before_->task(source(index));
  if (!reader_->read_intact(from.index, earlier)) return false;
  record.outcome = earlier.outcome;
  record.message = earlier.message;
  const std::vector<int> guesses = sources(task, plan_->identity(index), from, before_->identity(from.index));
  for (const Column& column : columns()) {
    if (!has_guesses(column)) {  // the frame axes of the two plans may differ in length
      const std::string_view source = bytes_of(column, earlier);
      const std::size_t bytes = std::min(source.size(), bytes_of(column, record).size());
      std::copy_n(source.begin(), bytes, data_of(column, record));
      continue;
    }
    for (std::size_t g = 0; g < guesses.size(); ++g) {
      if (guesses[g] < 0) continue;
      copy_guess(column, task, earlier, {static_cast<std::size_t>(guesses[g]), before_->guess_labels().size()}, record,
                 {g, guesses.size()});
    }
  }
  for (std::int64_t& row : record.trajectories.first_row)
    if (row >= 0) row += task.rows[Rows::frame_segment].first - from.rows[Rows::frame_segment].first;
  record.timing.source_task[0] = from.index;
  for (std::size_t g = 0; g < guesses.size(); ++g) record.timing.copied_guess[g] = guesses[g] < 0 ? -1 : 1;
  return true;
}

std::string complete(const Task& task, TaskRecord& record, const TaskRecord& taken) {
  const bool is_ok = record.outcome == TaskOutcome::ok;  // then a message is a warning about a guess
  if (record.outcome != taken.outcome || (!is_ok && record.message != taken.message)) {
    return fmt::format("it ended as {} ({}), before as {} ({})", to_string(record.outcome), record.message,
                       to_string(taken.outcome), taken.message);
  }
  for (const Column& column : columns()) {
    const std::string_view now = bytes_of(column, record), before = bytes_of(column, taken);
    if (now == before || has_guesses(column) || is_timing(column)) continue;
    const auto byte = std::mismatch(now.begin(), now.end(), before.begin()).first - now.begin();
    const std::size_t value = static_cast<std::size_t>(byte) / H5Tget_size(column.type());
    return fmt::format("{}, value {}, is {} and was {}", column.path, value, text_of(column, record, value),
                       text_of(column, taken, value));
  }
  const std::size_t guesses = taken.timing.copied_guess.size();
  for (const Column& column : columns()) {
    if (!has_guesses(column)) continue;
    for (std::size_t g = 0; g < guesses; ++g)
      if (taken.timing.copied_guess[g] == 1) copy_guess(column, task, taken, {g, guesses}, record, {g, guesses});
  }
  if (record.message.empty()) record.message = taken.message;
  record.timing.source_task = taken.timing.source_task;
  return {};
}

}  // namespace rodsweep
