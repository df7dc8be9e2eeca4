// Every key that takes a file: files of its kind are accepted, planned and run, whatever surrounds the key, and no
// others.
#include <fstream>
#include <iterator>

#include "runner/measure/plan_check.hpp"
#include "tests/catch.hpp"
#include "tests/laws/key_places.hpp"
#include "tests/runner/data_set_examples.hpp"

namespace rodsweep::laws {
namespace test_files {

/// Calls `visit` for each key of a file, once for each path.
template <class Visit>
void visit_files(const Visit& visit) {
  std::map<std::string, int> seen;
  visit_keys([&](const KeyPlace& at) {
    if (at.key.text == Key::Text::path && seen[at.path()]++ == 0) visit(at);
  });
  CHECK(seen.size() > 8);
}

/// The job with the value at `around`, an object around the key, in a grid.
Json wrapped(Json job, const std::string& around) {
  Json& value = job[Json::json_pointer(around)];
  value = grid({value, value});
  return job;
}

std::string text_of(const Json& file) { return file.get<std::string>(); }

std::string content(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST_CASE("two files of a key's kind are accepted alone, in sweeps and in swept objects around it") {
  visit_files([](const KeyPlace& at) {
    CAPTURE(at.path());
    const std::vector<Json> files = accepted(at, 2);
    REQUIRE(files.size() == 2);
    for (const char* word : {"grid", "zip"}) CHECK(objection(at.with({{word, files}})) == "");
    for (const Json& file : files) {
      CHECK(objection(at.with("more/../" + file.get<std::string>())) == "");
      for (const std::string& around : at.sweepable) CHECK(objection(wrapped(at.with(file), around)) == "");
    }
  });
}

TEST_CASE("what a task is depends on what its files hold, not on their names") {
  const auto identity = [](const KeyPlace& at, const Json& file) {
    const TaskInputs task = checked_plan(read(at.with(file))).inputs(0);
    return std::pair(task.trajectory, task.guesses);
  };
  visit_files([&](const KeyPlace& at) {
    if (at.job["kind"] == "train") return;
    CAPTURE(at.path());
    const std::vector<Json> files = accepted(at, 2);
    REQUIRE(files.size() == 2);
    const std::filesystem::path folder = inputs().job().parent_path(), copy = folder / ("copy" + text_of(files[0]));
    std::filesystem::create_directories(copy.parent_path());
    std::filesystem::copy_file(folder / text_of(files[0]), copy, std::filesystem::copy_options::overwrite_existing);
    const bool are_equal = content(folder / text_of(files[0])) == content(folder / text_of(files[1]));
    CHECK((identity(at, files[0]) == identity(at, files[1])) == are_equal);
    CHECK(identity(at, files[0]) == identity(at, "copy" + text_of(files[0])));
  });
}

TEST_CASE("a task runs with each of two swept files") {
  visit_files([](const KeyPlace& at) {
    CAPTURE(at.path());
    Json job = at.with(grid(accepted(at, 2)));
    if (at.pointer.rfind("/solve/", 0) == 0 && at.path().find("_preconditioner") != std::string::npos)
      job["solve"]["preconditioner"] = at.path().substr(6, at.path().find("_preconditioner") - 6);
    const Plan plan = checked_plan(read(job));
    REQUIRE(plan.size() >= 2);
    for (const Task& task : plan.tasks()) {
      const TaskRecord record = record_of(plan, task.index);
      INFO(record.message);
      CHECK(record.outcome == TaskOutcome::ok);
    }
  });
}

TEST_CASE("a file of another kind is refused with its key, in sweeps and in swept objects too") {
  visit_files([](const KeyPlace& at) {
    if (at.key.file == FileKind::any) return;
    const Json good = accepted(at, 1).front();
    const auto is_refused = [&](const Json& job) {
      CHECK_THAT(objection(job), Catch::Matchers::StartsWith(inputs().job().native() + ": ") &&
                                     Catch::Matchers::ContainsSubstring(at.key.name));
    };
    for (const auto& [kind, files] : inputs().all()) {
      if (kind == at.key.file) continue;
      const Json bad = files.front();
      CAPTURE(at.path(), bad.dump());
      is_refused(at.with(bad));
      is_refused(at.with(grid({good, bad})));
      for (const std::string& around : at.sweepable) is_refused(wrapped(at.with(bad), around));
    }
  });
}

TEST_CASE("a file under two keys must be of the kind of both") {
  std::vector<KeyPlace> guesses;
  visit_files([&](const KeyPlace& at) {
    if (at.pointer.rfind("/guesses/1/", 0) == 0) guesses.push_back(at);
  });
  const Json::json_pointer guess("/guesses/1");
  for (const KeyPlace& one : guesses)
    for (const KeyPlace& other : guesses) {
      CAPTURE(one.path(), other.path());
      const Json file = accepted(one, 1).front();
      Json job = one.with(file), second = other.with(file)[guess];
      second.front()["label"] = "second";
      job["guesses"].push_back(second);
      job["guesses"].push_back({{"guarded", {{"guess", one.with(file)[guess]}, {"threshold", 1}}}});
      if (other.key.file == one.key.file || other.key.file == FileKind::any)
        CHECK(objection(job) == "");
      else
        CHECK_THAT(objection(job), Catch::Matchers::ContainsSubstring(": guesses[2]." + other.path().substr(11)));
    }
}

}  // namespace test_files
}  // namespace rodsweep::laws
