
#include "tests/catch.hpp"
#include "tests/runner/job_examples.hpp"

using namespace rodsweep;

TEST_CASE("absent keys take their defaults") {
  const Job job = job_of(small_job());
  CHECK(job.samples == 1);
  CHECK(job.values["scene"]["gravity_m_s2"] == Json({0, -9.81, 0}));
  CHECK(job.values["guesses"] == Json::parse(R"([{"zero": {"label": "zero"}}, {"previous": {"label": "previous"}}])"));
}

TEST_CASE("every value of a job arrives in the task") {
  Json job = Json::parse(R"({
    "name": "full", "description": "all keys", "kind": "sweep", "seed": 5, "samples": 1, "evaluation": "closed_loop",
    "scene": {"type": "bending_rod", "clamp": "wall", "segments": 12, "length_m": 3, "radius_m": 0.04,
              "density_kg_m3": 900, "youngs_modulus_pa": 2e5, "torsion_modulus_pa": 3e5, "initial_angle_deg": 30,
              "gravity_m_s2": [0, 0, -1.62], "damping_per_s": 0.5, "tip_force_n": [1, 2, 3],
              "stretch_compliance_per_j": 1e-7},
    "time": {"step_s": 0.01, "duration_s": 0.3, "newton_iterations": 4, "newton_tolerance": 1e-6},
    "solve": {"method": "cg", "preconditioner": "point_block_jacobi", "norm": "natural", "tolerance": 1e-3,
              "max_iterations": 500},
    "guesses": ["zero", "previous", "linear", {"quadratic": {"label": "q"}}, {"oracle": {"error": 0.3}},
                {"guarded": {"guess": {"oracle": {"error": 0.2}}, "threshold": 0.7, "label": "careful"}}],
    "record": {"solves": "summary", "trajectory_every": 10}, "task_time_limit_s": 60})");
  const Plan plan = plan_of(job);
  const TaskSpec spec = plan.spec(5);

  const auto& rod = std::get<BendingRod>(spec.scene);
  CHECK(rod.clamp == Clamp::wall);
  CHECK(rod.segments == 12);
  CHECK(rod.length_m == 3);
  CHECK(rod.radius_m == 0.04);
  CHECK(rod.density_kg_m3 == 900);
  CHECK(rod.youngs_modulus_pa == 2e5);
  CHECK(rod.torsion_modulus_pa == 3e5);
  CHECK(rod.initial_angle_deg == 30);
  CHECK(rod.gravity_m_s2 == Vector3(0, 0, -1.62));
  CHECK(rod.damping_per_s == 0.5);
  CHECK(rod.tip_force_n == Vector3(1, 2, 3));
  CHECK(rod.stretch_compliance_per_j == 1e-7);

  CHECK(spec.time.step_s == 0.01);
  CHECK(spec.time.steps == 30);
  CHECK(spec.time.newton_iterations == 4);
  CHECK(spec.time.newton_tolerance == 1e-6);
  CHECK(spec.solve.method == Method::cg);
  CHECK(spec.solve.preconditioner == Preconditioner::point_block_jacobi);
  CHECK(spec.solve.norm == Norm::natural);
  CHECK(spec.solve.tolerance == 1e-3);
  CHECK(spec.solve.max_iterations == 500);
  CHECK(spec.evaluation == Evaluation::closed_loop);
  CHECK(spec.own_guess == 5);
  CHECK_FALSE(spec.output.solves);
  CHECK(spec.output.trajectory_every == 10);
  CHECK(spec.time_limit_s == 60);

  REQUIRE(spec.guesses.size() == 6);
  CHECK(std::holds_alternative<guess::Quadratic>(spec.guesses[3].kind));
  CHECK(std::get<guess::Oracle>(spec.guesses[4].kind).error == 0.3);
  const auto guarded = std::get<guess::Guarded>(spec.guesses[5].kind);
  CHECK(guarded.threshold == 0.7);
  CHECK(std::get<guess::Oracle>(guarded.guess->kind).error == 0.2);
  CHECK(plan.guess_labels() == std::vector<std::string>{"zero", "previous", "linear", "q", "oracle 0.3", "careful"});
}

TEST_CASE("the torsion modulus may be called the shear modulus") {
  const Json job = with("/scene/shear_modulus_pa", "2e5", without("/scene/torsion_modulus_pa"));
  CHECK(rod_parameters(plan_of(job).spec(0).scene).torsion_modulus_pa == 2e5);
}

TEST_CASE("a default label is the guess's name and those of its parameters that are not swept, and of files the name") {
  const Json job =
      with("/guesses", R"(["zero", "oracle", {"oracle": {"error": 0.5, "errors": "smooth"}}, {"oracle": {"error":
      {"grid": [0.1, 0.2]}}}, {"guarded": {"guess": "quadratic", "threshold": 1}}, {"guarded": {"guess": {"oracle": {"error": 2}},
      "threshold": {"grid": [1, 2]}}}, {"knn": {"data": "x.h5"}}, {"knn": {"data": "x.h5", "k": 5}},
      {"copingnet": {"model": "models/bending.h5"}}])");
  CHECK(Plan(parse_job(job.dump(), "job.json", MissingFiles::accepted)).guess_labels() ==
        std::vector<std::string>{"zero", "oracle 0.1", "oracle 0.5 smooth", "oracle", "guarded quadratic 1",
                                 "guarded oracle 2", "knn 3", "knn 5", "copingnet bending"});
}

TEST_CASE("the default label of a guess that varies names all that it can be, if they are few") {
  const Plan plan = plan_of(with("/guesses", R"(["zero", {"grid": ["previous", {"oracle": {"error": 0.5}}]},
      {"zip": [{"guarded": {"guess": "linear", "threshold": {"grid": [1, 2]}}}, {"grid": ["linear", "quadratic"]}]},
      {"grid": ["previous", "linear"], "label": "history"},
      {"grid": [{"oracle": {"error": 0.1}}, {"oracle": {"error": 0.2}}, {"oracle": {"error": 0.3}},
                {"oracle": {"error": 0.4}}, {"oracle": {"error": 0.5}}]}])"));
  CHECK(plan.guess_labels() == std::vector<std::string>{"zero", "previous | oracle 0.5",
                                                        "guarded linear | linear | quadratic", "history",
                                                        "varying guess 4"});
}

TEST_CASE("a whole number may be written as a decimal") {
  const Plan plan = plan_of(with("/scene/segments", "2e1", with("/time/steps", "5.0")));
  CHECK(plan.task(0).segments == 20);
  CHECK(plan.task(0).steps == 5);
}
