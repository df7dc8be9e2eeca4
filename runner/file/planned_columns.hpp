// The columns of /tasks that come from the plan: each task's place in the sweep and its row ranges. Used for the
// layout, the plan's hash, creation and reading.
#pragma once

#include <type_traits>
#include <utility>
#include <vector>

#include "runner/plan/plan.hpp"

namespace rodsweep {

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
