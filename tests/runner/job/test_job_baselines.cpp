// Jobs with baselines that need files: nearest neighbours as a guess, a network instead of the solve.
#include <catch2/catch.hpp>

#include "tests/runner/job_folder.hpp"

namespace rodsweep {
namespace test_job_baselines {

Json neighbours(const std::string& parameters) { return with("/guesses", R"(["zero", {"knn": )" + parameters + "}]"); }

Json end_to_end(const std::string& solve) {
  Json job = without("/guesses", with("/solve", solve));
  job["evaluation"] = "closed_loop";
  return job;
}

TEST_CASE("nearest neighbours are named by how many they are, and read from beside the job") {
  const JobFolder folder;
  folder.write("data.h5", "systems");
  const Plan plan(folder.job(neighbours(R"({"data": "data.h5", "simulations": 256})")));
  CHECK(plan.guess_labels().back() == "knn 3");
  const auto found = std::get<guess::Knn>(plan.spec(0).guesses.back().kind);
  CHECK(found.neighbours == 3);
  CHECK(found.simulations == 256);
  CHECK(std::filesystem::equivalent(found.data, folder.path() / "data.h5"));
  const Plan five(folder.job(neighbours(R"({"k": 5, "data": "data.h5"})")));
  CHECK(five.guess_labels().back() == "knn 5");
  CHECK(std::get<guess::Knn>(five.spec(0).guesses.back().kind).simulations == 0);
}

TEST_CASE("a network instead of the solve has a trajectory of its own and no guesses") {
  const JobFolder folder;
  folder.write("net.h5", "weights");
  const Plan plan(folder.job(end_to_end(R"({"method": "end_to_end", "model": "net.h5"})")));
  REQUIRE(plan.size() == 1);
  const TaskSpec spec = plan.spec(0);
  CHECK(spec.solve.method == Method::end_to_end);
  CHECK(std::filesystem::equivalent(spec.solve.model, folder.path() / "net.h5"));
  CHECK(spec.guesses.empty());
  CHECK(spec.own_guess == -1);
}

TEST_CASE("networks, cg and the direct solve stand side by side in one closed loop") {
  const JobFolder folder;
  folder.write("net.h5", "weights");
  Json job = with("/solve", R"({"grid": [{"method": "end_to_end", "model": "net.h5"}, {"method": "direct"}, {}]})");
  job["evaluation"] = "closed_loop";
  const Plan plan(folder.job(job));
  const auto labels = static_cast<std::int64_t>(plan.guess_labels().size());
  REQUIRE(plan.size() == 2 + labels);
  CHECK(plan.spec(0).solve.method == Method::end_to_end);
  CHECK(plan.spec(1).solve.method == Method::direct);
  CHECK(plan.spec(2).solve.method == Method::cg);
}

TEST_CASE("a network instead of the solve is refused without a model, among guesses and in a paired evaluation") {
  const JobFolder folder;
  folder.write("net.h5", "weights");
  const std::string named = R"({"method": "end_to_end", "model": "net.h5"})";
  const auto refused = [&](const Json& job, const std::string& path_value, const std::string& bound) {
    CHECK_THAT(folder.refusal(job), Catch::Contains("job.json: " + path_value) && Catch::Contains(bound));
  };
  refused(end_to_end(R"({"method": {"grid": ["direct", "end_to_end"]}})"), "solve.model: missing", "");
  refused(with("/evaluation", "\"closed_loop\"", with("/solve", named)), "guesses: ", "only solve.method \"cg\"");
  refused(with("/time/integrator", "\"bdf2\"", end_to_end(R"({"method": "state_network", "model": "net.h5"})")),
          "time.integrator: \"bdf2\" is not allowed", "must be \"euler\"");
  refused(with("/evaluation", "\"paired\"", end_to_end(named)), "solve.method: \"end_to_end\" is not allowed",
          "must be used with \"closed_loop\"");
}

}  // namespace test_job_baselines
}  // namespace rodsweep
