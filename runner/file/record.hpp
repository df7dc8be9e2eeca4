// The results of one task in memory: evaluate() fills a TaskRecord, ResultsFile writes it. The columns of the file are
// listed in runner/file/columns.hpp.
//
// Before the task starts, every vector is sized and filled with its sentinel: -1 for counts, NaN for measurements,
// not_run for outcomes. So rows not reached cannot be mistaken for results.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runner/job/task.hpp"
#include "runner/plan/task_outcome.hpp"

namespace rodsweep {

class Plan;

/// Sizes of the axes shared by the whole file.
struct AxisSizes {
  std::int64_t guesses = 0, tolerances = 0, frames = 0;
};

AxisSizes axis_sizes(const Plan& plan);

/// Sums over the solves of a task: [guess, tolerance]. Solves that missed the tolerance count all their iterations.
struct CountSums {
  std::vector<std::int64_t> iterations, matvecs;
  std::vector<std::int32_t> unreached;  ///< solves that missed the tolerance
  std::vector<double> cg_ratio;         ///< iterations over the zero guess's; NaN without one
};

struct TaskRecord {
  // ---- /tasks [task ...]; state and checksum are ResultsFile's
  TaskOutcome outcome = TaskOutcome::pending;
  std::string message;  ///< for outcomes other than ok: the reason and the step

  std::vector<std::int32_t> steps_done;                                ///< [1]
  std::vector<double> deepest_penetration, largest_momentum_residual;  ///< [1]
  CountSums counted, counted_all;                                      ///< first Newton iterations; all of them
  CountSums counted_other_norm;                                        ///< first ones, without matvecs

  // ---- /solves [row ...]
  std::vector<std::int32_t> step;
  std::vector<std::int16_t> newton, rod;
  std::vector<double> newton_residual, solve_joint_gap, rhs_norm;
  std::vector<double> initial_residual, final_residual;  ///< [row, guess] relative to ||b||, in the job's norm
  std::vector<std::int8_t> solve_outcome;                ///< [row, guess] SolveOutcome
  std::vector<std::int16_t> start_matvecs;               ///< [row, guess]
  std::vector<std::int8_t> renewed;                      ///< [row, guess]
  std::vector<std::int16_t> iterations;                  ///< [row, guess, tolerance]

  // ---- /steps [row ...]
  std::vector<double> time_s, length_drift, joint_gap, kinetic_energy_j, potential_energy_j, elastic_energy_j;
  std::vector<double> momentum_kg_m_s, angular_momentum_kg_m2_s;  ///< [row, 3]
  std::vector<std::int16_t> newton_iterations;
  std::vector<double> step_newton_residual, momentum_residual;
  std::vector<std::int32_t> contacts;
  std::vector<double> penetration, contact_residual;

  // ---- /trajectories
  std::vector<double> position_m, orientation;             ///< [frame x segment, 3], [frame x segment, 4] (w, x, y, z)
  std::vector<std::int64_t> first_row;                     ///< [frame] row of the frame in /trajectories
  std::vector<double> frame_time_s;                        ///< [frame]
  std::vector<double> segment_length_m, segment_radius_m;  ///< [segment]
  std::vector<std::int16_t> segment_rod;                   ///< [segment]
  std::vector<std::int8_t> segment_static;                 ///< [segment]

  // ---- /systems: the linear systems of a data set (runner/dataset/stored_systems.hpp)
  std::vector<std::int32_t> system_step;                      ///< [system]
  std::vector<std::int16_t> system_newton, system_rod;        ///< [system]
  std::vector<double> system_position_m, system_orientation;  ///< [system x segment, 3], [.., 4] (w, x, y, z)
  std::vector<double> system_velocity_m_s, system_angular_velocity_rad_s;  ///< [system x segment, 3]
  std::vector<double> system_free_position_m, system_free_orientation;     ///< [balanced_segment, 3], [.., 4]
  std::vector<double> system_contact_force, system_contact_torque;         ///< [balanced_segment, 3]
  std::vector<double> system_lambda, system_solution;                      ///< [system x joint, 6]

  // ---- /timing: data that may differ between runs of the same job; ResultsFile adds rank, host, run, write_s, tries
  std::vector<float> assemble_s, direct_s;  ///< [row]
  std::vector<float> guess_s, cg_s;         ///< [row, guess]; cg_s includes the preconditioner's setup
  std::vector<float> rest_s;                ///< [step row] time of the step without assembly and solves
  std::vector<double> elapsed_s;            ///< [1]
  std::vector<std::int64_t> source_task;    ///< [1] \ of an extended sweep
  std::vector<std::int8_t> copied_guess;    ///< [guess] /

  /// Sizes all vectors for this task and fills them with sentinels. Reuses the memory of an earlier task.
  void prepare(const Task& task, const AxisSizes& sizes);
};

/// Bytes of a row of each kind in a record.
PerRows<std::int64_t> row_bytes(const AxisSizes& sizes);

/// Bytes of a record prepared for this task.
std::int64_t record_bytes(const Task& task, const PerRows<std::int64_t>& of_a_row);

}  // namespace rodsweep
