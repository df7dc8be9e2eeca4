#include "runner/job/task_spec.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "runner/job/choice.hpp"
#include "runner/job/key_path.hpp"
#include "runner/job/sweep.hpp"

namespace rodsweep {
namespace {

Method method(const Point& point) {
  static const std::map<std::string, Method> methods{{"cg", Method::cg},
                                                     {"direct", Method::direct},
                                                     {"end_to_end", Method::end_to_end},
                                                     {"pbd", Method::pbd},
                                                     {"xpbd", Method::xpbd}};
  return point.has("solve.method") ? choice(methods, point.text("solve.method")) : Method::direct;
}

int whole_steps(double duration_s, double step_s, const Job& job) {
  constexpr double tolerance = 1e-6;
  constexpr double most = 10000000;
  const double ratio = duration_s / step_s, steps = std::round(ratio);
  if (steps < 1 || std::abs(ratio - steps) > tolerance * steps) {
    const double below = std::max(1.0, std::floor(ratio));
    throw job_error(
        job.path, "time.duration_s",
        fmt::format("{} is not allowed with step_s {}: it is {:.8g} steps; must be a whole number of them, such "
                    "as {:.8g}, or give \"steps\" instead",
                    duration_s, step_s, ratio, below * step_s));
  }
  if (steps > most) {
    throw job_error(job.path, "time.duration_s",
                    fmt::format("{} is not allowed with step_s {}: it is {:.8g} steps, and {} is the most", duration_s,
                                step_s, ratio, most));
  }
  return static_cast<int>(steps);
}

GuessSpec guess_spec(const Point& point, const Job& job, const std::string& path) {
  using Kind = GuessSpec::Kind;
  static const std::map<std::string, Kind> kinds{{"zero", Kind::zero},           {"previous", Kind::previous},
                                                 {"linear", Kind::linear},       {"quadratic", Kind::quadratic},
                                                 {"fischer", Kind::fischer},     {"pod", Kind::pod},
                                                 {"copingnet", Kind::copingnet}, {"knn", Kind::knn},
                                                 {"oracle", Kind::oracle},       {"guarded", Kind::guarded}};
  static const std::map<std::string, OracleGuess::Error> error_kinds{{"white", OracleGuess::Error::white},
                                                                     {"smooth", OracleGuess::Error::smooth}};
  GuessSpec guess;
  const std::string& name = point.text(path);
  guess.kind = choice(kinds, name);
  const std::string parameters = path + "." + name + ".";
  if (guess.kind == Kind::fischer || guess.kind == Kind::pod)
    guess.size = static_cast<int>(point.integer(parameters + "size"));
  if (guess.kind == Kind::copingnet) guess.model = job.files.at(point.text(parameters + "model")).path;
  if (guess.kind == Kind::knn) {
    guess.data = job.files.at(point.text(parameters + "data")).path;
    guess.simulations = static_cast<int>(point.integer(parameters + "simulations"));
    guess.neighbours = static_cast<int>(point.integer(parameters + "k"));
  }
  if (guess.kind == Kind::oracle) {
    guess.error = point.number(parameters + "error");
    guess.error_kind = choice(error_kinds, point.text(parameters + "errors"));
  }
  if (guess.kind == Kind::guarded) {
    guess.threshold = point.number(parameters + "threshold");
    guess.inner.push_back(guess_spec(point, job, parameters + "guess"));
    guess.inner.back().label = guess.inner.back().kind == Kind::guarded ? "guarded" : point.text(parameters + "guess");
  }
  return guess;
}

}  // namespace

TimeSpec time_spec(const Point& point, const Job& job) {
  TimeSpec time;
  time.step_s = point.number("time.step_s");
  time.steps = point.has("time.steps") ? static_cast<int>(point.integer("time.steps"))
                                       : whole_steps(point.number("time.duration_s"), time.step_s, job);
  time.newton_iterations =
      static_cast<int>(point.integer(is_gauss_seidel(method(point)) ? "solve.iterations" : "time.newton_iterations"));
  time.newton_tolerance = point.number("time.newton_tolerance");
  return time;
}

SolveSpec solve_spec(const Point& point, const Job& job) {
  static const std::map<std::string, Norm> norms{{"true_residual", Norm::true_residual}, {"natural", Norm::natural}};
  static const std::map<std::string, Preconditioner> preconditioners{
      {"none", Preconditioner::none},
      {"jacobi", Preconditioner::jacobi},
      {"point_block_jacobi", Preconditioner::point_block_jacobi},
      {"icc", Preconditioner::icc},
      {"cholesky", Preconditioner::cholesky},
      {"lagged_cholesky", Preconditioner::lagged_cholesky}};
  SolveSpec solve;
  solve.method = method(point);
  if (!point.has("solve.method")) return solve;
  solve.preconditioner = choice(preconditioners, point.text("solve.preconditioner"));
  solve.norm = choice(norms, point.text("solve.norm"));
  solve.tolerance = point.number("solve.tolerance");
  solve.max_iterations = static_cast<int>(point.integer("solve.max_iterations"));
  solve.lag_steps = static_cast<int>(point.integer("solve.lag_steps"));
  solve.timing_repeats = static_cast<int>(point.integer("solve.timing_repeats"));
  if (solve.method == Method::end_to_end) {
    if (!point.has("solve.model"))
      throw job_error(job.path, "solve.model", "missing: \"end_to_end\" needs the model file of a train job");
    solve.model = job.files.at(point.text("solve.model")).path;
  }
  if (solve.method == Method::pbd)
    solve.stiffness = {point.number("solve.stretch_stiffness"), point.number("solve.bending_stiffness")};
  return solve;
}

Evaluation evaluation(const Point& point) {
  static const std::map<std::string, Evaluation> evaluations{{"paired", Evaluation::paired},
                                                             {"closed_loop", Evaluation::closed_loop}};
  return point.has("evaluation") ? choice(evaluations, point.text("evaluation")) : Evaluation::paired;
}

RecordSpec record_spec(const Job& job) {
  const auto& record = job.values["record"];
  RecordSpec spec{record["solves"] == "all", record.value("norms", "one") == "both",
                  record["trajectory_every"].get<int>(), RecordedSystems::none};
  if (record.contains("systems"))
    spec.systems = record["systems"] == "all" ? RecordedSystems::all : RecordedSystems::first;
  return spec;
}

std::vector<GuessSpec> guess_specs(const Point& point, const Job& job) {
  std::vector<GuessSpec> guesses;
  const std::vector<std::string> labels = guess_labels(job);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    guesses.push_back(guess_spec(point, job, element("guesses", i)));
    guesses.back().label = labels[i];
  }
  return guesses;
}

std::vector<std::string> guess_labels(const Job& job) {
  std::vector<std::string> labels;
  for (const auto& guess : job.guesses()) labels.push_back(guess_label(guess));
  return labels;
}

void check_method(const Point& point, const Job& job) {
  const Method own = method(point);
  if (own == Method::cg || own == Method::direct || evaluation(point) == Evaluation::closed_loop) return;
  throw job_error(
      job.path, "solve.method",
      fmt::format("\"{}\" is not allowed with evaluation \"paired\", in which the direct solve advances the "
                  "rod: what stands in its place has a trajectory of its own; must be with \"closed_loop\"",
                  point.text("solve.method")));
}

}  // namespace rodsweep
