// The kinds of rows that datasets of a results file have, and where /tasks says which of them are a task's.
// A kind is said here and sized in size_rows() (runner/plan/plan.cpp); plan, layout, writing and reading walk the array.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace rodsweep {

/// What one row of a dataset stands for.
enum class Rows {
  task,
  contact_task,  ///< as task, in files of jobs in any of whose tasks rods touch
  step,
  contact_step,   ///< as step, in the same files
  solve,          ///< step-major, then Newton iterations, then rods; none in summaries
  frame_segment,  ///< frame by frame
  segment,        ///< of a trajectory
  system,         ///< of a data set: step-major, then stored Newton iterations, then rods
  system_segment,
  system_joint,
  balanced_segment  ///< as system_segment, in files of jobs in any of whose tasks steps keep the balance of momentum
};
inline constexpr std::size_t row_kinds = static_cast<std::size_t>(Rows::balanced_segment) + 1;

/// Columns of these rows are not in every file that could have them.
constexpr bool is_optional(Rows rows) {
  return rows == Rows::contact_task || rows == Rows::contact_step || rows == Rows::balanced_segment;
}

/// Rows [first, first + count) of a dataset.
struct RowRange {
  std::int64_t first = 0, count = 0;
};

/// A value for each kind of rows.
template <class T>
struct PerRows : std::array<T, row_kinds> {
  using std::array<T, row_kinds>::operator[];
  constexpr T& operator[](Rows kind) { return (*this)[static_cast<std::size_t>(kind)]; }
  constexpr const T& operator[](Rows kind) const { return (*this)[static_cast<std::size_t>(kind)]; }
};

/// The columns of /tasks with a task's first row of a kind, and with how many it has.
struct RowPlace {
  Rows rows;
  const char *first, *first_meaning;
  const char *count, *count_meaning;  ///< none: as many as the task has segments, if it has frames
  Rows with;                          ///< only in files that have rows of this kind
};
inline constexpr std::array<RowPlace, 7> row_places{{
    {Rows::step, "/tasks/first_step", "first row in /steps", "/tasks/steps", "rows in /steps", Rows::task},
    {Rows::solve, "/tasks/first_solve", "first row in /solves", "/tasks/solves", "rows in /solves", Rows::task},
    {Rows::frame_segment, "/tasks/first_frame_row", "first row in /trajectories", "/tasks/frames",
     "frames in /trajectories, each of `segments` rows", Rows::task},
    {Rows::segment, "/tasks/first_segment_row", "first row in /trajectories/segments", nullptr, nullptr, Rows::segment},
    {Rows::system, "/tasks/first_system", "first row in /systems", "/tasks/systems", "rows in /systems", Rows::system},
    {Rows::system_segment, "/tasks/first_system_segment", "first row in /systems/segments", "/tasks/system_segments",
     "rows in /systems/segments, system by system", Rows::system},
    {Rows::system_joint, "/tasks/first_system_joint", "first row in /systems/joints", "/tasks/system_joints",
     "rows in /systems/joints, system by system", Rows::system},
}};

}  // namespace rodsweep
