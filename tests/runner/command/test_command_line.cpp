// What the user types, and what the program makes of it.
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>

#include "runner/command/command_line.hpp"
#include "runner/command/manual.hpp"
#include "runner/command/next_line.hpp"

using namespace rodsweep;
using Catch::Matchers::Contains;
using Catch::Matchers::Matches;

namespace {

Command parse(std::vector<const char*> words) {
  words.insert(words.begin(), "build/rodsweep");
  return parse_command_line(static_cast<int>(words.size()), words.data());
}

Answer answer(const std::vector<const char*>& words) { return std::get<Answer>(parse(words)); }

}  // namespace

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

TEST_CASE("a shard is told by its number, and known again by the line that the file remembers") {
  const auto shard = [](const std::string& text) {
    const auto run = std::get<RunOptions>(parse({"run", "job.json", text.c_str()}));
    return std::pair(run.shard.value().number, shard_of_command(run.command).value().number);
  };
  CHECK(shard("--shard=3/16") == std::pair(3, 3));
  CHECK(output_of(std::get<RunOptions>(parse({"run", "job.json", "--shard", "3/16"})), "demo") ==
        "results/demo-3of16.h5");
  CHECK(shard_of_command("rodsweep run a.json --shard 2/4 --resume").value().of == 4);
  for (const char* none : {"rodsweep run a.json", "rodsweep run a.json --shard", "rodsweep run a.json --shards 1/2"})
    CHECK_FALSE(shard_of_command(none));
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
}

TEST_CASE("the other commands take their options") {
  CHECK(std::get<PlanOptions>(parse({"plan", "a.json"})).probe);
  CHECK_FALSE(std::get<PlanOptions>(parse({"plan", "a.json", "--no-probe"})).probe);
  CHECK(std::get<PlanOptions>(parse({"plan", "a.json", "--json"})).json);
  CHECK(std::get<ValidateOptions>(parse({"validate", "a.json", "b.json"})).jobs.size() == 2);
  CHECK(std::get<ValidateOptions>(parse({"validate", "--later", "a.json"})).later);
  CHECK(std::get<StatusOptions>(parse({"status", "a.h5", "--json"})).json);
  CHECK(std::get<InfoOptions>(parse({"info", "a.h5", "--verify"})).verify);
  CHECK(std::get<InfoOptions>(parse({"info", "a.h5", "--job"})).job);
  CHECK(answer({"--version"}).code == ExitCode::ok);
  CHECK_THAT(answer({"--version"}).text, Matches("rodsweep [0-9.]+ \\(revision [^)]+\\)\n  [^]*HDF5[^]*\n"));
}

TEST_CASE("the commands on results files take their options") {
  const auto query = std::get<QueryOptions>(parse({"query", "a.h5", "x>1", "y=2", "--where", "z=3", "--columns", "x,y",
                                                   "--sort", "x", "--descending", "--limit", "5", "--csv"}));
  CHECK(query.file == "a.h5");
  CHECK(query.conditions == std::vector<std::string>{"x>1", "y=2", "z=3"});
  CHECK(query.columns == std::vector<std::string>{"x,y"});
  CHECK((query.sort == "x" && query.descending && query.limit == 5));
  CHECK(query.format == QueryOptions::Format::csv);
  const auto late = std::get<QueryOptions>(parse({"query", "--where", "z=3", "--columns", "x", "a.h5", "y=2"}));
  CHECK(late.file == "a.h5");
  CHECK(late.conditions == std::vector<std::string>{"y=2", "z=3"});
  CHECK(late.format == QueryOptions::Format::table);
  const auto rerun = std::get<RerunOptions>(parse({"rerun", "a.h5", "12", "--trajectory-every", "4"}));
  CHECK((rerun.file == "a.h5" && rerun.task == 12 && rerun.trajectory_every == 4 && !rerun.output));
  CHECK(rerun.command == "build/rodsweep rerun a.h5 12 --trajectory-every 4");
  CHECK(std::get<PackOptions>(parse({"pack", "a.h5", "-o", "b.h5"})).output == "b.h5");
  const auto compare = std::get<CompareOptions>(parse({"compare", "a.h5", "b.h5", "--by", "parameters", "--tasks"}));
  CHECK((compare.a == "a.h5" && compare.b == "b.h5" && compare.by == MatchBy::parameters && compare.tasks));
  CHECK(std::get<CompareOptions>(parse({"compare", "a.h5", "b.h5"})).by == MatchBy::everything);
  CHECK(answer({"compare", "a.h5"}).code == ExitCode::user_error);
}

TEST_CASE("mistakes on the command line of results files are answered with exit code 2") {
  CHECK(answer({"query"}).code == ExitCode::user_error);
  CHECK(answer({"query", "a.h5", "--csv", "--json"}).code == ExitCode::user_error);
  CHECK(answer({"query", "a.h5", "--descending"}).code == ExitCode::user_error);
  CHECK(answer({"query", "a.h5", "--limit", "-1"}).code == ExitCode::user_error);
  CHECK_THAT(answer({"rerun", "a.h5"}).text, Contains("TASK is required"));
  CHECK(answer({"rerun", "a.h5", "first"}).code == ExitCode::user_error);
  CHECK(answer({"rerun", "a.h5", "1", "--trajectory-every", "0"}).code == ExitCode::user_error);
  CHECK(answer({"completion", "tcsh"}).code == ExitCode::user_error);
}

TEST_CASE("completion and the manual know every command and its options") {
  for (const char* shell : {"bash", "zsh", "fish"}) {
    const Answer script = answer({"completion", shell});
    CHECK(script.code == ExitCode::ok);
    for (const char* command :
         {"run", "keep", "plan", "validate", "status", "info", "query", "compare", "rerun", "pack", "merge"}) {
      CAPTURE(shell, command);
      CHECK_THAT(script.text, Contains(std::string(command) + ") ") || Contains(std::string("-a ") + command + " -d "));
    }
    CHECK_THAT(script.text, Contains("retry-failed"));
  }
  const std::string manual = answer({"manual"}).text;
  CHECK_THAT(manual, Matches("\\.TH RODSWEEP 1 \"\" \"rodsweep [0-9.]+\" [^]*"));
  CHECK_THAT(manual, Contains(".SS merge\n\\fBrodsweep merge\\fR [\\fIOPTION\\fR]... \\fIFILE\\fR...\n"));
  CHECK_THAT(manual, Contains(".TP\n\\fB\\-\\-watch\\fR [\\fISECONDS\\fR]\nSay it again"));
  CHECK_THAT(manual, Contains(".SH EXIT STATUS\n.EX\n  0  all done\n"));
}

TEST_CASE("what troff would take for its own is escaped in the manual") {
  const CommandOutline program{"p", "p: what\n.so /etc/passwd\n  'quoted' \\n ~^`-\n\nmore", "", {}, {}, {}};
  CHECK_THAT(
      manual_page(program, "p 1"),
      Contains("\n.SH DESCRIPTION\n\\&.so /etc/passwd\n.PP\n.EX\n  \\(aqquoted\\(aq \\en \\(ti\\(ha\\(ga\\-\n.EE\n"
               ".PP\nmore\n"));
}

TEST_CASE("mistakes on the command line are answered with exit code 2 and what is wrong") {
  CHECK(answer({}).code == ExitCode::user_error);
  CHECK_THAT(answer({}).text, Contains("Examples:"));
  CHECK(answer({"run"}).code == ExitCode::user_error);
  CHECK_THAT(answer({"run"}).text, Contains("JOB is required"));
  CHECK(answer({"run", "a.json", "--resumee"}).code == ExitCode::user_error);
  CHECK_THAT(answer({"run", "a.json", "--resumee"}).text, Contains("--resumee"));
  CHECK(answer({"walk", "a.json"}).code == ExitCode::user_error);
  CHECK_THAT(answer({"run", "a.json", "--retry-failed"}).text, Contains("--retry-failed requires --resume"));
  CHECK(answer({"info", "a.h5", "--job", "--json"}).code == ExitCode::user_error);
}

TEST_CASE("every command's help shows an example and the exit codes") {
  for (const char* command : {"run", "plan", "validate", "status", "info", "query", "compare", "rerun", "pack"}) {
    CAPTURE(command);
    const Answer help = answer({command, "--help"});
    CHECK(help.code == ExitCode::ok);
    CHECK_THAT(help.text, Contains(std::string("rodsweep ") + command));
    CHECK_THAT(help.text, Contains("Exit codes:\n  0  "));
  }
  CHECK_THAT(answer({"run", "--help"}).text, Contains("4  stopped early; --resume continues"));
  CHECK_THAT(answer({"--help"}).text, Contains("mpirun"));
}
