#include <catch2/catch.hpp>
#include <filesystem>

#include "runner/plan/plan.hpp"

using namespace rodsweep;

TEST_CASE("every job file of the project is valid and named like its file") {
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(RODSWEEP_JOBS)) {
    if (entry.path().extension() != ".json" || entry.path().filename() == "schema.json") continue;
    ++files;
    INFO(entry.path());
    const Job job = read_job(entry.path(), MissingFiles::accepted);  // a study may need results of another study
    CHECK(job.name == entry.path().stem());
    if (!is_training(job)) CHECK(Plan(job).size() > 0);
  }
  CHECK(files >= 4);
}

TEST_CASE("the spatial studies run fifty simulations of a hundred steps at every size") {
  for (const char* name : {"/spatial_bending.json", "/spatial_helix.json"}) {
    const Plan plan(read_job(std::string(RODSWEEP_JOBS) + name, MissingFiles::accepted));
    CHECK(plan.job().samples == 50);
    for (const Task& task : plan.tasks()) CHECK(task.steps == 100);
  }
}
