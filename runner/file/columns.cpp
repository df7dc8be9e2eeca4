#include "runner/file/columns.hpp"

#include <numeric>
#include <type_traits>
#include <utility>

#include "runner/file/hdf5.hpp"

namespace rodsweep {
namespace {

/// Makes columns with these rows, of a table of the record that a chain of members leads to.
template <class... Table>
auto columns_of(Rows rows, Table... table) {
  return [=](const char* path, auto member, std::vector<Axis> axes, const char* unit, const char* meaning) -> Column {
    const auto cells = [=](TaskRecord & record) -> auto& { return (record.*....*table).*member; };
    using Cells = std::decay_t<decltype(cells(std::declval<TaskRecord&>()))>;
    return {path,
            rows,
            std::move(axes),
            unit,
            meaning,
            hdf5::type_of<typename Cells::value_type>,
            [cells](TaskRecord& record) -> Values { return &cells(record); }};
  };
}

std::vector<Column> all_columns() {
  using R = TaskRecord;
  using Tasks = R::Tasks;
  using Sums = CountSums;
  using Solves = R::Solves;
  using Steps = R::Steps;
  using Trajectories = R::Trajectories;
  using Segments = R::Segments;
  using Joints = R::Joints;
  using Systems = R::Systems;
  using Timing = R::Timing;
  const std::vector<Axis> none, guess{Axis::guess}, ladder{Axis::guess, Axis::tolerance}, xyz{Axis::xyz},
      wxyz{Axis::wxyz}, six{Axis::constraint}, frame{Axis::frame};
  const auto tasks = columns_of(Rows::task, &R::tasks);
  const auto contact_tasks = columns_of(Rows::contact_task, &R::tasks);
  const auto counted = columns_of(Rows::task, &R::tasks, &Tasks::counted);
  const auto counted_all = columns_of(Rows::task, &R::tasks, &Tasks::counted_all);
  const auto counted_other_norm = columns_of(Rows::task, &R::tasks, &Tasks::counted_other_norm);
  const auto solves = columns_of(Rows::solve, &R::solves);
  const auto steps = columns_of(Rows::step, &R::steps);
  const auto contact_steps = columns_of(Rows::contact_step, &R::steps);
  const auto frames = columns_of(Rows::frame_segment, &R::trajectories);
  const auto frame_axis = columns_of(Rows::task, &R::trajectories);
  const auto segments = columns_of(Rows::segment, &R::trajectories, &Trajectories::segments);
  const auto force_steps = columns_of(Rows::force_step, &R::steps);
  const auto frame_joints = columns_of(Rows::frame_joint, &R::trajectories);
  const auto joints = columns_of(Rows::joint, &R::trajectories, &Trajectories::joints);
  using States = Trajectories::States;
  const auto states = columns_of(Rows::state_segment, &R::trajectories, &Trajectories::states);
  const auto state_joints = columns_of(Rows::state_joint, &R::trajectories, &Trajectories::states);
  const auto systems = columns_of(Rows::system, &R::systems);
  const auto system_segments = columns_of(Rows::system_segment, &R::systems);
  const auto balanced_segments = columns_of(Rows::balanced_segment, &R::systems);
  const auto system_joints = columns_of(Rows::system_joint, &R::systems);
  const auto solve_times = columns_of(Rows::solve, &R::timing);
  const auto step_times = columns_of(Rows::step, &R::timing);
  const auto task_times = columns_of(Rows::task, &R::timing);
  return {
      tasks("/tasks/steps_done", &Tasks::steps_done, none, "1", "time steps completed"),
      contact_tasks("/tasks/penetration", &Tasks::penetration, none, "1",
                    "deepest overlap of two bodies after any step, over the smaller radius; NaN without contact"),
      tasks("/tasks/momentum_residual", &Tasks::momentum_residual, none, "1", "largest /steps/momentum_residual"),
      counted("/tasks/iterations_sum", &Sums::iterations, ladder, "1",
              "CG iterations summed over the first Newton iteration of every step; a solve that misses the tolerance "
              "counts all its iterations"),
      counted_all("/tasks/iterations_sum_all", &Sums::iterations, ladder, "1",
                  "CG iterations summed over all Newton iterations"),
      counted_other_norm("/tasks/iterations_sum_other_norm", &Sums::iterations, ladder, "1",
                         "iterations_sum in the other norm: natural if solve.norm is true_residual, and vice versa; -1 "
                         "if record.norms is \"one\""),
      counted("/tasks/matvecs_sum", &Sums::matvecs, ladder, "1",
              "products with A in the solves of iterations_sum: iterations, residuals of nonzero guesses, and products "
              "of the guess itself"),
      counted_all("/tasks/matvecs_sum_all", &Sums::matvecs, ladder, "1", "matvecs_sum over all Newton iterations"),
      counted("/tasks/unreached", &Sums::unreached, ladder, "1", "solves in iterations_sum that missed the tolerance"),
      counted_all("/tasks/unreached_all", &Sums::unreached, ladder, "1",
                  "solves in iterations_sum_all that missed the tolerance"),
      counted_other_norm("/tasks/unreached_other_norm", &Sums::unreached, ladder, "1",
                         "solves in iterations_sum_other_norm that missed the tolerance"),
      counted("/tasks/cg_ratio", &Sums::cg_ratio, ladder, "1",
              "iterations_sum over that of the zero guess; NaN if the task has no zero guess"),
      counted_all("/tasks/cg_ratio_all", &Sums::cg_ratio, ladder, "1",
                  "iterations_sum_all over that of the zero guess"),
      counted_other_norm("/tasks/cg_ratio_other_norm", &Sums::cg_ratio, ladder, "1",
                         "iterations_sum_other_norm over that of the zero guess"),

      solves("/solves/step", &Solves::step, none, "1", "time step, from 0"),
      solves("/solves/newton", &Solves::newton, none, "1", "Newton or Gauss-Seidel iteration within the step, from 0"),
      solves("/solves/rod", &Solves::rod, none, "1", "rod within the scene, from 0"),
      solves("/solves/newton_residual", &Solves::newton_residual, none, "1",
             "max |C + alpha~ lambda| before the solve or the Gauss-Seidel iteration"),
      solves("/solves/joint_gap", &Solves::joint_gap, none, "1",
             "largest distance between the two sides of a joint over the joint length, before the solve"),
      solves("/solves/rhs_norm", &Solves::rhs_norm, none, "1", "2-norm of b"),
      solves("/solves/initial_residual", &Solves::initial_residual, guess, "1",
             "residual of the initial guess relative to the zero guess's, in the job's norm"),
      solves("/solves/final_residual", &Solves::final_residual, guess, "1",
             "||b - A x||_2 / ||b||_2 recomputed after the tight solve"),
      solves("/solves/outcome", &Solves::outcome, guess, "1",
             "outcome of the tight solve: 0 not run, 1 converged, 2 zero right-hand side, 3 iteration limit, 4 "
             "diverged, 5 indefinite, 6 not a number"),
      solves("/solves/start_matvecs", &Solves::start_matvecs, guess, "1",
             "products with A before the first iteration: those of the guess, and one if its residual must be "
             "computed; -1 not run"),
      solves("/solves/renewed", &Solves::renewed, guess, "1",
             "1: the preconditioner or a network's factors were set up for this solve; 0: older ones were used"),
      solves("/solves/iterations", &Solves::iterations, ladder, "1",
             "CG iterations to each tolerance; -1 not reached or not run"),

      steps("/steps/time_s", &Steps::time_s, none, "s", "time at the end of the step"),
      steps("/steps/length_drift", &Steps::length_drift, none, "1",
            "total length through the joint midpoints over its initial value, minus 1"),
      steps("/steps/joint_gap", &Steps::joint_gap, none, "1",
            "largest distance between the two sides of a joint over the joint length"),
      steps("/steps/kinetic_energy_j", &Steps::kinetic_energy_j, none, "J", "kinetic energy, translation and rotation"),
      steps("/steps/potential_energy_j", &Steps::potential_energy_j, none, "J",
            "gravitational energy, zero at the origin"),
      steps("/steps/elastic_energy_j", &Steps::elastic_energy_j, none, "J",
            "energy of bending, twist and, where joints have a stretch stiffness, stretch and shear"),
      steps("/steps/gap_energy_j", &Steps::gap_energy_j, none, "J",
            "what open joints of inextensible rods would release: a residual of the method, no energy of the rods"),
      steps("/steps/momentum_kg_m_s", &Steps::momentum_kg_m_s, xyz, "kg m/s",
            "linear momentum of the dynamic segments"),
      steps("/steps/angular_momentum_kg_m2_s", &Steps::angular_momentum_kg_m2_s, xyz, "kg m^2/s",
            "angular momentum of the dynamic segments about the origin"),
      steps("/steps/newton_iterations", &Steps::newton_iterations, none, "1",
            "Newton (or Gauss-Seidel) iterations used"),
      steps("/steps/cg_iterations", &Steps::cg_iterations, none, "1",
            "CG iterations of the solves that advanced the rods; 0 without CG, or if the reference advanced them"),
      steps("/steps/products", &Steps::products, none, "1", "products with A of these solves and their guesses"),
      steps("/steps/newton_residual", &Steps::newton_residual, none, "1",
            "max |C + alpha~ lambda| at the end of the step"),
      steps("/steps/momentum_residual", &Steps::momentum_residual, none, "1",
            "largest missing force on a segment at the end of the step, relative to the largest force of a joint"),
      contact_steps("/steps/contacts", &Steps::contacts, none, "1",
                    "number of contact candidates in this step; -1 without contact"),
      contact_steps("/steps/penetration", &Steps::penetration, none, "1",
                    "deepest overlap of two bodies after the step, over the smaller radius; NaN without contact"),
      contact_steps("/steps/contact_residual", &Steps::contact_residual, none, "1",
                    "largest remaining correction of a contact after the step, over the smaller radius; below "
                    "contact.tolerance: converged; NaN without contact"),
      force_steps("/steps/clamp_force_n", &Steps::clamp_force_n, xyz, "N",
                  "force of all held segments on the rods, world frame, without their own weight and inertia; of the "
                  "impulse of a step over its time"),
      force_steps("/steps/clamp_moment_nm", &Steps::clamp_moment_nm, xyz, "N m",
                  "moment of all held segments on the rods about the origin"),
      force_steps("/steps/obstacle_force_n", &Steps::obstacle_force_n, xyz, "N", "force of all obstacles on the rods"),

      frames("/trajectories/position_m", &Trajectories::position_m, xyz, "m", "segment centre"),
      frames("/trajectories/orientation", &Trajectories::orientation, wxyz, "1",
             "segment orientation, unit quaternion (w, x, y, z), local z along the rod"),
      frame_axis("/trajectories/first_row", &Trajectories::first_row, frame, "1",
                 "row of the frame's first segment; -1 none"),
      frame_axis("/trajectories/time_s", &Trajectories::time_s, frame, "s", "time of the frame"),
      frame_joints("/trajectories/joint_position_m", &Trajectories::joint_position_m, xyz, "m",
                   "point of the joint, half-way between its two sides"),
      frame_joints("/trajectories/joint_force_n", &Trajectories::joint_force_n, xyz, "N",
                   "force of the joint's second segment on its first, world frame; along the rod: tension is positive; "
                   "NaN in the first frame"),
      frame_joints("/trajectories/joint_moment_nm", &Trajectories::joint_moment_nm, xyz, "N m",
                   "moment of the second segment on the first about the joint's point, world frame; NaN in the first "
                   "frame"),
      segments("/trajectories/segments/length_m", &Segments::length_m, none, "m", "length; 0: a wall"),
      segments("/trajectories/segments/radius_m", &Segments::radius_m, none, "m", "radius; 0: a wall"),
      segments("/trajectories/segments/rod", &Segments::rod, none, "1", "rod within the scene, from 0"),
      segments("/trajectories/segments/static", &Segments::is_static, none, "1", "1: static; 0: free"),
      joints(
          "/trajectories/joints/first", &Joints::first, none, "1",
          "first segment of the joint, from 0 within the frame and within the task's rows of /trajectories/segments"),
      joints("/trajectories/joints/second", &Joints::second, none, "1", "second segment of the joint"),
      states("/trajectories/state/velocity_m_s", &States::velocity_m_s, xyz, "m/s", "velocity of the segment"),
      states("/trajectories/state/angular_velocity_rad_s", &States::angular_velocity_rad_s, xyz, "rad/s",
             "angular velocity of the segment, world frame"),
      states("/trajectories/state/before_position_m", &States::before_position_m, xyz, "m",
             "segment centre a step before; NaN, as the other columns of a step before: the next step does not use it"),
      states("/trajectories/state/before_orientation", &States::before_orientation, wxyz, "1",
             "segment orientation a step before"),
      states("/trajectories/state/before_velocity_m_s", &States::before_velocity_m_s, xyz, "m/s",
             "velocity a step before"),
      states("/trajectories/state/before_angular_velocity_rad_s", &States::before_angular_velocity_rad_s, xyz, "rad/s",
             "angular velocity a step before"),
      state_joints("/trajectories/state/lambda", &States::lambda, six, "kg m^2",
                   "multipliers of the joint after the step"),

      systems("/systems/step", &Systems::step, none, "1",
              "time step, from 0; -1: a Newton iteration that was not needed"),
      systems("/systems/newton", &Systems::newton, none, "1", "Newton iteration within the step, from 0"),
      systems("/systems/rod", &Systems::rod, none, "1", "rod within the scene, from 0"),
      systems("/systems/constraint_dt_s", &Systems::constraint_dt_s, none, "s",
              "time by which A has the compliance over its square: h / sqrt(1 + c h), with the damping c and h the "
              "step, or two thirds of it (bdf2)"),
      system_segments("/systems/segments/position_m", &Systems::position_m, xyz, "m",
                      "segment centre where the system was assembled"),
      system_segments("/systems/segments/orientation", &Systems::orientation, wxyz, "1",
                      "segment orientation there, unit quaternion (w, x, y, z), local z along the rod"),
      system_segments("/systems/segments/velocity_m_s", &Systems::velocity_m_s, xyz, "m/s",
                      "velocity at the start of the step"),
      system_segments("/systems/segments/angular_velocity_rad_s", &Systems::angular_velocity_rad_s, xyz, "rad/s",
                      "angular velocity at the start of the step, world frame"),
      balanced_segments("/systems/segments/free_position_m", &Systems::free_position_m, xyz, "m",
                        "segment centre without joints and contacts, the reference of the momentum balance; NaN if the "
                        "balance is off"),
      balanced_segments("/systems/segments/free_orientation", &Systems::free_orientation, wxyz, "1",
                        "segment orientation there"),
      balanced_segments("/systems/segments/contact_force", &Systems::contact_force, xyz, "kg m",
                        "force of contacts on the segment times the squared constraint time step, world frame (forces "
                        "of point loads are part of free_position_m)"),
      balanced_segments("/systems/segments/contact_torque", &Systems::contact_torque, xyz, "kg m^2",
                        "torque of contacts and of point loads about its centre, times the same"),
      system_joints("/systems/joints/lambda", &Systems::lambda, six, "kg m^2",
                    "Lagrange multipliers before the solve: stretch-shear (3), bend-twist (3), in the joint's frame"),
      system_joints("/systems/joints/solution", &Systems::solution, six, "kg m^2",
                    "increment of the multipliers from the direct solve of A dlambda = b"),

      solve_times("/timing/solves/assemble_s", &Timing::assemble_s, none, "s", "assembly of A and b"),
      solve_times("/timing/solves/direct_s", &Timing::direct_s, none, "s",
                  "factorisation and solve of the same system; NaN if solve.reference is cg"),
      solve_times("/timing/solves/guess_s", &Timing::guess_s, guess, "s",
                  "initial guess: median of solve.timing_repeats, plus its work once per solve"),
      solve_times("/timing/solves/cg_s", &Timing::cg_s, guess, "s",
                  "preconditioner set-up and CG to the job's tolerance; median of solve.timing_repeats"),
      step_times("/timing/steps/solve_s", &Timing::solve_s, none, "s",
                 "assembly, guesses and solves that advanced the rods, with one rest_s the time of the step"),
      step_times("/timing/steps/rest_s", &Timing::rest_s, none, "s", "the step without assembly, guesses and solves"),
      task_times("/timing/tasks/source_task", &Timing::source_task, none, "1",
                 "task of the extended file whose rows were copied; -1: none"),
      // Not times, but of the timed solves: a column in /tasks would change the checksums of all tasks.
      task_times("/timing/tasks/solves_timed", &Timing::solves_timed, guess, "1",
                 "timed solves of the guess; -1: it was not tried"),
      task_times("/timing/tasks/solves_missed", &Timing::solves_missed, guess, "1",
                 "timed solves that missed their tolerance; the task then has no valid times of this guess"),
      task_times("/timing/tasks/solves_with_network", &Timing::solves_with_network, guess, "1",
                 "timed solves for which a network ran, in the guess or the preconditioner's set-up; -1: not tried"),
      task_times("/timing/tasks/elapsed_s", &Timing::elapsed_s, none, "s", "wall time of the task, without writing"),
      task_times("/timing/tasks/steps_processor_s", &Timing::steps_processor_s, none, "s",
                 "processor time of all steps but the first, which sets up solvers; with what is only measured: "
                 "nothing if record.norms is none and record.solves summary"),
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
