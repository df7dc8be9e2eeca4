#include "runner/file/extension.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <unordered_map>
#include <utility>

#include "runner/file/file_reading.hpp"
#include "runner/file/provenance.hpp"
#include "runner/file/task_checksum.hpp"
#include "runner/job/job_extension.hpp"

namespace rodsweep {
namespace {

namespace fs = std::filesystem;

/// One column of a record, its type put aside.
template <class Byte>
struct Bytes {
  Column column;
  Byte* values;
  std::size_t size;
};

template <class Byte, class Record>
std::vector<Bytes<Byte>> columns_of(Record& record) {
  std::vector<Bytes<Byte>> columns;
  visit_columns(record, [&](const Column& column, auto& values) {
    columns.push_back({column, reinterpret_cast<Byte*>(values.data()),
                       values.size() * sizeof(typename std::decay_t<decltype(values)>::value_type)});
  });
  return columns;
}

/// Is its first axis after the row that of the guesses?
bool has_guesses(const Column& column) { return !column.axes.empty() && column.axes.front() == Axis::guess; }

/// Copies guess `from` of every row to guess `to`; the columns differ in the length of their guess axis alone.
void copy_guess(const Bytes<const char>& source, std::size_t from, std::size_t source_guesses,
                const Bytes<char>& target, std::size_t to, std::size_t target_guesses, const Task& task) {
  const auto rows = static_cast<std::size_t>(task.rows[target.column.rows].count);
  if (rows == 0) return;
  const std::size_t block = target.size / (rows * target_guesses);
  for (std::size_t row = 0; row < rows; ++row) {
    std::memcpy(target.values + (row * target_guesses + to) * block,
                source.values + (row * source_guesses + from) * block, block);
  }
}

/// Tasks that another attempt might not end like this.
bool is_final(TaskOutcome outcome) {
  return outcome != TaskOutcome::pending && outcome != TaskOutcome::timed_out && outcome != TaskOutcome::error;
}

std::string row_of(const hdf5::File& file, const char* path) {
  const int runs = runs_used(file);
  return runs > 0 ? hdf5::read_text_row(file.id(), path, static_cast<hsize_t>(runs - 1)) : "";
}

}  // namespace

Extension::Extension(const fs::path& path, const Plan& plan) : path_(path), plan_(&plan) {
  {
    const hdf5::File file = open_results(path);
    try {
      before_ = std::make_unique<Plan>(parse_job(hdf5::read_texts(file.id(), "/job/text").at(0), path));
      if (const std::string revision = row_of(file, "/runs/revision"); revision != source_revision()) {
        note_ = fmt::format("{} was made by revision {}, and this is {}: what is copied is the former's", path.native(),
                            revision, source_revision());
      }
    } catch (const Hdf5Error& failure) {
      throw damaged_error(path, failure.what());
    }
  }
  check_extends(plan.job(), before_->job());
  reader_ = std::make_unique<TaskReader>(path, *before_,
                                         "Extend it with that revision, or run the whole job without --extend");

  std::unordered_map<std::size_t, std::vector<std::int64_t>> by_trajectory;
  const std::hash<std::string> hash;
  for (const Task& task : before_->tasks())
    if (is_final(reader_->outcome(task.index)))
      by_trajectory[hash(before_->identity(task.index).trajectory)].push_back(task.index);
  for (const Task& task : plan.tasks()) {
    const TaskIdentity wanted = plan.identity(task.index);
    const auto same = by_trajectory.find(hash(wanted.trajectory));
    uses_.push_back(same == by_trajectory.end() ? Source{} : find(task, wanted, same->second));
  }
}

/// For every guess that the task tries, the column of the same guess in its source, or -1; for one that it does not
/// try, -2.
std::vector<int> Extension::columns(const Task& task, const TaskIdentity& wanted, const Task& source,
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
    const std::vector<int> places = columns(task, wanted, before_->task(candidate), found);
    const auto missing = static_cast<int>(std::count(places.begin(), places.end(), -1));
    // Of a task that failed on its way there is no telling what another guess would have seen.
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
  const hdf5::File here = open_results(path), there = open_results(path_);
  const auto begins = hdf5::read_texts(here.id(), "/runs/begin"), earlier = hdf5::read_texts(there.id(), "/runs/begin");
  if (hdf5::read_text_row(here.id(), "/runs/source", 0).empty() ||
      !std::equal(earlier.begin(), earlier.begin() + runs_used(there), begins.begin())) {
    throw FileError(
        fmt::format("{} was not begun with --extend {}, or that file was continued since; --resume it "
                    "without --extend",
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
  const Task &task = plan_->task(index), &from = before_->task(source(index));
  if (!reader_->read(from.index, earlier)) return false;
  record.outcome = earlier.outcome;
  record.message = earlier.message;
  const std::vector<int> guesses = columns(task, plan_->identity(index), from, before_->identity(from.index));
  const std::size_t earlier_guesses = before_->guess_labels().size();
  const auto sources = columns_of<const char>(std::as_const(earlier));
  const auto targets = columns_of<char>(record);
  for (std::size_t c = 0; c < targets.size(); ++c) {
    if (!has_guesses(targets[c].column)) {  // the frame axis is as long as the plan's longest task needs it
      const std::size_t bytes = std::min(sources[c].size, targets[c].size);
      if (bytes > 0) std::memcpy(targets[c].values, sources[c].values, bytes);
      continue;
    }
    for (std::size_t g = 0; g < guesses.size(); ++g) {
      if (guesses[g] < 0) continue;
      copy_guess(sources[c], static_cast<std::size_t>(guesses[g]), earlier_guesses, targets[c], g, guesses.size(),
                 task);
    }
  }
  for (std::int64_t& row : record.first_row)
    if (row >= 0) row += task.rows[Rows::frame_segment].first - from.rows[Rows::frame_segment].first;
  record.source_task[0] = from.index;
  for (std::size_t g = 0; g < guesses.size(); ++g) record.copied_guess[g] = guesses[g] < 0 ? -1 : 1;
  return true;
}

std::string complete(const Task& task, TaskRecord& record, const TaskRecord& taken) {
  if (record.outcome != taken.outcome || record.message != taken.message) {
    return fmt::format("it ended as {} ({}) and had ended as {} ({})", to_string(record.outcome), record.message,
                       to_string(taken.outcome), taken.message);
  }
  std::string difference;
  const auto sources = columns_of<const char>(taken);
  std::size_t next = 0;
  visit_columns(std::as_const(record), [&](const Column& column, const auto& values) {
    using T = typename std::decay_t<decltype(values)>::value_type;
    const Bytes<const char>& source = sources[next++];
    if (!difference.empty() || has_guesses(column) || !TaskChecksum::covers(column)) return;
    for (std::size_t i = 0; i < values.size(); ++i) {
      T before{};
      std::memcpy(&before, source.values + i * sizeof(T), sizeof(T));
      if (std::memcmp(&before, &values[i], sizeof(T)) == 0) continue;
      difference = fmt::format("{}, value {}, is {} and was {}", column.path, i, values[i], before);
      return;
    }
  });
  if (!difference.empty()) return difference;

  const auto targets = columns_of<char>(record);
  const std::size_t guesses = taken.copied_guess.size();
  for (std::size_t c = 0; c < targets.size(); ++c) {
    if (!has_guesses(targets[c].column)) continue;
    for (std::size_t g = 0; g < guesses; ++g)
      if (taken.copied_guess[g] == 1) copy_guess(sources[c], g, guesses, targets[c], g, guesses, task);
  }
  record.source_task = taken.source_task;
  return {};
}

}  // namespace rodsweep
