// All datasets of a plan's results file: path, type, extents, unit and meaning. Used to create and open the file, to
// compute its size and to check it for --resume. Empty datasets are left out: for example /solves of a job that records
// summaries, /systems of a sweep, those with a guess axis without guesses, and those of contacts without contact.
#pragma once

#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "runner/file/hdf5.hpp"
#include "runner/plan/plan.hpp"

namespace rodsweep {

struct Field {
  std::string path;
  hid_t (*number)() = nullptr;       ///< hdf5::type_of<T>; null: text
  std::int64_t text_bytes = 0;       ///< length of a text
  std::vector<std::int64_t> extent;  ///< empty: a scalar
  std::string unit, meaning;
};

inline constexpr int schema_version = 2;

inline constexpr int outcome_bytes = 16;
inline constexpr int message_bytes = 240;
inline constexpr int host_bytes = 64;

/// The datasets of tasks that are neither planned nor columns(), of an open file.
struct TaskRows {
  hdf5::RowDataset state, outcome, message, checksum;  ///< in /tasks
  hdf5::RowDataset tries, rank, host, run, write_s;    ///< in /timing/tasks

  TaskRows() = default;
  explicit TaskRows(hid_t file)
      : state(file, "/tasks/state"),
        outcome(file, "/tasks/outcome"),
        message(file, "/tasks/message"),
        checksum(file, "/tasks/checksum"),
        tries(file, "/timing/tasks/tries"),
        rank(file, "/timing/tasks/rank"),
        host(file, "/timing/tasks/host"),
        run(file, "/timing/tasks/run"),
        write_s(file, "/timing/tasks/write_s") {}
};

/// `parameters`: plan.parameters(), which are built on demand. Throws FileError if the size exceeds any file system.
std::vector<Field> layout(const Plan& plan, const std::vector<ParameterColumn>& parameters);

Field text_field(std::string path, std::int64_t bytes, std::vector<std::int64_t> extent, std::string meaning);

template <class T>
Field number_field(std::string path, std::vector<std::int64_t> extent, std::string unit, std::string meaning) {
  return {std::move(path), hdf5::type_of<T>, 0, std::move(extent), std::move(unit), std::move(meaning)};
}

hdf5::Datatype type_of(const Field& field);

/// Bytes of a dataset's values.
std::int64_t data_bytes(const Field& field);

/// A hash of the plan, sixteen hexadecimal digits. Floating-point parameters are left out, because other machines may
/// round them differently.
std::string plan_hash(const Plan& plan, const std::vector<ParameterColumn>& parameters);

// The columns of /tasks that come from the plan: each task's place in the sweep and its row ranges. Used for the
// layout, the plan's hash, creation and reading.

/// Calls visit(path, meaning, member) for all columns of a file; member(task) is the value of a task. Optional columns
/// are visited if `holds` returns true for their RowPlace.
template <class Holds, class Visit>
void visit_planned_columns(Holds&& holds, Visit&& visit) {
  visit(
      "/tasks/point", "parameter point; closed-loop tasks that differ only in their guess share it",
      [](auto& task) -> auto& { return task.point; });
  visit(
      "/tasks/sample", "number of the draw of the random parameters, from 0",
      [](auto& task) -> auto& { return task.sample; });
  visit(
      "/tasks/own_guess", "index into /axes/guess of the guess that advances the rods; -1: solve.reference",
      [](auto& task) -> auto& { return task.own_guess; });
  visit(
      "/tasks/segments", "segments of the scene", [](auto& task) -> auto& { return task.segments; });
  visit(
      "/tasks/joints", "joints of the scene", [](auto& task) -> auto& { return task.joints; });
  for (const RowPlace& place : row_places) {
    if (place.with != Rows::task && !holds(place)) continue;
    visit(
        place.first, place.first_meaning, [&](auto& task) -> auto& { return task.rows[place.rows].first; });
    if (place.count == nullptr) continue;
    visit(
        place.count, place.count_meaning, [&](auto& task) -> auto& {
          return place.rows == Rows::frame_segment ? task.frames : task.rows[place.rows].count;
        });
  }
}

/// Calls visit(path, meaning, values), with one value per task.
template <class Visit>
void visit_planned_values(const Plan& plan, Visit&& visit) {
  const auto holds = [&](const RowPlace& place) { return plan.rows(place.with) > 0; };
  visit_planned_columns(holds, [&](const char* path, const char* meaning, auto member) {
    std::vector<std::decay_t<decltype(member(std::declval<const Task&>()))>> values;
    for (const Task& task : plan.tasks()) values.push_back(member(task));
    visit(path, meaning, values);
  });
}

}  // namespace rodsweep
