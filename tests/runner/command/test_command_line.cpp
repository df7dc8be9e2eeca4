// Command lines and their parsed commands, errors and printed command lines.
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "runner/command/commands.hpp"
#include "runner/command/run_command.hpp"
#include "tests/catch.hpp"
#include "tests/runner/file_examples.hpp"

using namespace rodsweep;
using Catch::Matchers::ContainsSubstring;

namespace test_command_line {

Command parse(std::vector<const char*> words) {
  words.insert(words.begin(), "build/rodsweep");
  return parse_command_line(static_cast<int>(words.size()), words.data());
}

PrintedText answer(const std::vector<const char*>& words) { return std::get<PrintedText>(parse(words)); }

TEST_CASE("run takes a job, a file and --resume, and remembers the line for the file") {
  const auto run = std::get<RunOptions>(parse({"run", "my job.json", "-o", "out.h5", "--resume"}));
  CHECK(run.job == "my job.json");
  CHECK(run.output.value() == "out.h5");
  CHECK(run.resume);
  CHECK_FALSE(run.retry_failed);
  CHECK(std::get<RunOptions>(parse({"run", "j.json", "--resume", "--retry-failed"})).retry_failed);
  CHECK(run.program == "build/rodsweep");
  CHECK(run.command == "build/rodsweep run 'my job.json' -o out.h5 --resume");
}

TEST_CASE("without -o a job named demo is written to results/demo.h5") {
  CHECK(output_of(std::get<RunOptions>(parse({"run", "job.json"})), "demo") == "results/demo.h5");
  CHECK(output_of(std::get<RunOptions>(parse({"run", "job.json", "-o", "out.h5"})), "demo") == "out.h5");
}

TEST_CASE("a shard is given by its number, and has a file of its own") {
  const auto run = std::get<RunOptions>(parse({"run", "job.json", "--shard", "3/16"}));
  CHECK((run.shard.value().number == 3 && run.shard.value().of == 16));
  CHECK(output_of(run, "demo") == "results/demo-3of16.h5");
  for (const char* wrong : {"0/4", "5/4", "1/0", "-1/4", "1/4x", "1", "a/b", "", "4294967297/4", "1/4294967297"})
    CHECK_FALSE(shard_of(wrong));
}

TEST_CASE("shards of a sweep have tasks that differ by one at most, and together all") {
  for (const std::int64_t tasks : {0, 1, 7, 16, 100}) {
    std::int64_t sum = 0, most = 0, least = tasks;
    for (int number = 1; number <= 7; ++number) {
      const std::int64_t share = share_of({number, 7}, tasks);
      sum += share, most = std::max(most, share), least = std::min(least, share);
    }
    CHECK(sum == tasks);
    CHECK(most - least <= 1);
  }
}

TEST_CASE("the command that continues a sweep can be typed as it stands") {
  auto run = std::get<RunOptions>(parse({"run", "my job.json"}));
  CHECK(run_line(run, 1) == "build/rodsweep run 'my job.json'");
  run.resume = true;
  run.output = "out.h5";
  const std::string as_root = geteuid() == 0 ? "--allow-run-as-root " : "";  // mpirun refuses root without it
  CHECK(run_line(run, ranks_for(4)) ==
        "mpirun --oversubscribe " + as_root + "-n 5 build/rodsweep run 'my job.json' -o out.h5 --resume");
  run.output = "-x.h5";
  CHECK(run_line(run, 1) == "build/rodsweep run 'my job.json' -o ./-x.h5 --resume");
  run.output = "out.h5";
  run.workers = 4;
  CHECK(run_line(run, ranks_for(4)) == "build/rodsweep run 'my job.json' -n 4 -o out.h5 --resume");
}

TEST_CASE("a program is looked for beside this one, in the source tree, and on the path") {
  const TemporaryFolder folder;
  const auto make = [&](const std::string& name) {
    const std::filesystem::path path = folder / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << "#!/bin/sh\n";
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    return path;
  };
  const std::filesystem::path program = folder / "tree/build/rodsweep";
  const std::string path = (folder / "empty").native() + ":" + (folder / "bin").native();
  CHECK(find_command("long-term", program, path).empty());
  const auto on_path = make("bin/rodsweep-long-term");
  CHECK(find_command("long-term", program, path) == on_path);
  const auto script = make("tree/analysis/long_term.py");
  CHECK(find_command("long-term", program, path) == script);
  const auto beside = make("tree/build/rodsweep-long-term");
  CHECK(find_command("long-term", program, path) == beside);
}

TEST_CASE("mistakes on the command line are answered with exit code 2 and what is wrong") {
  const std::vector<std::pair<std::vector<const char*>, const char*>> mistakes{
      {{}, "Examples:"},
      {{"run"}, "JOB is required"},
      {{"run", "a.json", "--resumee"}, "--resumee"},
      {{"run", "a.json", "--retry-failed"}, "--retry-failed requires --resume"},
      {{"info", "a.h5", "--job", "--json"}, ""},
      {{"rerun", "a.h5"}, "TASK is required"},
      {{"rerun", "a.h5", "first"}, ""},
      {{"rerun", "a.h5", "1", "--trajectory-every", "0"}, ""},
  };
  for (const auto& [words, says] : mistakes) {
    CAPTURE(words);
    CHECK(answer(words).code == ExitCode::user_error);
    CHECK_THAT(answer(words).text, ContainsSubstring(says));
  }
}

}  // namespace test_command_line
