// Progress, summaries and their words.
#include <csignal>

#include "runner/command/sweep_opening.hpp"
#include "runner/terminal/formats.hpp"
#include "runner/terminal/progress.hpp"
#include "solver/plugin/printable.hpp"
#include "tests/catch.hpp"

using namespace rodsweep;

namespace test_progress {

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::EndsWith;
using Catch::Matchers::StartsWith;
using std::chrono::seconds;
const Progress::Clock::time_point start{};

Dispatch dispatch_of(std::int64_t ok, std::int64_t diverged, std::int64_t left) {
  Dispatch dispatch;
  dispatch.finished[static_cast<std::size_t>(TaskOutcome::ok)] = ok;
  dispatch.finished[static_cast<std::size_t>(TaskOutcome::diverged)] = diverged;
  dispatch.left = left;
  dispatch.wall_s = 10;
  dispatch.busy_s = 15;
  return dispatch;
}

TEST_CASE("the time left is weighted by the cost of tasks") {
  Console silent(false);
  Progress progress(silent, {3, 0, 0, 100, 2}, start);
  CHECK_FALSE(progress.seconds_left(start + seconds(1)));
  progress.finished(TaskOutcome::ok, 80, 160);  // 2 s per unit: 200 s of work, 100 s for two workers
  CHECK(progress.seconds_left(start + seconds(90)).value() == Approx(10));
  CHECK_FALSE(progress.seconds_left(start + seconds(101)));
}

TEST_CASE("the time left follows recent tasks, not a first one of another kind") {
  Console silent(false);
  Progress progress(silent, {401, 0, 0, 1400, 1}, start);
  progress.finished(TaskOutcome::ok, 1000, 10);
  for (int i = 0; i < 300; ++i) progress.finished(TaskOutcome::ok, 1, 1);
  CHECK(progress.seconds_left(start + seconds(310)).value() == Approx(100).epsilon(0.01));
}

TEST_CASE("progress counts earlier runs, but judges the rate by this one") {
  Console silent(false);
  Progress progress(silent, {400, 100, 1, 300, 1}, start);
  for (int i = 0; i < 20; ++i) progress.finished(i == 0 ? TaskOutcome::error : TaskOutcome::ok, 1, 0.5);
  CHECK(progress.text(start + seconds(10)) == "120 of 400 tasks (30 %), 2 failed, 2/s, 2 min 20 s left");
}

TEST_CASE("a finished sweep exits 0, with failures 3, stopped 4, without an ended task in time 5, without workers 6") {
  CHECK(exit_code({5, {}, dispatch_of(5, 0, 0), 1, "x.h5"}) == ExitCode::ok);
  CHECK(exit_code({5, {}, dispatch_of(4, 1, 0), 1, "x.h5"}) == ExitCode::tasks_failed);
  Dispatch ended = dispatch_of(3, 1, 1);
  CHECK(exit_code({5, {}, ended, 1, "x.h5"}) == ExitCode::lost);
  ended.signal = SIGTERM;
  CHECK(exit_code({5, {}, ended, 1, "x.h5"}) == ExitCode::stopped);
  ended.signal = 0;
  ended.late = true;
  CHECK(exit_code({5, {}, ended, 1, "x.h5"}) == ExitCode::stopped);
  CHECK(exit_code({5, {}, ended, 1, "x.h5", "rodsweep", TooLarge{1, 0, 1}}) == ExitCode::too_long);
  ended = dispatch_of(0, 0, 1);
  ended.late = true;
  CHECK(exit_code({5, {{"ok", 4}}, ended, 1, "x.h5"}) == ExitCode::too_long);
  CHECK(exit_code({5, {{"ok", 1}, {"error", 1}}, dispatch_of(3, 0, 0), 1, "x.h5"}) == ExitCode::tasks_failed);
}

TEST_CASE("the summary names outcomes, first failures, use of workers, file and next command") {
  Dispatch dispatch = dispatch_of(6, 7, 0);
  for (const std::int64_t task : {9, 4}) dispatch.failures.push_back({task, TaskOutcome::diverged, "joint gap 12"});
  CHECK(summary_text({15, {{"ok", 2}}, dispatch, 2, "results/a b.h5"}) ==
        "15 tasks: 8 ok, 7 diverged\n"
        "  task 4 diverged: joint gap 12\n"
        "  task 9 diverged: joint gap 12\n"
        "  and 5 more\n"
        "10.0 s for 13 tasks, 1.3 tasks/s, 2 workers busy 75 % of the time\n"
        "results: results/a b.h5\n"
        "next: /usr/bin/python3 analysis/summary.py 'results/a b.h5'");
}

TEST_CASE("the summary counts solves that missed their tolerance") {
  SweepSummary summary{15, {}, dispatch_of(6, 0, 9), 2, "x.h5"};
  summary.solves = {1040, 0};
  CHECK_THAT(summary_text(summary), !ContainsSubstring("missed"));
  summary.solves.missed = 29;
  CHECK_THAT(
      summary_text(summary),
      ContainsSubstring("\n29 of 1040 solves missed the tolerance: their guesses have no times in these tasks\n"));
}

TEST_CASE("the summary of a shard counts its own tasks, and says how the shards are put together") {
  const auto summary = [](const char* path, const Dispatch& dispatch) {
    return summary_text({15, {}, dispatch, 1, path, "build/rodsweep", {}, Shard{2, 4}});
  };
  CHECK(summary("results/my-2of4.h5", dispatch_of(4, 0, 0)) ==
        "shard 2 of 4, 4 of 15 tasks: 4 ok\n"
        "10.0 s for 4 tasks, 0.4 tasks/s, 1 worker busy 150 % of the time\n"
        "results: results/my-2of4.h5\n"
        "next, when all shards are done: build/rodsweep merge results/my-*of4.h5 -o results/my.h5");
  CHECK_THAT(summary("other.h5", dispatch_of(4, 0, 0)), EndsWith("build/rodsweep merge SHARDS... -o FILE"));
  CHECK_THAT(summary("my-2of4.h5", dispatch_of(3, 0, 1)), EndsWith("results: my-2of4.h5"));
}

TEST_CASE("a progress line never reaches the last column of its terminal") {
  const std::string text = "12 of 90 tasks (13 %), 2/s, 39.0 s left";
  const std::string whole = "[############............] " + text;
  const auto columns_of = [](const std::string& line) { return static_cast<int>(line.size()) + 1; };
  CHECK(progress_line(0.5, text, 0) == whole);  // the width is not known
  CHECK(progress_line(0.5, text, 120) == whole);
  CHECK(progress_line(0.5, text, columns_of(whole)) == whole);
  for (int columns = 1; columns < columns_of(whole); ++columns) {
    CAPTURE(columns);
    const std::string line = progress_line(0.5, text, columns);
    CHECK(columns_of(line) <= columns);
    CHECK_THAT(text, StartsWith(line));
  }
  CHECK(progress_line(0.5, text, columns_of(text)) == text);
}

TEST_CASE("control characters are shown by their number, and invalid UTF-8 by U+FFFD") {
  CHECK(printable("plain, \xC3\xA4\xE2\x82\xAC\ttab\nline") == "plain, \xC3\xA4\xE2\x82\xAC\ttab\nline");
  CHECK(printable("\x1b[31mred\r\x07\x7f") == "\\x1b[31mred\\x0d\\x07\\x7f");
  CHECK(printable(std::string_view("a\0b", 3)) == "a\\x00b");
  CHECK(printable("\xC2\x9B"
                  "31m\xC2\xA0") == "\\x9b31m\xC2\xA0");  // a control sequence of one character
  CHECK(printable("\xFFmore \xC2") == "\xEF\xBF\xBDmore \xEF\xBF\xBD");
}

TEST_CASE("durations and sizes are short and never rounded to a unit too large") {
  CHECK(duration_text(0.0123) == "12 ms");
  CHECK(duration_text(0.9999) == "1.0 s");
  CHECK(duration_text(59.99) == "1 min 00 s");
  CHECK(duration_text(245) == "4 min 05 s");
  CHECK(duration_text(3599.7) == "1 h 00 min");
  CHECK(duration_text(7380) == "2 h 03 min");
  CHECK(duration_text(270000) == "3 d 03 h");
  CHECK(bytes_text(999) == "999 B");
  CHECK(bytes_text(4200000) == "4.2 MB");
  CHECK(bytes_text(999999) == "1 MB");
}

TEST_CASE("words are quoted for the shell only where they must be") {
  CHECK(shell_quoted("results/demo.h5") == "results/demo.h5");
  CHECK(shell_quoted("my job.json") == "'my job.json'");
  CHECK(shell_quoted("it's") == "'it'\\''s'");
  CHECK(shell_quoted("") == "''");
}

}  // namespace test_progress
