// The results of one task in memory, and the one description of every per-task dataset: its path, axes, unit and
// meaning. evaluate() fills a TaskRecord, ResultsFile writes it; both the file's creation and its writing walk
// visit_columns(), so adding a quantity to the file is one member and one line here.
//
// Every vector is sized and set to its sentinel (-1 for counts, NaN for measurements, not_run for reasons) before the
// task starts: a reader never mistakes a row that was not reached for a perfect result.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "runner/job/task.hpp"
#include "runner/job/task_outcome.hpp"

namespace rodsweep {

class Plan;

/// Axes after the row: none, guess, tolerance, the three components of a vector, four of a quaternion, the six of a
/// joint's constraint (stretch-shear, then bend-twist), frames of a task.
enum class Axis { guess, tolerance, xyz, wxyz, constraint, frame };

/// Sizes of the axes that the whole file shares.
struct AxisSizes {
  std::int64_t guesses = 0, tolerances = 0, frames = 0;

  std::int64_t size(Axis axis) const;
};

AxisSizes axis_sizes(const Plan& plan);

struct Column {
  const char* path;
  Rows rows;
  std::vector<Axis> axes;
  const char* unit;     ///< "1" for dimensionless
  const char* meaning;  ///< one line
};

/// Values in one row of a column.
std::int64_t row_width(const Column& column, const AxisSizes& sizes);

/// Counts of a task, summed over its solves: [guess, tolerance]. Solves that missed the tolerance count what they used.
struct CountSums {
  std::vector<std::int64_t> iterations, matvecs;
  std::vector<std::int32_t> unreached;  ///< solves that missed the tolerance
  std::vector<double> cg_ratio;         ///< iterations over the zero guess's; NaN without one
};

struct TaskRecord {
  // ---- /tasks [task ...]; state and checksum are ResultsFile's
  TaskOutcome outcome = TaskOutcome::pending;
  std::string message;  ///< for outcomes other than ok: what happened, at which step

  std::vector<std::int32_t> steps_done;     ///< [1]
  std::vector<double> deepest_penetration;  ///< [1]
  CountSums counted, counted_all;           ///< of first Newton iterations; of all
  CountSums counted_other_norm;             ///< of first ones, without matvecs

  // ---- /solves [row ...]
  std::vector<std::int32_t> step;
  std::vector<std::int16_t> newton, rod;
  std::vector<double> newton_residual, solve_joint_gap, rhs_norm;
  std::vector<double> initial_residual, final_residual;  ///< [row, guess] relative to ||b||, in the job's norm
  std::vector<std::int8_t> reason;                       ///< [row, guess] SolveOutcome
  std::vector<std::int16_t> start_matvecs;               ///< [row, guess]
  std::vector<std::int16_t> iterations;                  ///< [row, guess, tolerance]

  // ---- /steps [row ...]
  std::vector<double> time_s, length_drift, joint_gap, kinetic_energy_j, potential_energy_j, elastic_energy_j;
  std::vector<double> momentum_kg_m_s, angular_momentum_kg_m2_s;  ///< [row, 3]
  std::vector<std::int16_t> newton_iterations;
  std::vector<double> step_newton_residual;
  std::vector<std::int32_t> contacts;
  std::vector<double> penetration, contact_residual;

  // ---- /trajectories
  std::vector<double> position_m, orientation;             ///< [frame x segment, 3], [frame x segment, 4] (w, x, y, z)
  std::vector<std::int64_t> first_row;                     ///< [frame] row of the frame in /trajectories
  std::vector<double> frame_time_s;                        ///< [frame]
  std::vector<double> segment_length_m, segment_radius_m;  ///< [segment]
  std::vector<std::int16_t> segment_rod;                   ///< [segment]
  std::vector<std::int8_t> segment_static;                 ///< [segment]

  // ---- /systems: the recorded linear systems of a data set (runner/dataset/system_recording.hpp)
  std::vector<std::int32_t> system_step;                      ///< [system]
  std::vector<std::int16_t> system_newton, system_rod;        ///< [system]
  std::vector<double> system_position_m, system_orientation;  ///< [system x segment, 3], [.., 4] (w, x, y, z)
  std::vector<double> system_velocity_m_s, system_angular_velocity_rad_s;  ///< [system x segment, 3]
  std::vector<double> system_lambda, system_solution;                      ///< [system x joint, 6]

  // ---- /timing: whatever may differ between two runs of the same job; ResultsFile adds rank, host, attempt, write_s
  std::vector<float> assemble_s, direct_s;  ///< [row]
  std::vector<float> guess_s, cg_s;         ///< [row, guess]; cg_s includes the preconditioner's set-up
  std::vector<float> rest_s;                ///< [step row] the step without assembly and solves
  std::vector<double> elapsed_s;            ///< [1]
  std::vector<std::int64_t> source_task;    ///< [1] \ of an extended sweep
  std::vector<std::int8_t> copied_guess;    ///< [guess] /

  /// Sizes everything for this task and sets it to its sentinel. Memory of an earlier task is used again.
  void prepare(const Task& task, const AxisSizes& sizes);
};

/// Calls visit(Column, std::vector<T>& or const&) for every dataset of a record, in file order.
template <class Record, class Visit>
void visit_columns(Record& r, Visit&& visit) {
  using R = Rows;
  using A = Axis;
  const std::vector<Axis> gt{A::guess, A::tolerance}, g{A::guess}, none{}, xyz{A::xyz};

  visit(Column{"/tasks/steps_done", R::task, none, "1", "time steps completed"}, r.steps_done);
  visit(Column{"/tasks/penetration", R::contact_task, none, "1",
               "deepest overlap of two bodies after any step, over the smaller radius; NaN without contact"},
        r.deepest_penetration);
  visit(Column{"/tasks/iterations_sum", R::task, gt, "1",
               "CG iterations summed over the first Newton iteration of every step; solves that missed the tolerance "
               "count what they used"},
        r.counted.iterations);
  visit(Column{"/tasks/iterations_sum_all", R::task, gt, "1", "CG iterations summed over all Newton iterations"},
        r.counted_all.iterations);
  visit(Column{"/tasks/iterations_sum_other_norm", R::task, gt, "1",
               "iterations_sum with the residual test in the norm that the job doesn't use: natural for true_residual, "
               "and the other way round; -1 where record.norms is \"one\""},
        r.counted_other_norm.iterations);
  visit(Column{"/tasks/matvecs_sum", R::task, gt, "1",
               "products with A in the solves of iterations_sum: iterations, residuals of nonzero guesses, and those "
               "that guesses take themselves"},
        r.counted.matvecs);
  visit(Column{"/tasks/matvecs_sum_all", R::task, gt, "1", "matvecs_sum over all Newton iterations"},
        r.counted_all.matvecs);
  visit(Column{"/tasks/unreached", R::task, gt, "1", "solves in iterations_sum that missed the tolerance"},
        r.counted.unreached);
  visit(Column{"/tasks/unreached_all", R::task, gt, "1", "solves in iterations_sum_all that missed the tolerance"},
        r.counted_all.unreached);
  visit(Column{"/tasks/unreached_other_norm", R::task, gt, "1",
               "solves in iterations_sum_other_norm that missed the tolerance"},
        r.counted_other_norm.unreached);
  visit(Column{"/tasks/cg_ratio", R::task, gt, "1",
               "iterations_sum over that of the zero guess; NaN where there is no zero guess in the task"},
        r.counted.cg_ratio);
  visit(Column{"/tasks/cg_ratio_all", R::task, gt, "1", "iterations_sum_all over that of the zero guess"},
        r.counted_all.cg_ratio);
  visit(Column{"/tasks/cg_ratio_other_norm", R::task, gt, "1", "iterations_sum_other_norm over that of the zero guess"},
        r.counted_other_norm.cg_ratio);

  visit(Column{"/solves/step", R::solve, none, "1", "time step, from 0"}, r.step);
  visit(Column{"/solves/newton", R::solve, none, "1", "Newton or Gauss-Seidel iteration within the step, from 0"},
        r.newton);
  visit(Column{"/solves/rod", R::solve, none, "1", "rod within the scene, from 0"}, r.rod);
  visit(Column{"/solves/newton_residual", R::solve, none, "1",
               "max |C + alpha~ lambda| before the solve; of Gauss-Seidel, that met by the iteration"},
        r.newton_residual);
  visit(Column{"/solves/joint_gap", R::solve, none, "1",
               "largest distance between the two sides of a joint over the joint length, before the solve"},
        r.solve_joint_gap);
  visit(Column{"/solves/rhs_norm", R::solve, none, "1", "2-norm of b"}, r.rhs_norm);
  visit(Column{"/solves/initial_residual", R::solve, g, "1",
               "residual of the initial guess relative to the zero guess's, in the job's norm"},
        r.initial_residual);
  visit(Column{"/solves/final_residual", R::solve, g, "1", "||b - A x||_2 / ||b||_2 recomputed after the tight solve"},
        r.final_residual);
  visit(Column{"/solves/reason", R::solve, g, "1",
               "outcome of the tight solve: 0 not run, 1 converged, 2 zero right-hand side, 3 iteration limit, 4 "
               "diverged, 5 indefinite, 6 not a number"},
        r.reason);
  visit(Column{"/solves/start_matvecs", R::solve, g, "1",
               "products with A before the first iteration: those of the guess itself, and one for the residual if it "
               "is nonzero; -1 not run"},
        r.start_matvecs);
  visit(Column{"/solves/iterations", R::solve, gt, "1", "CG iterations to each tolerance; -1 not reached or not run"},
        r.iterations);

  visit(Column{"/steps/time_s", R::step, none, "s", "time at the end of the step"}, r.time_s);
  visit(Column{"/steps/length_drift", R::step, none, "1",
               "total length through the joint midpoints over its initial value, minus 1"},
        r.length_drift);
  visit(Column{"/steps/joint_gap", R::step, none, "1",
               "largest distance between the two sides of a joint over the joint length"},
        r.joint_gap);
  visit(Column{"/steps/kinetic_energy_j", R::step, none, "J", "kinetic energy, translation and rotation"},
        r.kinetic_energy_j);
  visit(Column{"/steps/potential_energy_j", R::step, none, "J", "gravitational energy, zero at the origin"},
        r.potential_energy_j);
  visit(Column{"/steps/elastic_energy_j", R::step, none, "J", "energy stored in the joints"}, r.elastic_energy_j);
  visit(Column{"/steps/momentum_kg_m_s", R::step, xyz, "kg m/s", "linear momentum of the dynamic segments"},
        r.momentum_kg_m_s);
  visit(Column{"/steps/angular_momentum_kg_m2_s", R::step, xyz, "kg m^2/s",
               "angular momentum of the dynamic segments about the origin"},
        r.angular_momentum_kg_m2_s);
  visit(Column{"/steps/newton_iterations", R::step, none, "1", "Newton (or Gauss-Seidel) iterations used"},
        r.newton_iterations);
  visit(Column{"/steps/newton_residual", R::step, none, "1", "max |C + alpha~ lambda| at the end of the step"},
        r.step_newton_residual);
  visit(Column{"/steps/contacts", R::contact_step, none, "1",
               "places where bodies are near each other in this step; -1 without contact"},
        r.contacts);
  visit(Column{"/steps/penetration", R::contact_step, none, "1",
               "deepest overlap of two bodies after the step, over the smaller radius; NaN without contact"},
        r.penetration);
  visit(Column{"/steps/contact_residual", R::contact_step, none, "1",
               "farthest that a contact still wants to move its bodies after the step, over the smaller radius; those "
               "below contact.tolerance have converged; NaN without contact"},
        r.contact_residual);

  visit(Column{"/trajectories/position_m", R::frame_segment, xyz, "m", "segment centre"}, r.position_m);
  visit(Column{"/trajectories/orientation",
               R::frame_segment,
               {A::wxyz},
               "1",
               "segment orientation, unit quaternion (w, x, y, z), local z along the rod"},
        r.orientation);
  visit(Column{"/trajectories/first_row", R::task, {A::frame}, "1", "row of the frame's first segment; -1 none"},
        r.first_row);
  visit(Column{"/trajectories/time_s", R::task, {A::frame}, "s", "time of the frame"}, r.frame_time_s);
  visit(Column{"/trajectories/segments/length_m", R::segment, none, "m", "length; 0: a wall"}, r.segment_length_m);
  visit(Column{"/trajectories/segments/radius_m", R::segment, none, "m", "radius; 0: a wall"}, r.segment_radius_m);
  visit(Column{"/trajectories/segments/rod", R::segment, none, "1", "rod within the scene, from 0"}, r.segment_rod);
  visit(
      Column{"/trajectories/segments/static", R::segment, none, "1", "1: held, as its clamp says; 0: it moves freely"},
      r.segment_static);

  const std::vector<Axis> six{A::constraint};
  visit(Column{"/systems/step", R::system, none, "1", "time step, from 0; -1: a Newton iteration that was not needed"},
        r.system_step);
  visit(Column{"/systems/newton", R::system, none, "1", "Newton iteration within the step, from 0"}, r.system_newton);
  visit(Column{"/systems/rod", R::system, none, "1", "rod within the scene, from 0"}, r.system_rod);
  visit(Column{"/systems/segments/position_m", R::system_segment, xyz, "m",
               "segment centre where the system was assembled"},
        r.system_position_m);
  visit(Column{"/systems/segments/orientation",
               R::system_segment,
               {A::wxyz},
               "1",
               "segment orientation there, unit quaternion (w, x, y, z), local z along the rod"},
        r.system_orientation);
  visit(Column{"/systems/segments/velocity_m_s", R::system_segment, xyz, "m/s", "velocity at the start of the step"},
        r.system_velocity_m_s);
  visit(Column{"/systems/segments/angular_velocity_rad_s", R::system_segment, xyz, "rad/s",
               "angular velocity at the start of the step, world frame"},
        r.system_angular_velocity_rad_s);
  visit(Column{"/systems/joints/lambda", R::system_joint, six, "kg m^2",
               "Lagrange multipliers before the solve: stretch-shear (3), bend-twist (3)"},
        r.system_lambda);
  visit(Column{"/systems/joints/solution", R::system_joint, six, "kg m^2",
               "their increment, which solves A dlambda = b: by the direct solve"},
        r.system_solution);

  visit(Column{"/timing/solves/assemble_s", R::solve, none, "s", "assembly of A and b"}, r.assemble_s);
  visit(
      Column{"/timing/solves/direct_s", R::solve, none, "s", "block LDL^T factorisation and solve of the same system"},
      r.direct_s);
  visit(Column{"/timing/solves/guess_s", R::solve, g, "s", "making the initial guess; median of solve.timing_repeats"},
        r.guess_s);
  visit(Column{"/timing/solves/cg_s", R::solve, g, "s",
               "preconditioner set-up and CG to the job's tolerance; median of solve.timing_repeats"},
        r.cg_s);
  visit(Column{"/timing/steps/rest_s", R::step, none, "s", "the step without assembly, guesses and solves"}, r.rest_s);
  visit(Column{"/timing/tasks/source_task", R::task, none, "1",
               "task of the extended file that its rows, or some guesses' rows, were copied from; -1: none"},
        r.source_task);
  visit(Column{"/timing/tasks/copied_guess", R::task, g, "1",
               "1: the guess's rows and times were copied from source_task; -1: they were not"},
        r.copied_guess);
  visit(Column{"/timing/tasks/elapsed_s", R::task, none, "s", "wall time of the task, without writing"}, r.elapsed_s);
}

}  // namespace rodsweep
