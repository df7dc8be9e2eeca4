// Files that a job names: paths relative to the job, refusals, effect on a task's identity.

#include "tests/catch.hpp"
#include "tests/runner/job_folder.hpp"

namespace rodsweep {
namespace test_input_files {

namespace fs = std::filesystem;

Json learned(const std::string& model) {
  return with("/guesses", R"(["zero", {"copingnet": {"model": ")" + model + R"("}}])");
}

TEST_CASE("a file that cannot be read is refused with key, path and reason") {
  const JobFolder folder;
  CHECK(folder.refusal(learned("models/none.h5")) ==
        (folder.path() / "job.json").native() + ": guesses[1].copingnet.model: \"models/none.h5\" is not allowed: " +
            (folder.path() / "models/none.h5").native() +
            " was not found; the path is relative to the job file's folder");
  folder.write("models/bending.h5", "weights");
  CHECK_THAT(folder.refusal(learned("models/bendin.h5")),
             Catch::Matchers::EndsWith("folder; did you mean \"models/bending.h5\"?"));
  CHECK_THAT(folder.refusal(learned("nowhere/bending.h5")), Catch::Matchers::EndsWith("the job file's folder"));
  CHECK_THAT(folder.refusal(learned("models")), Catch::Matchers::ContainsSubstring("is a folder"));
  CHECK_THAT(folder.refusal(learned("")), Catch::Matchers::ContainsSubstring("must be the path of a file"));
}

TEST_CASE("a file that is missing may come from a job beside, and may be missing in a job that is only looked at") {
  const JobFolder folder;
  folder.write("data.json", "{}");
  CHECK_THAT(
      folder.refusal(learned("../results/data.h5")),
      Catch::Matchers::EndsWith("; if " + (folder.path() / "data.json").native() + " makes it, run that job first"));
  const Job job = parse_job(learned("none.h5").dump(), folder.path() / "job.json", MissingFiles::accepted);
  CHECK(job.files.at("none.h5").hash.empty());
  REQUIRE(missing_files(job).size() == 1);
  CHECK(missing_files(job).front().key_path == "guesses[1].copingnet.model");
  CHECK(missing_files(job_of(small_job())).empty());
}

TEST_CASE("a training misses the data sets that are not there") {
  const JobFolder folder;
  folder.write("here.h5", "data");
  const std::vector<MissingFile> missing =
      missing_files(folder.job(with("/data", R"(["here.h5", "there.h5"])", train_job())));
  REQUIRE(missing.size() == 1);
  CHECK(missing_file_text(folder.path() / "job.json", missing.front()) ==
        (folder.path() / "job.json").native() +
            ": data[1]: \"there.h5\" is not allowed: " + (folder.path() / "there.h5").native() +
            " was not found; the path is relative to the job file's folder; did you mean \"here.h5\"?");
}

TEST_CASE("a job whose files another process has read needs none of them") {
  const JobFolder folder;
  folder.write("a.h5", "weights");
  const Job read = folder.job(learned("a.h5"));
  fs::remove(folder.path() / "a.h5");
  const Job told = parse_job(read.text, read.path, from_bytes(to_bytes(read.files)));
  CHECK(told.files.at("a.h5").hash == read.files.at("a.h5").hash);
  CHECK(told.files.at("a.h5").path == read.files.at("a.h5").path);
  CHECK(Plan(told).inputs(0).guesses == Plan(read).inputs(0).guesses);
}

}  // namespace test_input_files
}  // namespace rodsweep
