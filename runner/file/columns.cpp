#include "runner/file/columns.hpp"

#include <functional>
#include <numeric>
#include <type_traits>
#include <utility>

#include "runner/file/hdf5.hpp"

namespace rodsweep {
namespace {

/// The column reached through a chain of member pointers.
template <auto... members>
auto& cells_of(TaskRecord& record) {
  return (record.*....*members);
}

template <auto... members>
Column column(const char* path, Rows rows, std::vector<Axis> axes, const char* unit, const char* meaning) {
  using Made = std::decay_t<decltype(cells_of<members...>(std::declval<TaskRecord&>()))>;
  return {path,
          rows,
          std::move(axes),
          unit,
          meaning,
          hdf5::type_of<typename Made::value_type>,
          [](TaskRecord& record) -> Values { return &cells_of<members...>(record); }};
}

std::vector<Column> all_columns() {
  using R = TaskRecord;
  using Tasks = R::Tasks;
  using Sums = CountSums;
  using Solves = R::Solves;
  using Steps = R::Steps;
  using Trajectories = R::Trajectories;
  using Segments = R::Segments;
  using Systems = R::Systems;
  using Timing = R::Timing;
  const std::vector<Axis> none, guess{Axis::guess}, ladder{Axis::guess, Axis::tolerance}, xyz{Axis::xyz},
      wxyz{Axis::wxyz}, six{Axis::constraint}, frame{Axis::frame};
  return {
      column<&R::tasks, &Tasks::steps_done>("/tasks/steps_done", Rows::task, none, "1", "time steps completed"),
      column<&R::tasks, &Tasks::penetration>(
          "/tasks/penetration", Rows::contact_task, none, "1",
          "deepest overlap of two bodies after any step, over the smaller radius; NaN without contact"),
      column<&R::tasks, &Tasks::momentum_residual>("/tasks/momentum_residual", Rows::task, none, "1",
                                                   "largest /steps/momentum_residual"),
      column<&R::tasks, &Tasks::counted, &Sums::iterations>(
          "/tasks/iterations_sum", Rows::task, ladder, "1",
          "CG iterations summed over the first Newton iteration of every step; a solve that misses the tolerance "
          "counts all its iterations"),
      column<&R::tasks, &Tasks::counted_all, &Sums::iterations>("/tasks/iterations_sum_all", Rows::task, ladder, "1",
                                                                "CG iterations summed over all Newton iterations"),
      column<&R::tasks, &Tasks::counted_other_norm, &Sums::iterations>(
          "/tasks/iterations_sum_other_norm", Rows::task, ladder, "1",
          "iterations_sum in the other norm: natural if solve.norm is true_residual, and vice versa; -1 if "
          "record.norms is \"one\""),
      column<&R::tasks, &Tasks::counted, &Sums::matvecs>(
          "/tasks/matvecs_sum", Rows::task, ladder, "1",
          "products with A in the solves of iterations_sum: iterations, residuals of nonzero guesses, and products of "
          "the guess itself"),
      column<&R::tasks, &Tasks::counted_all, &Sums::matvecs>("/tasks/matvecs_sum_all", Rows::task, ladder, "1",
                                                             "matvecs_sum over all Newton iterations"),
      column<&R::tasks, &Tasks::counted, &Sums::unreached>("/tasks/unreached", Rows::task, ladder, "1",
                                                           "solves in iterations_sum that missed the tolerance"),
      column<&R::tasks, &Tasks::counted_all, &Sums::unreached>(
          "/tasks/unreached_all", Rows::task, ladder, "1", "solves in iterations_sum_all that missed the tolerance"),
      column<&R::tasks, &Tasks::counted_other_norm, &Sums::unreached>(
          "/tasks/unreached_other_norm", Rows::task, ladder, "1",
          "solves in iterations_sum_other_norm that missed the tolerance"),
      column<&R::tasks, &Tasks::counted, &Sums::cg_ratio>(
          "/tasks/cg_ratio", Rows::task, ladder, "1",
          "iterations_sum over that of the zero guess; NaN if the task has no zero guess"),
      column<&R::tasks, &Tasks::counted_all, &Sums::cg_ratio>("/tasks/cg_ratio_all", Rows::task, ladder, "1",
                                                              "iterations_sum_all over that of the zero guess"),
      column<&R::tasks, &Tasks::counted_other_norm, &Sums::cg_ratio>(
          "/tasks/cg_ratio_other_norm", Rows::task, ladder, "1",
          "iterations_sum_other_norm over that of the zero guess"),

      column<&R::solves, &Solves::step>("/solves/step", Rows::solve, none, "1", "time step, from 0"),
      column<&R::solves, &Solves::newton>("/solves/newton", Rows::solve, none, "1",
                                          "Newton or Gauss-Seidel iteration within the step, from 0"),
      column<&R::solves, &Solves::rod>("/solves/rod", Rows::solve, none, "1", "rod within the scene, from 0"),
      column<&R::solves, &Solves::newton_residual>(
          "/solves/newton_residual", Rows::solve, none, "1",
          "max |C + alpha~ lambda| before the solve or the Gauss-Seidel iteration"),
      column<&R::solves, &Solves::joint_gap>(
          "/solves/joint_gap", Rows::solve, none, "1",
          "largest distance between the two sides of a joint over the joint length, before the solve"),
      column<&R::solves, &Solves::rhs_norm>("/solves/rhs_norm", Rows::solve, none, "1", "2-norm of b"),
      column<&R::solves, &Solves::initial_residual>(
          "/solves/initial_residual", Rows::solve, guess, "1",
          "residual of the initial guess relative to the zero guess's, in the job's norm"),
      column<&R::solves, &Solves::final_residual>("/solves/final_residual", Rows::solve, guess, "1",
                                                  "||b - A x||_2 / ||b||_2 recomputed after the tight solve"),
      column<&R::solves, &Solves::outcome>(
          "/solves/outcome", Rows::solve, guess, "1",
          "outcome of the tight solve: 0 not run, 1 converged, 2 zero right-hand side, 3 "
          "iteration limit, 4 diverged, 5 indefinite, 6 not a number"),
      column<&R::solves, &Solves::start_matvecs>("/solves/start_matvecs", Rows::solve, guess, "1",
                                                 "products with A before the first iteration: those of the guess, and "
                                                 "one if its residual must be computed; -1 not run"),
      column<&R::solves, &Solves::renewed>(
          "/solves/renewed", Rows::solve, guess, "1",
          "1: the preconditioner or a network's factors were set up for this solve; 0: older ones were used"),
      column<&R::solves, &Solves::iterations>("/solves/iterations", Rows::solve, ladder, "1",
                                              "CG iterations to each tolerance; -1 not reached or not run"),

      column<&R::steps, &Steps::time_s>("/steps/time_s", Rows::step, none, "s", "time at the end of the step"),
      column<&R::steps, &Steps::length_drift>(
          "/steps/length_drift", Rows::step, none, "1",
          "total length through the joint midpoints over its initial value, minus 1"),
      column<&R::steps, &Steps::joint_gap>("/steps/joint_gap", Rows::step, none, "1",
                                           "largest distance between the two sides of a joint over the joint length"),
      column<&R::steps, &Steps::kinetic_energy_j>("/steps/kinetic_energy_j", Rows::step, none, "J",
                                                  "kinetic energy, translation and rotation"),
      column<&R::steps, &Steps::potential_energy_j>("/steps/potential_energy_j", Rows::step, none, "J",
                                                    "gravitational energy, zero at the origin"),
      column<&R::steps, &Steps::elastic_energy_j>("/steps/elastic_energy_j", Rows::step, none, "J",
                                                  "energy of bending, twist and, where joints have a stretch "
                                                  "stiffness, stretch and shear"),
      column<&R::steps, &Steps::gap_energy_j>(
          "/steps/gap_energy_j", Rows::step, none, "J",
          "what open joints of inextensible rods would release: a residual of the method, no energy of the rods"),
      column<&R::steps, &Steps::momentum_kg_m_s>("/steps/momentum_kg_m_s", Rows::step, xyz, "kg m/s",
                                                 "linear momentum of the dynamic segments"),
      column<&R::steps, &Steps::angular_momentum_kg_m2_s>("/steps/angular_momentum_kg_m2_s", Rows::step, xyz,
                                                          "kg m^2/s",
                                                          "angular momentum of the dynamic segments about the origin"),
      column<&R::steps, &Steps::newton_iterations>("/steps/newton_iterations", Rows::step, none, "1",
                                                   "Newton (or Gauss-Seidel) iterations used"),
      column<&R::steps, &Steps::cg_iterations>(
          "/steps/cg_iterations", Rows::step, none, "1",
          "CG iterations of the solves that advanced the rods; 0 without CG, or if the reference advanced them"),
      column<&R::steps, &Steps::products>("/steps/products", Rows::step, none, "1",
                                          "products with A of these solves and their guesses"),
      column<&R::steps, &Steps::newton_residual>("/steps/newton_residual", Rows::step, none, "1",
                                                 "max |C + alpha~ lambda| at the end of the step"),
      column<&R::steps, &Steps::momentum_residual>(
          "/steps/momentum_residual", Rows::step, none, "1",
          "largest missing force on a segment at the end of the step, relative to the largest force of a joint"),
      column<&R::steps, &Steps::contacts>("/steps/contacts", Rows::contact_step, none, "1",
                                          "number of contact candidates in this step; -1 without contact"),
      column<&R::steps, &Steps::penetration>(
          "/steps/penetration", Rows::contact_step, none, "1",
          "deepest overlap of two bodies after the step, over the smaller radius; NaN without contact"),
      column<&R::steps, &Steps::contact_residual>(
          "/steps/contact_residual", Rows::contact_step, none, "1",
          "largest remaining correction of a contact after the step, over the smaller radius; below contact.tolerance: "
          "converged; NaN without contact"),

      column<&R::trajectories, &Trajectories::position_m>("/trajectories/position_m", Rows::frame_segment, xyz, "m",
                                                          "segment centre"),
      column<&R::trajectories, &Trajectories::orientation>(
          "/trajectories/orientation", Rows::frame_segment, wxyz, "1",
          "segment orientation, unit quaternion (w, x, y, z), local z along the rod"),
      column<&R::trajectories, &Trajectories::first_row>("/trajectories/first_row", Rows::task, frame, "1",
                                                         "row of the frame's first segment; -1 none"),
      column<&R::trajectories, &Trajectories::time_s>("/trajectories/time_s", Rows::task, frame, "s",
                                                      "time of the frame"),
      column<&R::trajectories, &Trajectories::segments, &Segments::length_m>(
          "/trajectories/segments/length_m", Rows::segment, none, "m", "length; 0: a wall"),
      column<&R::trajectories, &Trajectories::segments, &Segments::radius_m>(
          "/trajectories/segments/radius_m", Rows::segment, none, "m", "radius; 0: a wall"),
      column<&R::trajectories, &Trajectories::segments, &Segments::rod>("/trajectories/segments/rod", Rows::segment,
                                                                        none, "1", "rod within the scene, from 0"),
      column<&R::trajectories, &Trajectories::segments, &Segments::is_static>(
          "/trajectories/segments/static", Rows::segment, none, "1", "1: static; 0: free"),

      column<&R::systems, &Systems::step>("/systems/step", Rows::system, none, "1",
                                          "time step, from 0; -1: a Newton iteration that was not needed"),
      column<&R::systems, &Systems::newton>("/systems/newton", Rows::system, none, "1",
                                            "Newton iteration within the step, from 0"),
      column<&R::systems, &Systems::rod>("/systems/rod", Rows::system, none, "1", "rod within the scene, from 0"),
      column<&R::systems, &Systems::constraint_dt_s>(
          "/systems/constraint_dt_s", Rows::system, none, "s",
          "time by which A has the compliance over its square: h / sqrt(1 + c "
          "h), with the damping c and h the step, or two thirds of it (bdf2)"),
      column<&R::systems, &Systems::position_m>("/systems/segments/position_m", Rows::system_segment, xyz, "m",
                                                "segment centre where the system was assembled"),
      column<&R::systems, &Systems::orientation>(
          "/systems/segments/orientation", Rows::system_segment, wxyz, "1",
          "segment orientation there, unit quaternion (w, x, y, z), local z along the rod"),
      column<&R::systems, &Systems::velocity_m_s>("/systems/segments/velocity_m_s", Rows::system_segment, xyz, "m/s",
                                                  "velocity at the start of the step"),
      column<&R::systems, &Systems::angular_velocity_rad_s>("/systems/segments/angular_velocity_rad_s",
                                                            Rows::system_segment, xyz, "rad/s",
                                                            "angular velocity at the start of the step, world frame"),
      column<&R::systems, &Systems::free_position_m>("/systems/segments/free_position_m", Rows::balanced_segment, xyz,
                                                     "m",
                                                     "segment centre without joints and contacts, the reference of the "
                                                     "momentum balance; NaN if the balance is off"),
      column<&R::systems, &Systems::free_orientation>("/systems/segments/free_orientation", Rows::balanced_segment,
                                                      wxyz, "1", "segment orientation there"),
      column<&R::systems, &Systems::contact_force>(
          "/systems/segments/contact_force", Rows::balanced_segment, xyz, "kg m",
          "force of contacts on the segment times the squared constraint time step, world frame (forces of point loads "
          "are part of free_position_m)"),
      column<&R::systems, &Systems::contact_torque>(
          "/systems/segments/contact_torque", Rows::balanced_segment, xyz, "kg m^2",
          "torque of contacts and of point loads about its centre, times the same"),
      column<&R::systems, &Systems::lambda>(
          "/systems/joints/lambda", Rows::system_joint, six, "kg m^2",
          "Lagrange multipliers before the solve: stretch-shear (3), bend-twist (3), in the joint's frame"),
      column<&R::systems, &Systems::solution>("/systems/joints/solution", Rows::system_joint, six, "kg m^2",
                                              "increment of the multipliers from the direct solve of A dlambda = b"),

      column<&R::timing, &Timing::assemble_s>("/timing/solves/assemble_s", Rows::solve, none, "s",
                                              "assembly of A and b"),
      column<&R::timing, &Timing::direct_s>("/timing/solves/direct_s", Rows::solve, none, "s",
                                            "factorisation and solve of the same system; NaN if solve.reference is cg"),
      column<&R::timing, &Timing::guess_s>(
          "/timing/solves/guess_s", Rows::solve, guess, "s",
          "initial guess: median of solve.timing_repeats, plus its work once per solve"),
      column<&R::timing, &Timing::cg_s>(
          "/timing/solves/cg_s", Rows::solve, guess, "s",
          "preconditioner set-up and CG to the job's tolerance; median of solve.timing_repeats"),
      column<&R::timing, &Timing::solve_s>("/timing/steps/solve_s", Rows::step, none, "s",
                                           "assembly, guesses and solves that advanced the rods, with one rest_s the "
                                           "time of the step"),
      column<&R::timing, &Timing::rest_s>("/timing/steps/rest_s", Rows::step, none, "s",
                                          "the step without assembly, guesses and solves"),
      column<&R::timing, &Timing::source_task>("/timing/tasks/source_task", Rows::task, none, "1",
                                               "task of the extended file whose rows were copied; -1: none"),
      // Not times, but of the timed solves: a column in /tasks would change the checksums of all tasks.
      column<&R::timing, &Timing::solves_timed>("/timing/tasks/solves_timed", Rows::task, guess, "1",
                                                "timed solves of the guess; -1: it was not tried"),
      column<&R::timing, &Timing::solves_missed>(
          "/timing/tasks/solves_missed", Rows::task, guess, "1",
          "timed solves that missed their tolerance; the task then has no valid times of this guess"),
      column<&R::timing, &Timing::elapsed_s>("/timing/tasks/elapsed_s", Rows::task, none, "s",
                                             "wall time of the task, without writing"),
  };
}

std::int64_t size_of(Axis axis, const AxisSizes& sizes) {
  switch (axis) {
    case Axis::guess: return sizes.guesses;
    case Axis::tolerance: return sizes.tolerances;
    case Axis::xyz: return 3;
    case Axis::wxyz: return 4;
    case Axis::constraint: return 6;
    case Axis::frame: return sizes.frames;
  }
  return 0;
}

}  // namespace

const std::vector<Column>& columns() {
  static const std::vector<Column> all = all_columns();
  return all;
}

std::vector<std::int64_t> row_extent(const Column& column, const AxisSizes& sizes) {
  std::vector<std::int64_t> extent;
  for (const Axis axis : column.axes) extent.push_back(size_of(axis, sizes));
  return extent;
}

std::int64_t row_width(const Column& column, const AxisSizes& sizes) {
  const std::vector<std::int64_t> extent = row_extent(column, sizes);
  return std::accumulate(extent.begin(), extent.end(), std::int64_t{1}, std::multiplies<>());
}

bool is_timing(const Column& column) { return std::string_view(column.path).substr(0, 8) == "/timing/"; }

char* data_of(const Column& column, TaskRecord& record) {
  return std::visit([](auto* values) { return reinterpret_cast<char*>(values->data()); }, column.values(record));
}

std::string_view bytes_of(const Column& column, const TaskRecord& record) {
  return std::visit(
      [](const auto* values) {
        return std::string_view(reinterpret_cast<const char*>(values->data()),
                                values->size() * sizeof(values->front()));
      },
      column.values(const_cast<TaskRecord&>(record)));  // only pointed into
}

}  // namespace rodsweep
