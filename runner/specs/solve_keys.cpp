#include "runner/specs/solve_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "runner/keys/key_table.hpp"
#include "runner/specs/plugin_keys.hpp"
#include "runner/text/job_error.hpp"

namespace rodsweep {
namespace {

constexpr int gauss_seidel_iterations = 20;

const Words<Method> methods{{"cg", Method::cg},
                            {"direct", Method::direct},
                            {"end_to_end", Method::end_to_end},
                            {"state_network", Method::state_network},
                            {"xpbd", Method::xpbd},
                            {"pbd", Method::pbd}};

Method method(const Point& point) {
  return point.has("solve.method") ? value_of(methods, point.text("solve.method")) : Method::direct;
}

int whole_steps(double duration_s, double step_s, const JobFiles& job) {
  constexpr double tolerance = 1e-6;
  constexpr double most = 10000000;
  const double ratio = duration_s / step_s, steps = std::round(ratio);
  if (steps < 1 || std::abs(ratio - steps) > tolerance * steps) {
    const double below = std::max(1.0, std::floor(ratio));
    throw job_error(job.path, "time.duration_s",
                    "{} is not allowed with step_s {}: it is {:.8g} steps; must be a whole number of steps, such as "
                    "{:.8g}, or give \"steps\" instead",
                    duration_s, step_s, ratio, below * step_s);
  }
  if (steps > most) {
    throw job_error(job.path, "time.duration_s",
                    "{} is not allowed with step_s {}: it is {:.8g} steps; must be at most {}", duration_s, step_s,
                    ratio, most);
  }
  return static_cast<int>(steps);
}

KeyTable<StartSpec> start_keys() {
  return KeyTable<StartSpec>()
      .required(file_key("file", FileKind::results, "results with record.trajectory_every and record.states"),
                &StartSpec::file)
      .optional(integer_key("task", "task of that file, with the same segments and joints").from(0, 2147483647),
                &StartSpec::task)
      .optional(number_key("time_s", "time of a frame").in("s").from(0, 1e9).or_word("last"), &StartSpec::time_s)
      .optional(number_key("clock_s",
                           "time at the start of this simulation, for loads and motions that change; "
                           "\"continued\" is that of the frame")
                    .in("s")
                    .from(-1e9, 1e9)
                    .or_word("continued"),
                &StartSpec::clock_s);
}

KeyTable<Until> until_keys() {
  return KeyTable<Until>().required(
      number_key("rest",
                 "steps with kinetic damping end when no segment lacks more than this part of the largest force")
          .positive(1),
      &Until::rest);
}

KeyTable<TimeSpec> time_keys() {
  constexpr const char* run = "length of the run";
  return KeyTable<TimeSpec>()
      .required(number_key("step_s", "time step")
                    .in("s")
                    .positive(1000)
                    .plausibly(1e-6, 1)
                    .also_called({"dt", "dt_s", "time_step_s"}),
                &TimeSpec::step_s)
      .optional(
          choice_key("integrator",
                     "bdf2: second order; euler: first order, as costly a step, that of Shao et al. 2021, of \"until\" "
                     "and of state_network"),
          Words<Integrator>{{"euler", Integrator::euler}, {"bdf2", Integrator::bdf2}}, &TimeSpec::integrator)
      .required(integer_key("steps", "number of time steps").from(1, 10000000).one_of_group(run), &TimeSpec::steps)
      .unbound(
          number_key("duration_s", "simulated time, a whole number of steps").in("s").positive(1e9).one_of_group(run))
      .optional(integer_key("newton_iterations",
                            "maximum number of Newton iterations per step; xpbd and pbd use solve.iterations")
                    .from(1, 1000),
                &TimeSpec::newton_iterations)
      .optional(
          number_key("newton_tolerance", "Newton iterations of a step end when max |C + alpha~ lambda| is below this")
              .from(0, 1),
          &TimeSpec::newton_tolerance)
      .optional(boolean_key("balance",
                            "true: Newton starts from the last step's multipliers and also balances momentum, so "
                            "equilibria do not depend on the step (methods direct and cg; the others never do); "
                            "false: the step of Shao et al. 2021"),
                &TimeSpec::balance)
      .optional(
          number_key("momentum_tolerance",
                     "with `balance`: allowed momentum residual of a segment, relative to the greatest joint force")
              .positive(1),
          &TimeSpec::momentum_tolerance)
      .optional(object_key("until",
                           "finds an equilibrium: steps of Euler end when forces balance; else \"steps\" is the "
                           "limit. \"steps\": all steps are made")
                    .or_word("steps"),
                until_keys(), &TimeSpec::until);
}

KeyTable<LearnedPreconditioner> learned_preconditioner_keys() {
  return KeyTable<LearnedPreconditioner>().required(
      file_key("model", FileKind::model, "model file of a train job, with the processor \"factors\""),
      &LearnedPreconditioner::model);
}

KeyTable<SolveSpec> solve_keys() {
  const auto stretch = [](SolveSpec& solve) -> double& { return solve.stiffness.stretch; };
  const auto bending = [](SolveSpec& solve) -> double& { return solve.stiffness.bending; };
  return KeyTable<SolveSpec>()
      .optional(
          choice_key(
              "method",
              "cg: conjugate gradients with counted iterations; direct: only the direct solve; in closed loops, "
              "without linear systems: end_to_end: a network's increments; state_network: a network's accelerations, "
              "without constraints; xpbd, pbd: Gauss-Seidel over the joints, with and without compliances"),
          methods, &SolveSpec::method)
      .required(file_key("model", FileKind::model, "model file of a train job")
                    .only({"end_to_end", "state_network"}, "for a model that starts cg use the guess \"copingnet\""),
                &SolveSpec::model)
      .unbound(integer_key("iterations", "maximum number of Gauss-Seidel iterations per step")
                   .from(1, 10000)
                   .defaults_to(gauss_seidel_iterations)
                   .only({"xpbd", "pbd"}, "use max_iterations for cg, time.newton_iterations for Newton"))
      .optional(number_key("stretch_stiffness", "fraction of a stretch or shear that one correction removes")
                    .from(0, 1)
                    .only({"pbd"}, "the moduli and stretch_compliance_per_j of the scene set the stiffness"),
                stretch)
      .optional(number_key("bending_stiffness", "fraction of a bend or twist that one correction removes")
                    .from(0, 1)
                    .only({"pbd"}, "the moduli of the scene set the stiffness"),
                bending)
      .optional(choice_key("preconditioner",
                           "preconditioner of cg. icc: no fill; block_icc: some levels of fill; cholesky: all fill; "
                           "lagged_cholesky: cholesky, reused for some steps; condensed: cg with block_icc on the "
                           "motions of the segments where rods cross, all others eliminated; learned: the factors of "
                           "learned_preconditioner; plugin, python: your own"),
                Words<Preconditioner>{{"none", Preconditioner::none},
                                      {"jacobi", Preconditioner::jacobi},
                                      {"point_block_jacobi", Preconditioner::point_block_jacobi},
                                      {"icc", Preconditioner::icc},
                                      {"block_icc", Preconditioner::block_icc},
                                      {"cholesky", Preconditioner::cholesky},
                                      {"lagged_cholesky", Preconditioner::lagged_cholesky},
                                      {"condensed", Preconditioner::condensed},
                                      {"learned", Preconditioner::learned},
                                      {"plugin", Preconditioner::plugin},
                                      {"python", Preconditioner::python}},
                &SolveSpec::preconditioner)
      .optional(object_key("learned_preconditioner", "the model of the preconditioner \"learned\"").or_word("none"),
                learned_preconditioner_keys(), &SolveSpec::learned)
      .optional(
          object_key("plugin_preconditioner", "the shared library of the preconditioner \"plugin\"").or_word("none"),
          plugin_keys<PluginFile>(), &SolveSpec::plugin)
      .optional(object_key("python_preconditioner", "the Python file of the preconditioner \"python\"").or_word("none"),
                python_keys<PythonFile>(FileKind::python_preconditioner), &SolveSpec::python)
      .optional(integer_key("fill_levels", "block_icc: levels of fill").from(0, 100), &SolveSpec::fill_levels)
      .optional(integer_key("lag_steps",
                            "time steps between set-ups of the preconditioner, from the first Newton iteration's "
                            "matrix; 0: set-up for every system, or 10 with lagged_cholesky")
                    .from(0, 1000000),
                &SolveSpec::lag_steps)
      .optional(choice_key("norm", "residual norm of the stopping test of cg"),
                Words<Norm>{{"true_residual", Norm::true_residual}, {"natural", Norm::natural}}, &SolveSpec::norm)
      .optional(choice_key("reference",
                           "solve that advances the rods in a paired evaluation of cg. direct: the direct solve, timed "
                           "in every evaluation; cg: cg from zero to the tightest tolerance, without any direct solve, "
                           "for large nets and lattices"),
                Words<Reference>{{"direct", Reference::direct}, {"cg", Reference::cg}}, &SolveSpec::reference)
      .optional(number_key("tolerance",
                           "tolerance of the timed solves, relative to ||b||; in a closed loop also of the solves that "
                           "advance the rod")
                    .positive(1),
                &SolveSpec::tolerance)
      .optional(choice_key("forcing",
                           "fixed: every solve to `tolerance`; eisenstat_walker: the first solve of a step to "
                           "`tolerance`, later tolerances follow the convergence of Newton (closed loops)"),
                Words<Forcing>{{"fixed", Forcing::fixed}, {"eisenstat_walker", Forcing::eisenstat_walker}},
                &SolveSpec::forcing)
      .optional(
          integer_key("max_iterations", "limit on cg iterations; 0: ten times the number of unknowns").from(0, 32767),
          &SolveSpec::max_iterations)
      .optional(integer_key("timing_repeats", "repeats of guess and solve; times are medians over them").from(1, 1000),
                &SolveSpec::timing_repeats);
}

}  // namespace

Key start_key() {
  return object_key("start",
                    "starts from a frame of another simulation, with its velocities, instead of the scene's own start",
                    start_keys().keys())
      .or_word("scene")
      .defaults_to("scene");
}

std::optional<StartSpec> start_spec(const Point& point, const JobFiles& job) {
  static const KeyTable<StartSpec> keys = start_keys();
  if (!point.has("start.file")) return std::nullopt;
  StartSpec start;
  keys.fill(start, {point, job, "start"});
  return start;
}

Key time_key() { return object_key("time", "time stepping", time_keys().keys()); }

Key solve_key() {
  return object_key("solve", "solver that moves the rods towards their constraints", solve_keys().keys(), "method")
      .defaults_to(nlohmann::ordered_json::object());
}

TimeSpec time_spec(const Point& point, const JobFiles& job) {
  static const KeyTable<TimeSpec> keys = time_keys();
  TimeSpec time;
  keys.fill(time, {point, job, "time"});
  if (!point.has("time.steps")) time.steps = whole_steps(point.number("time.duration_s"), time.step_s, job);
  if (is_gauss_seidel(method(point))) {  // a swept method has no per-method default
    const bool given = point.has("solve.iterations");
    time.newton_iterations = given ? static_cast<int>(point.number("solve.iterations")) : gauss_seidel_iterations;
  }
  if (time.until || method(point) == Method::state_network) time.integrator = Integrator::euler;
  if (time.until) {
    time.momentum_tolerance = std::min(time.momentum_tolerance, time.until->rest);
  }
  return time;
}

SolveSpec solve_spec(const Point& point, const JobFiles& job) {
  static const KeyTable<SolveSpec> keys = solve_keys();
  SolveSpec solve;
  solve.method = Method::direct;
  keys.fill(solve, {point, job, "solve"});
  if (is_network(solve.method) && solve.model.empty())
    throw job_error(job.path, "solve.model", "missing: \"{}\" needs the model file of a train job",
                    point.text("solve.method"));
  return solve;
}

Evaluation evaluation(const Point& point) {
  const bool closed = point.has("evaluation") && point.text("evaluation") == "closed_loop";
  return closed ? Evaluation::closed_loop : Evaluation::paired;
}

OutputSpec output_spec(const nlohmann::ordered_json& record) {
  const std::string norms = record.value("norms", "one");
  OutputSpec spec{record["solves"] == "all",
                  norms != "none",
                  norms == "both",
                  record["trajectory_every"].get<int>(),
                  StoredSystems::none,
                  record["states"].get<bool>(),
                  record["forces"].get<bool>()};
  if (record.contains("systems")) spec.systems = record["systems"] == "all" ? StoredSystems::all : StoredSystems::first;
  return spec;
}

void check_output(const OutputSpec& output, const Point& point, const JobFiles& job) {
  const Method own = method(point);
  const bool has_multipliers = own != Method::pbd && own != Method::state_network;
  if (point.number("scene.internal_damping_s") != 0 && (!has_multipliers || output.systems != StoredSystems::none))
    throw job_error(job.path, "scene.internal_damping_s", "{:g} is not allowed with {}; must be 0",
                    point.number("scene.internal_damping_s"),
                    has_multipliers
                        ? "kind \"dataset\", whose systems do not have it"
                        : fmt::format("solve.method \"{}\", which has no compliances", point.text("solve.method")));
  if (output.forces && !has_multipliers)
    throw job_error(job.path, "record.forces",
                    "true is not allowed with solve.method \"{}\", which has no multipliers; must be used with another "
                    "method, such as \"direct\"",
                    point.text("solve.method"));
}

/// Checks settings that are not available for CG on motions, which does not solve for multipliers.
static void check_condensed(const Point& point, const std::vector<std::string>& labels, const JobFiles& job) {
  if (method(point) != Method::cg || point.text("solve.preconditioner") != "condensed") return;
  constexpr const char* not_allowed = "not allowed with the preconditioner \"condensed\" (its unknowns are motions)";
  if (point.text("solve.norm") != "true_residual")
    throw job_error(job.path, "solve.norm", "\"{}\" is {}; must be \"true_residual\"", point.text("solve.norm"),
                    not_allowed);
  const std::vector<GuessSpec> guesses = guess_specs(point, labels, job);
  for (std::size_t i = 0; i < guesses.size(); ++i)
    if (const char* name = find_guess<guess::Deflation>(guesses[i]) ? guess::Deflation::name
                           : find_guess<guess::Ritz>(guesses[i])    ? guess::Ritz::name
                                                                    : nullptr)
      throw job_error(job.path, element("guesses", i), "\"{}\" is {}; must be another guess, such as \"subspace\"",
                      name, not_allowed);
}

/// Checks that the file of a preconditioner is given.
static void check_preconditioner(const Point& point, const JobFiles& job) {
  if (method(point) != Method::cg) return;
  const std::string& word = point.text("solve.preconditioner");
  for (const auto& [of, file, what] :
       {std::tuple("learned", "model", "the model of a train job"), std::tuple("plugin", "library", "a shared library"),
        std::tuple("python", "file", "a Python file")}) {
    const std::string key = fmt::format("solve.{}_preconditioner", of);
    if (word == of && !point.has(member(key, file)))
      throw job_error(job.path, key, "missing: the preconditioner \"{}\" needs {}: {{\"{}\": FILE}}", of, what, file);
  }
}

void check_method(const Point& point, const std::vector<std::string>& labels, const JobFiles& job) {
  check_condensed(point, labels, job);
  check_preconditioner(point, job);
  if (evaluation(point) == Evaluation::closed_loop) return;
  if (point.has("solve.forcing") && point.text("solve.forcing") != "fixed")
    throw job_error(job.path, "solve.forcing",
                    "\"{}\" is not allowed with evaluation \"paired\", whose reference solve advances the rod; must be "
                    "used with \"closed_loop\"",
                    point.text("solve.forcing"));
  if (solves_systems(method(point))) return;
  throw job_error(job.path, "solve.method",
                  "\"{}\" is not allowed with evaluation \"paired\", whose direct solve advances the rod; must be used "
                  "with \"closed_loop\"",
                  point.text("solve.method"));
}

}  // namespace rodsweep
