// The results of one task in memory, a struct for each table of the file: run_task() fills a TaskRecord, ResultsFile
// writes it. runner/file/columns.hpp describes the columns.
//
// Before the task starts, every column is sized and filled with its sentinel: -1 for counts, NaN for measurements,
// not_run for outcomes. So rows not reached cannot be mistaken for results.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "runner/plan/task.hpp"
#include "runner/plan/task_outcome.hpp"

namespace rodsweep {

class Plan;

/// Sizes of the axes shared by the whole file.
struct AxisSizes {
  std::int64_t guesses = 0, tolerances = 0, frames = 0;
};

AxisSizes axis_sizes(const Plan& plan);

/// The values of a column, row by row: [row, axes ...], with at most two axes.
template <class T>
class Cells : public std::vector<T> {
 public:
  /// One value. Throws std::out_of_range.
  T& operator()(std::size_t row, std::size_t i = 0, std::size_t j = 0) { return this->at(place(row, i, j)); }
  const T& operator()(std::size_t row, std::size_t i = 0, std::size_t j = 0) const {
    return this->at(place(row, i, j));
  }

  /// The values of a row, followed by those of later rows. Throws std::out_of_range.
  T* row(std::size_t row) { return &(*this)(row); }
  const T* row(std::size_t row) const { return &(*this)(row); }

  /// `rows` rows of the axes `extent`, with `value` everywhere. Keeps its memory.
  void reset(std::int64_t rows, const std::vector<std::int64_t>& extent, T value) {
    extent_ = {1, 1};
    std::copy(extent.begin(), extent.end(), extent_.begin());
    this->assign(static_cast<std::size_t>(rows) * extent_[0] * extent_[1], value);
  }

 private:
  std::size_t place(std::size_t row, std::size_t i, std::size_t j) const {
    if (i >= extent_[0] || j >= extent_[1]) throw std::out_of_range("Cells: an index beyond an axis of its column");
    return (row * extent_[0] + i) * extent_[1] + j;
  }

  std::array<std::size_t, 2> extent_{1, 1};  ///< of the axes after the row
};

/// Sums over the solves of a task: [1, guess, tolerance]. Solves that missed the tolerance count all their iterations.
struct CountSums {
  Cells<std::int64_t> iterations, matvecs;
  Cells<std::int32_t> unreached;  ///< solves that missed the tolerance
  Cells<double> cg_ratio;         ///< iterations over the zero guess's; NaN without one
};

struct TaskRecord {
  TaskOutcome outcome = TaskOutcome::pending;
  std::string message;  ///< for outcomes other than ok: the reason and the step; else a warning or nothing

  struct Tasks {  // [1 ...]; state and checksum are ResultsFile's
    Cells<std::int32_t> steps_done;
    Cells<double> penetration, momentum_residual;  ///< the largest of all steps
    CountSums counted, counted_all;                ///< first Newton iterations; all of them
    CountSums counted_other_norm;                  ///< first ones, without matvecs
  } tasks;

  struct Solves {  // [solve ...]
    Cells<std::int32_t> step;
    Cells<std::int16_t> newton, rod;
    Cells<double> newton_residual, joint_gap, rhs_norm;
    Cells<double> initial_residual, final_residual;  ///< [.., guess] relative to ||b||, in the job's norm
    Cells<std::int8_t> outcome;                      ///< [.., guess] SolveOutcome
    Cells<std::int16_t> start_matvecs;               ///< [.., guess]
    Cells<std::int8_t> renewed;                      ///< [.., guess]
    Cells<std::int16_t> iterations;                  ///< [.., guess, tolerance]
  } solves;

  struct Steps {  // [step ...]
    Cells<double> time_s, length_drift, joint_gap, kinetic_energy_j, potential_energy_j, elastic_energy_j, gap_energy_j;
    Cells<double> momentum_kg_m_s, angular_momentum_kg_m2_s;  ///< [.., 3]
    Cells<std::int16_t> newton_iterations;
    Cells<std::int32_t> cg_iterations, products;  ///< of the solves that advanced the rods
    Cells<double> newton_residual, momentum_residual;
    Cells<std::int32_t> contacts;
    Cells<double> penetration, contact_residual;
    Cells<double> clamp_force_n, clamp_moment_nm, obstacle_force_n;  ///< [.., 3]
  } steps;

  struct Segments {  // [segment]
    Cells<double> length_m, radius_m;
    Cells<std::int16_t> rod;
    Cells<std::int8_t> is_static;
  };
  struct Joints {                       // [joint]
    Cells<std::int32_t> first, second;  ///< segments
  };
  struct Trajectories {
    Cells<double> position_m, orientation;  ///< [frame x segment, 3], [frame x segment, 4] (w, x, y, z)
    Cells<std::int64_t> first_row;          ///< [1, frame] row of the frame in /trajectories
    Cells<double> time_s;                   ///< [1, frame]
    Cells<double> joint_position_m, joint_force_n, joint_moment_nm;  ///< [frame x joint, 3]
    Segments segments;
    Joints joints;

    struct States {  // [frame x segment ...]
      Cells<double> velocity_m_s, angular_velocity_rad_s;
      Cells<double> before_position_m, before_orientation, before_velocity_m_s, before_angular_velocity_rad_s;
      Cells<double> lambda;  ///< [frame x joint, 6]
    } states;
  } trajectories;

  /// The linear systems of a data set (runner/dataset/stored_systems.hpp).
  struct Systems {
    Cells<std::int32_t> step;                            ///< [system]
    Cells<std::int16_t> newton, rod;                     ///< [system]
    Cells<double> constraint_dt_s;                       ///< [system]
    Cells<double> position_m, orientation;               ///< [system x segment, 3], [.., 4] (w, x, y, z)
    Cells<double> velocity_m_s, angular_velocity_rad_s;  ///< [system x segment, 3]
    Cells<double> free_position_m, free_orientation;     ///< [balanced segment, 3], [.., 4]
    Cells<double> contact_force, contact_torque;         ///< [balanced segment, 3]
    Cells<double> lambda, solution;                      ///< [system x joint, 6]
  } systems;

  /// Data that may differ between runs of the same job; ResultsFile adds rank, host, run, write_s, tries.
  struct Timing {
    Cells<float> assemble_s, direct_s;  ///< [solve]
    Cells<float> guess_s, cg_s;         ///< [solve, guess]; cg_s includes the preconditioner's setup
    Cells<float> solve_s, rest_s;       ///< [step] assembly, guesses and solves that advanced the rods; all else
    Cells<double> elapsed_s;            ///< [1]
    Cells<double> steps_processor_s;    ///< [1] of all steps
    Cells<std::int32_t> solves_timed, solves_missed, solves_with_network;  ///< [1, guess]
    Cells<std::int64_t> source_task;                                       ///< [1] of an extended sweep
  } timing;

  /// Sizes all columns for this task and fills them with sentinels. Reuses the memory of an earlier task. Can
  /// be interrupted (solver/linear/interruption.hpp).
  void prepare(const Task& task, const AxisSizes& sizes);
};

/// Bytes of a row of each kind in a record.
PerRows<std::int64_t> row_bytes(const AxisSizes& sizes);

/// Bytes of a record prepared for this task.
std::int64_t record_bytes(const Task& task, const PerRows<std::int64_t>& of_a_row);

/// The checksum of a task (/tasks/checksum): its index, outcome and message as stored, then all columns outside /timing
/// in the order of columns(). Empty optional columns are skipped: the file does not have them.
std::uint64_t task_checksum(std::int64_t task, const TaskRecord& record);

}  // namespace rodsweep
