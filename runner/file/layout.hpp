// Every dataset of a plan's results file: path, type, extents, unit and meaning. Creating the file, its size, opening
// it and the checks of --resume all walk this one list. A dataset that would hold nothing is left out (/solves of a job
// that records summaries, /trajectories, /systems of a sweep, what has a guess axis where there are no guesses,
// contacts where no task has contact).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runner/file/hdf5.hpp"
#include "runner/file/record.hpp"
#include "runner/job/plan.hpp"

namespace rodsweep {

enum class Element { int8, uint8, int16, int32, int64, uint64, float32, float64, text };

struct Field {
  std::string path;
  Element element = Element::float64;
  std::int64_t text_bytes = 0;       ///< length of Element::text
  std::vector<std::int64_t> extent;  ///< empty: a scalar
  std::string unit, meaning;
};

inline constexpr int schema_version = 1;

inline constexpr int run_rows = 64;  ///< rows of /runs: starts that one file remembers
inline constexpr int outcome_bytes = 16;
inline constexpr int message_bytes = 240;
inline constexpr int host_bytes = 64;

template <class T>
constexpr Element element_of() {
  if constexpr (std::is_same_v<T, std::int8_t>)
    return Element::int8;
  else if constexpr (std::is_same_v<T, std::uint8_t>)
    return Element::uint8;
  else if constexpr (std::is_same_v<T, std::int16_t>)
    return Element::int16;
  else if constexpr (std::is_same_v<T, std::int32_t>)
    return Element::int32;
  else if constexpr (std::is_same_v<T, std::int64_t>)
    return Element::int64;
  else if constexpr (std::is_same_v<T, std::uint64_t>)
    return Element::uint64;
  else if constexpr (std::is_same_v<T, float>)
    return Element::float32;
  else {
    static_assert(std::is_same_v<T, double>, "no element for this");
    return Element::float64;
  }
}

/// `parameters` are plan.parameters(), which are built on demand.
std::vector<Field> layout(const Plan& plan, const std::vector<ParameterColumn>& parameters);

hdf5::Datatype type_of(const Field& field);

/// Bytes of a dataset's values.
std::int64_t data_bytes(const Field& field);

/// What only some files hold, so that only they say where a task has it.
struct PlacedRows {
  bool segments = false;  ///< of recorded trajectories
  bool systems = false;   ///< the linear systems of a data set
};
PlacedRows placed_rows(const Plan& plan);

/// What the plan says about each task, as datasets: calls visit(path, unit, meaning, value), value(task) a number.
template <class Visit>
void visit_task_columns(const PlacedRows& placed, Visit&& visit) {
  visit("/tasks/point", "1", "parameter point; tasks of a closed loop that differ in their guess alone share it",
        [](const Task& task) { return task.point; });
  visit("/tasks/sample", "1", "which draw of the random parameters, from 0",
        [](const Task& task) { return task.sample; });
  visit("/tasks/own_guess", "1", "index into /axes/guess of the guess that advances the rods; -1 the direct solve does",
        [](const Task& task) { return static_cast<std::int32_t>(task.own_guess); });
  visit("/tasks/segments", "1", "segments of the scene",
        [](const Task& task) { return static_cast<std::int32_t>(task.segments); });
  visit("/tasks/joints", "1", "joints of the scene",
        [](const Task& task) { return static_cast<std::int32_t>(task.joints); });
  visit("/tasks/first_step", "1", "first row in /steps", [](const Task& task) { return task.first_step; });
  visit("/tasks/steps", "1", "rows in /steps", [](const Task& task) { return task.steps; });
  visit("/tasks/first_solve", "1", "first row in /solves", [](const Task& task) { return task.first_solve; });
  visit("/tasks/solves", "1", "rows in /solves", [](const Task& task) { return task.solves; });
  visit("/tasks/first_frame_row", "1", "first row in /trajectories",
        [](const Task& task) { return task.first_frame_row; });
  visit("/tasks/frames", "1", "frames in /trajectories, each of `segments` rows",
        [](const Task& task) { return task.frames; });
  if (placed.segments) {
    visit("/tasks/first_segment_row", "1", "first row in /trajectories/segments",
          [](const Task& task) { return task.first_segment_row; });
  }
  if (!placed.systems) return;
  visit("/tasks/first_system", "1", "first row in /systems", [](const Task& task) { return task.first_system; });
  visit("/tasks/systems", "1", "rows in /systems", [](const Task& task) { return task.systems; });
  visit("/tasks/first_system_segment", "1", "first row in /systems/segments",
        [](const Task& task) { return task.first_system_segment; });
  visit("/tasks/system_segments", "1", "rows in /systems/segments, system by system",
        [](const Task& task) { return task.system_segments; });
  visit("/tasks/first_system_joint", "1", "first row in /systems/joints",
        [](const Task& task) { return task.first_system_joint; });
  visit("/tasks/system_joints", "1", "rows in /systems/joints, system by system",
        [](const Task& task) { return task.system_joints; });
}

/// Sixteen hexadecimal digits over what the plan fixes about the file (floating-point parameters are left out: another
/// machine may round them differently).
std::string plan_hash(const Plan& plan, const std::vector<ParameterColumn>& parameters);

}  // namespace rodsweep
