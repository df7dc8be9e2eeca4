// One task of a sweep: its place in the plan and its rows in the file. Its settings are a TaskSpec.
#pragma once

#include <cstdint>

#include "runner/plan/rows.hpp"

namespace rodsweep {

/// A task's identity and its rows in the file. Sizes are upper bounds, known before the run.
struct Task {
  std::int64_t index = 0;  ///< row of /tasks
  std::int64_t point =
      0;  ///< parameter point (grid point and sample); closed-loop tasks that differ only in their guess share it
  std::int64_t sample = 0;  ///< draw of the random parameters, 0 .. samples-1
  int own_guess = -1;
  int segments = 0;  ///< dynamic and static (graph nodes)
  int joints = 0;
  std::int64_t steps = 0;
  std::int64_t frames = 0;  ///< of the trajectory
  PerRows<RowRange> rows;
  double cost = 0;  ///< relative: segments x steps x newton_iterations; tasks are dispatched in descending order
};

}  // namespace rodsweep
