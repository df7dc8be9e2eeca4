// Records of one evaluated task: guesses with a history, solves that miss a tolerance, the motion.
#include <algorithm>
#include <cmath>

#include "tests/catch.hpp"
#include "tests/runner/data_set_examples.hpp"

namespace rodsweep {
namespace test_evaluation_records {

constexpr int steps = 5;
constexpr std::size_t tolerances = 8;

TEST_CASE("a guess with a history starts from the steps before, from the second step on") {
  const TaskRecord r = record_of(five_steps(R"(["zero", "previous"])"));
  int with_history = 0;
  for (const std::size_t row : rows_run(r)) {
    CHECK(r.solves.initial_residual[2 * row] == Approx(1));
    if (r.solves.step[row] == 0) {
      CHECK(r.solves.initial_residual[2 * row + 1] == Approx(1));
      CHECK(r.solves.start_matvecs[2 * row + 1] == 0);
    } else if (r.solves.newton[row] == 0) {
      CHECK(std::abs(r.solves.initial_residual[2 * row + 1] - 1) > 1e-6);
      CHECK(r.solves.start_matvecs[2 * row + 1] == 1);
      ++with_history;
    }
  }
  CHECK(with_history == steps - 1);
}

TEST_CASE("a solve that misses a tolerance counts the iterations that it spent, and as unreached") {
  const TaskRecord r = record_of(five_steps(R"(["zero"])", R"({"preconditioner": "none", "max_iterations": 2})"));
  CHECK(r.outcome == TaskOutcome::ok);  // the direct solve advances the rod
  const auto solves = static_cast<std::int64_t>(rows_run(r).size());
  for (const std::size_t row : rows_run(r)) {
    CHECK(r.solves.outcome[row] == static_cast<std::int8_t>(SolveOutcome::iteration_limit));
    CHECK(r.solves.iterations[row * tolerances + tolerances - 1] == -1);
  }
  CHECK(r.tasks.counted_all.iterations.back() == 2 * solves);
  CHECK(r.tasks.counted_all.unreached.back() == solves);
  CHECK(r.tasks.counted.iterations.back() == 2 * steps);
  CHECK(r.tasks.counted.unreached.back() == steps);
  CHECK(record_of(five_steps(R"(["zero"])")).tasks.counted_all.unreached.back() == 0);
}

TEST_CASE("timed solves that miss the job's tolerance are counted, also where no iterations are") {
  const auto missed = [](double tolerance, const char* norms) {
    Json job = five_steps(R"(["zero", "previous"])", R"({"preconditioner": "none", "max_iterations": 2})");
    job["solve"]["tolerance"] = tolerance;
    job["record"]["norms"] = norms;
    const TaskRecord r = record_of(job);
    CHECK(r.timing.solves_timed[0] > 5);
    CHECK(r.timing.solves_timed[0] == r.timing.solves_timed[1]);
    return r.timing.solves_missed[0];
  };
  CHECK(missed(1e-8, "none") > 5);
  CHECK(missed(1e-8, "one") == missed(1e-8, "none"));
  CHECK(missed(1, "none") == 0);
}

TEST_CASE("a step's effort is that of the solves that advanced it, also if nothing is counted") {
  Json job = five_steps(R"(["zero", "previous"])");
  job["evaluation"] = "closed_loop";
  job["solve"]["tolerance"] = 1e-2;
  constexpr std::size_t to_1e_2 = 1;
  for (const std::int64_t task : {0, 1}) {
    job["record"] = {{"norms", "one"}};
    const TaskRecord counted = record_of(job, task);
    job["record"] = {{"norms", "none"}};
    const TaskRecord timed = record_of(job, task);
    const auto own = static_cast<std::size_t>(task);
    std::vector<std::int32_t> iterations(steps, 0), products(steps, 0);
    for (const std::size_t row : rows_run(counted)) {
      const auto step = static_cast<std::size_t>(counted.solves.step[row]);
      iterations[step] += counted.solves.iterations(row, own, to_1e_2);
      products[step] += counted.solves.iterations(row, own, to_1e_2) + counted.solves.start_matvecs(row, own);
    }
    for (const TaskRecord* record : {&counted, &timed}) {
      CHECK(record->steps.cg_iterations == iterations);
      CHECK(record->steps.products == products);
      for (const float seconds : record->timing.solve_s) CHECK(seconds > 0);
    }
    CHECK(timed.steps.kinetic_energy_j == counted.steps.kinetic_energy_j);
    CHECK(timed.tasks.counted_all.iterations(0, own) == -1);
    CHECK(std::isnan(timed.tasks.counted_all.cg_ratio(0, own)));
  }
  for (const char* norms : {"one", "none"})
    for (const char* solves : {"all", "summary"}) {
      job["record"] = {{"norms", norms}, {"solves", solves}};
      const bool only_timed = norms == std::string("none") && solves == std::string("summary");
      CHECK(plan_of(job).spec(0).solves_directly() == !only_timed);
    }
  const TaskRecord direct = record_of(without("/guesses", with("/solve", R"({"method": "direct"})", five_steps("[]"))));
  for (std::size_t step = 0; step < steps; ++step) {
    CHECK(direct.steps.products[step] == 0);
    CHECK(direct.timing.solve_s[step] > 0);
  }
}

TEST_CASE("a system that is solved to rounding already takes no iteration, and is recorded as such") {
  Json job = five_steps(R"(["zero", "previous"])");
  job["scene"]["gravity_m_s2"] = {0, 0, 0};
  job["time"]["newton_tolerance"] = 0;
  const TaskRecord r = record_of(job);
  CHECK(r.solves.newton[0] == 0);
  for (std::size_t guess = 0; guess < 2; ++guess) {
    CHECK(r.solves.outcome[guess] == static_cast<std::int8_t>(SolveOutcome::zero_rhs));
    CHECK(r.solves.iterations[guess * tolerances + tolerances - 1] == 0);
    CHECK(std::isnan(r.tasks.counted_all.cg_ratio[guess * tolerances]));
  }
}

TEST_CASE("every step tells what its forces lack, and steps that keep the balance lack little") {
  for (const bool balance : {false, true}) {
    Json job = five_steps(R"(["zero", "quadratic"])");
    job["time"]["balance"] = balance;
    job["time"]["momentum_tolerance"] = 1e-5;
    job["time"]["newton_iterations"] = 20;
    const TaskRecord r = record_of(job);
    REQUIRE(r.steps.momentum_residual.size() == steps);
    for (const double lacking : r.steps.momentum_residual) CHECK((lacking < 1e-5) == balance);
    CHECK(r.tasks.momentum_residual[0] ==
          *std::max_element(r.steps.momentum_residual.begin(), r.steps.momentum_residual.end()));
  }
}

TEST_CASE("steps and frames of a falling rod have its times, energies, length and poses") {
  Json job = five_steps(R"(["zero"])");
  job["record"] = {{"trajectory_every", 2}};
  const TaskRecord r = record_of(job);
  CHECK(r.tasks.steps_done[0] == steps);
  for (std::size_t step = 0; step < steps; ++step) {
    CHECK(r.steps.time_s[step] == Approx(0.02 * static_cast<double>(step + 1)));
    CHECK(std::abs(r.steps.length_drift[step]) < 1e-3);
    CHECK(r.steps.kinetic_energy_j[step] > 0);
    CHECK(r.steps.elastic_energy_j[step] > 0);
    CHECK(r.steps.gap_energy_j[step] < 1e-3 * r.steps.elastic_energy_j[step]);
    CHECK(r.steps.potential_energy_j[step] < 0);
    CHECK(r.steps.newton_residual[step] > 0);
    CHECK(r.steps.newton_residual[step] < 1e-9);
    CHECK(r.steps.momentum_kg_m_s[3 * step + 1] < 0);
    CHECK(std::abs(r.steps.momentum_kg_m_s[3 * step + 2]) < 1e-9);
    CHECK(r.steps.angular_momentum_kg_m2_s[3 * step + 2] < 0);
  }
  CHECK(r.trajectories.time_s == std::vector<double>{0, 0.04, 0.08});
  CHECK(r.trajectories.first_row == std::vector<std::int64_t>{0, 10, 20});
  const double half = std::sqrt(0.5);  // local z along x: a quarter turn about y, (w, x, y, z)
  const double along_x[] = {half, 0, half, 0};
  for (std::size_t i = 0; i < 4; ++i) CHECK(r.trajectories.orientation[i] == Approx(along_x[i]).margin(1e-12));
  CHECK(r.trajectories.position_m[3 * 9] == Approx(1.9));  // the last of ten segments of a rod of 2 m
  CHECK(r.trajectories.position_m[3 * 29 + 1] < r.trajectories.position_m[3 * 19 + 1]);
}

TEST_CASE("a recorded trajectory says how long, thick and free its segments are, rod after rod") {
  Json job = five_steps(R"(["zero"])");
  job["scene"]["clamp"] = "wall";
  CHECK(record_of(job).trajectories.segments.radius_m.empty());
  job["record"] = {{"trajectory_every", 2}};
  const TaskRecord r = record_of(job);
  std::vector<double> lengths(11, 0.2), radii(11, 0.05);  // a rod of 2 m, ten segments
  lengths[0] = radii[0] = 0;                              // its wall
  REQUIRE(r.trajectories.segments.length_m.size() == lengths.size());
  for (std::size_t i = 0; i < lengths.size(); ++i)
    CHECK(r.trajectories.segments.length_m[i] == Approx(lengths[i]).margin(1e-15));
  CHECK(r.trajectories.segments.radius_m == radii);
  CHECK(r.trajectories.segments.rod == std::vector<std::int16_t>(11, 0));
  std::vector<std::int8_t> held(11, 0);
  held[0] = 1;
  CHECK(r.trajectories.segments.is_static == held);
}

TEST_CASE("contacts and the deepest penetration are recorded where rods touch, and are not there where they cannot") {
  Json job = five_steps(R"(["zero"])");
  job["scene"] = Json::parse(R"({"type": "falling_rods", "rods": 1, "segments": 4, "length_m": 1, "height_m": 0.11,
                                 "radius_m": 0.05, "density_kg_m3": 1000, "youngs_modulus_pa": 1e6,
                                 "torsion_modulus_pa": 1e6, "contact": {"grid": ["none", {}]}})");
  job["time"]["steps"] = 10;  // falling through 6 cm of air takes 0.11 s
  const TaskRecord none = record_of(job, 0), touching = record_of(job, 1);
  CHECK(none.steps.contacts == std::vector<std::int32_t>(10, -1));
  CHECK(std::isnan(none.steps.penetration.back()));
  CHECK(std::isnan(none.tasks.penetration[0]));
  CHECK(std::isnan(none.steps.contact_residual.back()));
  CHECK(touching.steps.contacts.front() == 0);
  CHECK(touching.steps.penetration.front() == 0);
  CHECK(touching.steps.contacts.back() > 0);
  CHECK(touching.tasks.penetration[0] ==
        *std::max_element(touching.steps.penetration.begin(), touching.steps.penetration.end()));
  CHECK(touching.tasks.penetration[0] < 1e-2);
  CHECK(touching.steps.contact_residual.front() == 0);
  CHECK(touching.steps.contact_residual.back() < 1e-2);
  job["scene"]["contact"] = "none";
  CHECK(record_of(job).steps.contacts.empty());
}

/// A free rod of two segments that a torque turns about an axis.
TaskRecord turned_by(const Json& torque_nm, double youngs_modulus_pa, bool contact = false, double step_s = 0.02) {
  Json job = five_steps(R"(["zero"])");
  job["scene"].update({{"segments", 2},
                       {"clamp", "free"},
                       {"length_m", 1},
                       {"initial_angle_deg", 0},
                       {"gravity_m_s2", {0, 0, 0}},
                       {"youngs_modulus_pa", youngs_modulus_pa},
                       {"torsion_modulus_pa", youngs_modulus_pa},
                       {"tip_torque_nm", torque_nm}});
  job["time"].update({{"step_s", step_s}, {"integrator", "euler"}, {"balance", false}});
  if (contact) job["scene"]["contact"] = Json::object();
  return record_of(job);
}

TEST_CASE("a joint that turns past half a turn is named, and ends a task whose ends are prescribed") {
  const TaskRecord slipped = turned_by({100, 0, 0}, 1e6, false, 0.005);  // it holds GJ / l = 20 Nm
  CHECK(slipped.outcome == TaskOutcome::ok);
  CHECK_THAT(slipped.message, Catch::Matchers::StartsWith("a joint turned past half a turn"));

  Json job = five_steps(R"(["zero"])");
  job["time"].update({{"integrator", "euler"}, {"balance", false}, {"newton_iterations", 6}});
  job["scene"].update({{"segments", 20}, {"clamp", "wall"}, {"youngs_modulus_pa", 1e6}, {"torsion_modulus_pa", 1e6}});
  job["scene"]["tip_motion"] = {{"rotation_deg", {900, 0, 0}}, {"duration_s", 0.05}};  // all in the last joint at first
  const TaskRecord twisted = record_of(job);
  CHECK(twisted.outcome == TaskOutcome::torn);
  CHECK_THAT(twisted.message, Catch::Matchers::ContainsSubstring("of rod 0 turned past half a turn"));
}

TEST_CASE("a task whose segments turn too far in a step says so") {
  CHECK(turned_by({0, 30, 0}, 1e10).message.empty());
  const TaskRecord tumbling = turned_by({0, 600, 0}, 1e10);
  CHECK(tumbling.outcome == TaskOutcome::ok);
  CHECK_THAT(tumbling.message,
             Catch::Matchers::ContainsSubstring(
                 "more than 1 rad across its axis in a step, where its motion is wrong: use a step_s of 0.01"));
  CHECK(turned_by({60, 0, 0}, 1e10).message.empty());  // about its axis
  CHECK_THAT(turned_by({60, 0, 0}, 1e10, true).message,
             Catch::Matchers::ContainsSubstring("more than 7 rad about its axis, in contact, in a step"));
}

TEST_CASE("a task whose rod blows up or is torn ends with what was done") {
  Json wild = five_steps(R"(["zero"])");
  wild["scene"]["tip_force_n"] = {0, 1e12, 0};
  wild["time"].update({{"integrator", "euler"}, {"balance", false}, {"newton_iterations", 1}});
  const TaskRecord blown = record_of(wild);
  CHECK(blown.outcome == TaskOutcome::diverged);
  CHECK_THAT(blown.message, Catch::Matchers::ContainsSubstring("step 0: a joint is open by"));
  CHECK(blown.tasks.steps_done[0] == 1);
  CHECK(std::isnan(blown.steps.time_s[1]));

  Json pulled = wild;
  pulled["scene"]["tip_force_n"] = {0, 1e5, 0};
  const TaskRecord torn = record_of(pulled);
  CHECK(torn.outcome == TaskOutcome::torn);
  CHECK_THAT(torn.message, Catch::Matchers::ContainsSubstring("a joint is open by"));
  CHECK(torn.steps.joint_gap[static_cast<std::size_t>(torn.tasks.steps_done[0] - 1)] > 1);
}

}  // namespace test_evaluation_records
}  // namespace rodsweep
