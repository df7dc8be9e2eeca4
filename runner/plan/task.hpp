// One task of a sweep: its place in the plan and its rows in the file. Its settings are a TaskSpec.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace rodsweep {

// The kinds of rows in a results file, and the columns of /tasks with each task's row ranges.
// A new kind is added here and in size_rows() (runner/plan/plan.cpp); plan, layout, writing and reading use the array.

/// What a row of a dataset describes.
enum class Rows {
  task,
  contact_task,  ///< as task, in files where any task has contact
  step,
  contact_step,   ///< as step, in these files
  solve,          ///< by step, Newton iteration, rod; none in summaries
  frame_segment,  ///< by frame, segment
  segment,        ///< of a trajectory
  system,         ///< of a data set: by step, stored Newton iteration, rod
  system_segment,
  system_joint,
  balanced_segment,  ///< as system_segment, in files where any task balances momentum in its steps
  force_step,        ///< as step, if forces are recorded
  frame_joint,       ///< by frame, joint, if forces are recorded
  joint,             ///< of a trajectory with forces
  state_segment,     ///< as frame_segment, if states are recorded
  state_joint        ///< by frame, joint, if states are recorded
};
inline constexpr std::size_t row_kinds = static_cast<std::size_t>(Rows::state_joint) + 1;

/// Whether columns of these rows may be missing in a file that has their base kind.
constexpr bool is_optional(Rows rows) {
  switch (rows) {
    case Rows::contact_task:
    case Rows::contact_step:
    case Rows::balanced_segment:
    case Rows::force_step:
    case Rows::frame_joint:
    case Rows::joint:
    case Rows::state_segment:
    case Rows::state_joint: return true;
    default: return false;
  }
}

/// Rows [first, first + count) of a dataset.
struct RowRange {
  std::int64_t first = 0, count = 0;
};

/// One value per kind of rows.
template <class T>
struct PerRows : std::array<T, row_kinds> {
  using std::array<T, row_kinds>::operator[];
  constexpr T& operator[](Rows kind) { return (*this)[static_cast<std::size_t>(kind)]; }
  constexpr const T& operator[](Rows kind) const { return (*this)[static_cast<std::size_t>(kind)]; }
};

/// The columns of /tasks with a task's first row of a kind and its number of rows.
struct RowPlace {
  Rows rows;
  const char *first, *first_meaning;
  const char *count, *count_meaning;  ///< null: follows from those of segments, joints and frames
  Rows with;                          ///< only in files that have rows of this kind
};
inline constexpr std::array<RowPlace, 9> row_places{{
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
    {Rows::frame_joint, "/tasks/first_frame_joint",
     "first row in the columns of joints in /trajectories, of which each frame has `joints`", nullptr, nullptr,
     Rows::frame_joint},
    {Rows::joint, "/tasks/first_joint_row", "first row in /trajectories/joints", nullptr, nullptr, Rows::joint},
}};

/// What determines the numbers of a task's rows and its cost. Sizes are upper bounds, known before the run.
struct TaskSize {
  int segments = 0;  ///< dynamic and static (graph nodes)
  int joints = 0;
  std::int64_t steps = 0;
  std::int64_t frames = 0;  ///< of the trajectory
  double cost = 0;  ///< relative: segments x steps x newton_iterations; tasks are dispatched in descending order
};

/// A task's identity, size and rows in the file.
struct Task : TaskSize {
  std::int64_t index = 0;  ///< row of /tasks
  /// Parameter point (grid point and sample); closed-loop tasks that differ only in their guess share it.
  std::int64_t point = 0;
  std::int64_t sample = 0;  ///< draw of the random parameters, 0 .. samples-1
  int own_guess = -1;
  PerRows<RowRange> rows;
};

}  // namespace rodsweep
