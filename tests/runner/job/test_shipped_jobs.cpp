// Every shipped job is valid and plausible; after random changes it is valid or refused in plain words.
#include <filesystem>
#include <fstream>

#include "tests/catch.hpp"
#include "tests/runner/job_mutations.hpp"

using namespace rodsweep;
using Catch::Matchers::ContainsSubstring;

namespace test_shipped_jobs {

namespace fs = std::filesystem;

std::vector<fs::path> shipped_jobs() {
  std::vector<fs::path> jobs;
  for (const auto& entry : fs::recursive_directory_iterator(RODSWEEP_JOBS))
    if (entry.path().extension() == ".json" && entry.path().filename() != "schema.json") jobs.push_back(entry.path());
  std::sort(jobs.begin(), jobs.end());
  return jobs;
}

TEST_CASE("every job of the project is valid, plausible and named like its file") {
  for (const fs::path& path : shipped_jobs()) {
    CAPTURE(path);
    const Job job = read_job(path, MissingFiles::accepted);  // a study may need results of another study
    CHECK(job.name == path.stem());
    if (!is_training(job)) CHECK(Plan(job).size() > 0);
    for (const std::string& warning : job.warnings)
      CHECK_THAT(warning, ContainsSubstring("twisted or spun"));  // on purpose, in studies of the paper's step
  }
}

TEST_CASE("what is wrong with a job is said in plain words with its file and key, and ends nothing") {
  std::mt19937_64 random(19);
  int refused = 0, tried = 0;
  for (const fs::path& path : shipped_jobs()) {
    std::ifstream in(path);
    Json job = Json::parse(in);
    job["samples"] = 2;  // keeps plans short
    for (int i = 0; i < 8; ++i) {
      const std::string text = mutated(job, random).dump();
      INFO(text);
      const std::string refusal = verdict(text, path);
      CHECK(fault_of(refusal, path) == "");
      refused += refusal.empty() ? 0 : 1;
      ++tried;
    }
  }
  CHECK(tried > 300);
  CHECK(refused > tried / 2);
}

TEST_CASE("what is long is not repeated whole") {
  const std::string job = small_job().dump();
  const auto with_long = [&](const std::string& what, const std::string& by) {
    std::string text = job;
    text.replace(text.find(what), what.size(), by);
    return refusal_of_text(text);
  };
  const std::string digits(1 << 20, '1');
  for (const std::string& refusal :
       {with_long("0.05", digits), with_long("0.05", '"' + digits + '"'), with_long("0.05", "0x" + digits),
        with_long("\"radius_m\"", '"' + digits + '"'), with_long("0.05", '-' + digits + 'e' + digits)}) {
    CHECK(refusal.size() > 20);
    CHECK(refusal.size() < 1000);
  }
}

TEST_CASE("a job with more than anyone writes is refused before it takes the memory") {
  std::string keys = "{";
  for (int i = 0; i < 1001; ++i) keys += (i > 0 ? ",\"" : "\"") + std::to_string(i) + "\": 1";
  CHECK_THAT(refusal_of_text(keys + "}"), ContainsSubstring("job.json: 1000: this object has more than 1000 keys"));

  const fs::path path = fs::temp_directory_path() / "rodsweep-large-job.json";
  std::ofstream(path) << std::string(17 << 20, ' ');
  CHECK_THAT(message_of<JobError>([&] { read_job(path); }),
             ContainsSubstring("rodsweep-large-job.json: is too large; must be at most 16 MB") &&
                 ContainsSubstring("samples"));
  fs::remove(path);

  Json many = small_job();
  many["scene"]["segments"] = grid(Json(std::vector<std::string>(100000, "x")));
  const std::string refusal = rodsweep::refusal(many);
  CHECK(std::count(refusal.begin(), refusal.end(), '\n') == 20);
  CHECK_THAT(refusal, ContainsSubstring("and 99980 more"));
}

}  // namespace test_shipped_jobs
