#include <algorithm>
#include <cmath>
#include <set>

#include "tests/catch.hpp"
#include "tests/runner/job_examples.hpp"

using namespace rodsweep;

namespace test_plan {

ParameterColumn column(const Plan& plan, const std::string& path) { return find_column(plan, path).value(); }

bool has_column(const Plan& plan, const std::string& path) { return find_column(plan, path).has_value(); }

constexpr auto numbers = values_of<double>;
constexpr auto integers = values_of<std::int64_t>;
constexpr auto texts = values_of<std::string>;

TEST_CASE("grid axes are crossed in the order of the job, the last varying fastest") {
  const Plan plan =
      plan_of(with("/time/steps", R"({"grid": [1, 2, 3]})", with("/scene/segments", R"({"grid": [4, 5]})")));
  CHECK(integers(plan, "scene.segments") == std::vector<std::int64_t>{4, 4, 4, 5, 5, 5});
  CHECK(integers(plan, "time.steps") == std::vector<std::int64_t>{1, 2, 3, 1, 2, 3});
  for (std::int64_t i = 0; i < plan.size(); ++i) {
    CHECK(plan.task(i).index == i);
    CHECK(std::get<BendingRod>(plan.spec(i).scene).segments == plan.task(i).segments);
    CHECK(plan.spec(i).time.steps == plan.task(i).steps);
  }
}

TEST_CASE("zips run in step on one axis, which stands where the first of them does") {
  Json job = with("/scene/segments", R"({"zip": [4, 5]})");
  job["scene"]["radius_m"] = {{"grid", {0.1, 0.2}}};
  job["time"]["steps"] = {{"zip", {40, 50}}};
  const Plan plan = plan_of(job);
  CHECK(integers(plan, "scene.segments") == std::vector<std::int64_t>{4, 4, 5, 5});
  CHECK(integers(plan, "time.steps") == std::vector<std::int64_t>{40, 40, 50, 50});
  CHECK(numbers(plan, "scene.radius_m") == std::vector<double>{0.1, 0.2, 0.1, 0.2});
}

TEST_CASE("draws fill their range evenly and never leave it") {
  Json job = with("/scene/length_m", R"({"uniform": [1, 5]})");
  job["samples"] = 4000;
  job["scene"]["youngs_modulus_pa"] = {{"log_uniform", {1e4, 1e6}}};
  job["scene"]["segments"] = {{"integer", {3, 6}}};
  const Plan plan = plan_of(job);

  const auto quarter = [](const std::vector<double>& values, double from, double to) {
    return std::count_if(values.begin(), values.end(), [&](double v) { return v >= from && v < to; });
  };
  const auto lengths = numbers(plan, "scene.length_m");
  const auto moduli = numbers(plan, "scene.youngs_modulus_pa");
  const auto segments = integers(plan, "scene.segments");
  CHECK(*std::min_element(lengths.begin(), lengths.end()) >= 1);
  CHECK(*std::max_element(lengths.begin(), lengths.end()) <= 5);
  CHECK(*std::min_element(moduli.begin(), moduli.end()) >= 1e4);
  CHECK(*std::max_element(moduli.begin(), moduli.end()) <= 1e6);
  for (int k = 0; k < 4; ++k) {  // expected: 1000 in each, standard deviation 27
    CHECK(std::abs(quarter(lengths, 1 + k, 2 + k) - 1000) < 120);
    CHECK(std::abs(quarter(moduli, std::pow(10, 4 + 0.5 * k), std::pow(10, 4.5 + 0.5 * k)) - 1000) < 120);
    CHECK(std::abs(std::count(segments.begin(), segments.end(), 3 + k) - 1000) < 120);
  }
}

TEST_CASE("whole scenes on a grid keep their own sweeps, and columns are the union of their keys") {
  Json bending = bending_scene(), helix = helix_scene();
  bending["segments"] = grid({10, 20});
  bending["length_m"] = uniform(1, 5);
  helix["windings"] = uniform(2, 3);
  Json job = small_job();
  job["scene"] = grid({bending, helix});
  job["samples"] = 2;
  const Plan plan = plan_of(job);
  CHECK(texts(plan, "scene.type") ==
        std::vector<std::string>{"bending_rod", "bending_rod", "bending_rod", "bending_rod", "helix", "helix"});
  CHECK(integers(plan, "scene.segments") == std::vector<std::int64_t>{10, 10, 20, 20, 45, 45});
  CHECK(std::holds_alternative<Helix>(plan.spec(4).scene));
  const auto windings = numbers(plan, "scene.windings"), lengths = numbers(plan, "scene.length_m");
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(std::isnan(windings[i]) == (i < 4));
    CHECK(std::isnan(lengths[i]) == (i >= 4));
  }
  CHECK(windings[4] == std::get<Helix>(plan.spec(4).scene).windings);
}

TEST_CASE("a zip within a grid value is that value's own") {
  Json a = bending_scene(), b = bending_scene();
  a["segments"] = zip({4, 5});
  a["radius_m"] = zip({0.4, 0.5});
  b["segments"] = zip({6, 7, 8});
  Json job = small_job();
  job["scene"] = grid({a, b});
  job["time"]["steps"] = zip({1, 2});
  const Plan plan = plan_of(job);
  CHECK(integers(plan, "scene.segments") == std::vector<std::int64_t>{4, 4, 5, 5, 6, 6, 7, 7, 8, 8});
  CHECK(integers(plan, "time.steps") == std::vector<std::int64_t>{1, 2, 1, 2, 1, 2, 1, 2, 1, 2});
  CHECK(numbers(plan, "scene.radius_m")[3] == 0.5);
}

TEST_CASE("components of a vector can be swept, and whole vectors too") {
  const Plan plan = plan_of(with("/scene/tip_force_n", R"([0, {"grid": [1, 2]}, 3])"));
  CHECK(std::get<BendingRod>(plan.spec(1).scene).tip_force_n == Vector3(0, 2, 3));
  const ParameterColumn forces = column(plan, "scene.tip_force_n");
  CHECK(forces.width == 3);
  CHECK(forces.unit == "N");
  CHECK(forces.swept);
  CHECK(std::get<ColumnValues<double>>(forces.values).all() == std::vector<double>{0, 1, 3, 0, 2, 3});

  Json random = with("/scene/tip_force_n", R"([{"uniform": [0, 1]}, {"uniform": [0, 1]}, 0])");
  const Vector3 force = std::get<BendingRod>(plan_of(random).spec(0).scene).tip_force_n;
  CHECK(force.x() != force.y());
}

TEST_CASE("a column says whether it varies, in which unit, and what it means") {
  const Plan plan = plan_of(with("/scene/segments", R"({"grid": [4, 5]})"));
  CHECK(column(plan, "scene.segments").swept);
  CHECK_FALSE(column(plan, "scene.length_m").swept);
  CHECK(column(plan, "scene.length_m").unit == "m");
  CHECK(column(plan, "scene.length_m").meaning == "length of the rod or of a tree's trunk");
  CHECK(texts(plan, "solve.preconditioner") == std::vector<std::string>{"jacobi", "jacobi"});
  CHECK(texts(plan, "evaluation") == std::vector<std::string>{"paired", "paired"});
  CHECK_FALSE(has_column(plan, "seed"));
}

TEST_CASE("a word in a column of numbers is NaN, and its change counts as varying") {
  const Plan plan = plan_of(with("/scene/stretch_compliance_per_j", R"({"grid": ["from_stretch", 1e-6]})"));
  const ParameterColumn compliance = column(plan, "scene.stretch_compliance_per_j");
  CHECK(compliance.swept);
  CHECK(std::isnan(std::get<ColumnValues<double>>(compliance.values).all()[0]));
  CHECK(std::get<ColumnValues<double>>(compliance.values).all()[1] == 1e-6);
}

TEST_CASE("an object that is swept against a word has a column that says which it is, and by what it differs") {
  const auto contact = [](const std::string& value) { return plan_of(with("/scene/contact", value)); };
  const Plan plan = contact(R"({"grid": ["none", {"friction": 0.3}, {"sweeps": 9, "friction": 0.6}]})");
  CHECK(column(plan, "scene.contact").swept);
  CHECK(texts(plan, "scene.contact") == std::vector<std::string>{"none", "friction 0.3", "friction 0.6, sweeps 9"});
  CHECK(texts(contact(R"({"grid": ["none", {"friction": {"grid": [0.3, 0.6]}, "sweeps": 9}]})"), "scene.contact") ==
        std::vector<std::string>{"none", "sweeps 9", "sweeps 9"});
  CHECK_FALSE(has_column(contact("{}"), "scene.contact"));
  CHECK_FALSE(has_column(contact(R"({"friction": {"grid": [0.3, 0.6]}})"), "scene.contact"));
  CHECK(texts(plan.single_task(1, 0), "scene.contact") == std::vector<std::string>{"friction 0.3"});

  const Plan wind = plan_of(with("/scene/wind", R"({"grid": [{"mean_m_s": [8, 0, 0], "turbulence_m_s": 2}, "none"]})"));
  CHECK(texts(wind, "scene.wind") == std::vector<std::string>{"mean_m_s [8,0,0], turbulence_m_s 2", "none"});

  CHECK(contact("{}").inputs(0).trajectory == plan.inputs(1).trajectory);
}

TEST_CASE("a duration becomes whole steps, in the tasks and in a column") {
  Json job = with("/time/duration_s", "0.6", without("/time/steps"));
  job["time"]["step_s"] = grid({0.01, 0.02, 0.03});
  const Plan plan = plan_of(job);
  CHECK(integers(plan, "time.steps") == std::vector<std::int64_t>{60, 30, 20});
  CHECK(column(plan, "time.steps").swept);
  CHECK(plan.spec(2).time.steps == 20);
  CHECK(plan.task(1).rows[Rows::step].first == 60);
  CHECK(plan.rows(Rows::step) == 110);
}

TEST_CASE("a closed loop with cg runs a task for every guess, on the same draws") {
  Json job = with("/evaluation", "\"closed_loop\"", with("/scene/length_m", R"({"uniform": [1, 5]})"));
  job["samples"] = 2;
  const Plan plan = plan_of(job);
  REQUIRE(plan.size() == 4);
  for (std::int64_t i = 0; i < 4; ++i) {
    CHECK(plan.task(i).own_guess == i % 2);
    CHECK(plan.spec(i).own_guess == i % 2);
    CHECK(plan.task(i).point == i / 2);
    CHECK(plan.task(i).sample == i / 2);
    CHECK(plan.spec(i).guesses.size() == 2);
  }
  const auto lengths = numbers(plan, "scene.length_m");
  CHECK(lengths[0] == lengths[1]);
  CHECK(lengths[0] != lengths[2]);
  CHECK(plan.spec(0).seed == plan.spec(1).seed);
  CHECK(plan.spec(0).seed != plan.spec(2).seed);
}

TEST_CASE("a whole guess is swept, and columns say which one each task had, with its parameters") {
  const Plan plan = plan_of(with("/guesses", R"(["zero", {"oracle": {"error": 0.7}},
      {"grid": ["previous", {"oracle": {"error": 0.1}},
                {"guarded": {"guess": "linear", "threshold": {"grid": [1, 2]}}}]}])"));
  const std::vector<GuessKind> kinds{guess::Previous{}, guess::Oracle{}, guess::Guarded{}, guess::Guarded{}};
  REQUIRE(plan.size() == 4);
  for (std::int64_t i = 0; i < 4; ++i) {
    const auto guesses = plan.spec(i).guesses;
    REQUIRE(guesses.size() == 3);
    CHECK(guesses[2].kind.index() == kinds[static_cast<std::size_t>(i)].index());
    CHECK(std::get<guess::Oracle>(guesses[1].kind).error == 0.7);
  }
  CHECK(std::get<guess::Oracle>(plan.spec(1).guesses[2].kind).error == 0.1);
  const TaskSpec last = plan.spec(3);
  CHECK(std::get<guess::Guarded>(last.guesses[2].kind).threshold == 2);
  CHECK(find_guess<guess::Linear>(last.guesses[2]) != nullptr);
  CHECK(texts(plan, "guesses[2]") == std::vector<std::string>{"previous", "oracle", "guarded", "guarded"});
  CHECK(column(plan, "guesses[2]").swept);
  const auto errors = numbers(plan, "guesses[2].oracle.error"),
             thresholds = numbers(plan, "guesses[2].guarded.threshold");
  CHECK(std::isnan(errors[0]));
  CHECK(errors[1] == 0.1);
  CHECK(std::isnan(errors[2]));
  CHECK(std::isnan(thresholds[1]));
  CHECK(thresholds[2] == 1);
  CHECK(thresholds[3] == 2);
  CHECK(texts(plan, "guesses[2].guarded.guess") == std::vector<std::string>{"", "", "linear", "linear"});
  CHECK_FALSE(has_column(plan, "guesses[1].oracle.error"));  // 0.7 in all tasks, so it is in the label
}

TEST_CASE("rows of every kind follow one another without gaps") {
  Json sweep = with("/scene/segments", R"({"grid": [4, 6]})", with("/scene/clamp", "\"wall\""));
  sweep["time"] = {{"step_s", 0.02}, {"steps", grid({10, 25})}, {"newton_iterations", 3}};
  sweep["record"] = {{"trajectory_every", 10}};
  Json data = without("/guesses", sweep);
  data["kind"] = "dataset";
  data["record"] = {{"systems", "all"}};
  for (const Json& job : {sweep, data}) {
    const bool is_data = job["kind"] == "dataset";
    const Plan plan = plan_of(job);
    CHECK(plan.task(0).segments == 5);  // a wall adds its static segment
    PerRows<std::int64_t> counted{};
    for (const Task& task : plan.tasks()) {
      CHECK(task.joints == task.segments - 1);
      CHECK(task.frames == (is_data ? 0 : task.steps == 10 ? 2 : 3));  // includes the initial state
      const std::int64_t solves = 3 * task.steps, systems = is_data ? solves : 0;
      CHECK(task.cost == static_cast<double>(task.segments * solves));
      const std::pair<Rows, std::int64_t> counts[] = {{Rows::task, 1},
                                                      {Rows::step, task.steps},
                                                      {Rows::solve, solves},
                                                      {Rows::frame_segment, task.frames * task.segments},
                                                      {Rows::segment, is_data ? 0 : task.segments},
                                                      {Rows::system, systems},
                                                      {Rows::system_segment, systems * task.segments},
                                                      {Rows::balanced_segment, systems * task.segments},
                                                      {Rows::system_joint, systems * task.joints}};
      for (const auto& [kind, count] : counts) {
        CHECK(task.rows[kind].count == count);
        CHECK(task.rows[kind].first == counted[kind]);
        counted[kind] += count;
      }
    }
    for (std::size_t kind = 0; kind < row_kinds; ++kind) CHECK(plan.rows(static_cast<Rows>(kind)) == counted[kind]);
    CHECK(plan.max_frames() == (is_data ? 0 : 3));
  }

  const Plan summary = plan_of(with("/record", R"({"solves": "summary"})", sweep));
  for (const Rows kind : {Rows::solve, Rows::frame_segment, Rows::segment}) CHECK(summary.rows(kind) == 0);
  CHECK(plan_of(with("/record", R"({"systems": "first"})", data)).task(0).rows[Rows::system].count == 10);
}

TEST_CASE("rows are counted with the last task's, and with those of a task that overflow") {
  Json job = small_job();  // 1000 rods x 10^7 steps x 1000 iterations: 10^13 rows of solves per task
  job["scene"] = Json::parse(
      R"({"type": "falling_rods", "rods": 1000, "segments": 500, "length_m": 1, "height_m": 0.3, "turn_deg": 70,
          "radius_m": {"uniform": [0.004, 0.005]}, "density_kg_m3": 1000, "youngs_modulus_pa": 1e6,
          "torsion_modulus_pa": 1e6})");
  job["time"] = {{"step_s", 0.02}, {"steps", 10000000}, {"newton_iterations", 1000}};
  job["samples"] = 100;
  CHECK(plan_of(job).rows(Rows::solve) == 1000000000000000);
  const std::string too_large = "job.json: this job is too large: more than 1000000 tasks or 1000000000000000 rows";
  CHECK(refusal(with("/samples", "101", job)) == too_large);

  // 10^7 frames of 5 x 10^5 segments
  job["record"] = {{"solves", "summary"}, {"trajectory_every", 1}};
  CHECK(plan_of(job).rows(Rows::frame_segment) == 100 * 10000001 * std::int64_t{500000});
  job["samples"] = 200;
  CHECK(refusal(job) == too_large);
}

TEST_CASE("a hundred thousand tasks expand") {
  Json job = with("/scene/length_m", R"({"uniform": [1, 5]})", with("/scene/segments", R"({"grid": [4, 5, 6, 7]})"));
  job["samples"] = 25000;
  const Plan plan = plan_of(job);
  REQUIRE(plan.size() == 100000);
  CHECK(plan.rows(Rows::step) == 1000000);
  CHECK(plan.task(99999).segments == 7);
  CHECK(std::get<BendingRod>(plan.spec(99999).scene).length_m == std::get<BendingRod>(plan.spec(24999).scene).length_m);
}

TEST_CASE("a task alone keeps its point, sample, guess, values and seed, and has its rows to itself") {
  Json job = small_job();
  job["samples"] = 3;
  job["seed"] = 5;
  job["evaluation"] = "closed_loop";
  job["scene"]["length_m"] = uniform(1, 5);
  job["scene"]["segments"] = grid({4, 6});
  job["guesses"] = Json::parse(R"(["zero", {"oracle": {"error": {"grid": [0.1, 0.2]}}}])");
  const Plan whole = plan_of(job);
  const Plan one = whole.single_task(11, 4);
  REQUIRE(one.size() == 1);
  CHECK(one.task_alone() == 11);
  const Task &there = whole.task(11), &here = one.task(0);
  CHECK(here.index == 0);
  for (const RowRange& rows : here.rows) CHECK(rows.first == 0);
  CHECK((here.point == there.point && here.sample == there.sample && here.own_guess == there.own_guess));
  CHECK((here.steps == there.steps && here.rows[Rows::solve].count == there.rows[Rows::solve].count &&
         here.segments == there.segments));
  CHECK(here.frames == 1 + 10 / 4);
  CHECK((one.rows(Rows::step) == 10 && one.rows(Rows::frame_segment) == here.frames * here.segments));
  CHECK(one.rows(Rows::segment) == here.segments);
  const TaskSpec a = whole.spec(11), b = one.spec(0);
  CHECK(b.seed == a.seed);
  CHECK(b.output.trajectory_every == 4);
  CHECK(std::get<BendingRod>(b.scene).length_m == std::get<BendingRod>(a.scene).length_m);
  CHECK(std::get<guess::Oracle>(b.guesses[1].kind).error == std::get<guess::Oracle>(a.guesses[1].kind).error);
  CHECK(one.job().text == whole.job().text);
}

TEST_CASE("a task alone has the columns of the whole plan, also of guesses that vary there") {
  Json job = small_job();
  job["guesses"] = Json::parse(R"(["zero", {"oracle": {"error": {"grid": [0.1, 0.2]}}}])");
  const Plan whole = plan_of(job);
  const auto columns = whole.parameters(), alone = whole.single_task(1, 1).parameters();
  CHECK(std::equal(columns.begin(), columns.end(), alone.begin(), alone.end(),
                   [](const ParameterColumn& a, const ParameterColumn& b) { return a.path == b.path; }));
}

}  // namespace test_plan
