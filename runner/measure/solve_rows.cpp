#include "runner/measure/solve_rows.hpp"

#include "solver/numbers/narrow.hpp"
#include "solver/step/observables.hpp"

namespace rodsweep {

std::size_t solve_row(const TaskSpec& spec, std::size_t rods, const SolvePosition& at) {
  const auto newton_iterations = static_cast<std::size_t>(spec.time.newton_iterations);
  const std::size_t iteration =
      static_cast<std::size_t>(at.step) * newton_iterations + static_cast<std::size_t>(at.newton);
  return iteration * rods + static_cast<std::size_t>(at.rod);
}

void log_position(const SolvePosition& at, std::size_t row, TaskRecord& record) {
  record.solves.step[row] = at.step;
  record.solves.newton[row] = static_cast<std::int16_t>(at.newton);
  record.solves.rod[row] = narrow<std::int16_t>(at.rod);
}

void log_system(const LinearSystem& system, const Rod& rod, const SolvePosition& at, std::size_t row,
                TaskRecord& record) {
  log_position(at, row, record);
  record.solves.newton_residual[row] = system.newton_residual();
  record.solves.joint_gap[row] = joint_gap(rod);
  record.solves.rhs_norm[row] = system.rhs().norm();
}

}  // namespace rodsweep
