// Second tasks held by workers, and idle time at the end of a sweep. Time is simulated, workers take given times, and
// costs are estimates.
#include <algorithm>
#include <cmath>
#include <deque>
#include <random>

#include "tests/catch.hpp"
#include "tests/runner/dispatch_examples.hpp"

using namespace rodsweep;
using namespace rodsweep::examples;

namespace test_dispatch_idle {

struct Played {
  double end = 0;        ///< when the last task was finished
  double first_end = 0;  ///< when the first worker ran out of tasks
  double work = 0;
  std::int64_t waits = 0;        ///< times that a worker without a task got one
  double idle_beside_hoard = 0;  ///< time with an idle worker while another worker holds a second task

  double idle_share() const { return 1 - first_end / end; }
};

/// Simulates the sweep event by event; `seconds` has the true duration of each task.
Played play(int workers, const std::vector<PendingTask>& tasks, const std::vector<double>& seconds) {
  Sweep sweep(workers, tasks);
  struct Rank {
    Inbox inbox;
    std::deque<std::int64_t> hand;  // the first task runs
    double end = 0;
  };
  std::vector<Rank> ranks;
  for (int rank = 1; rank <= workers; ++rank) ranks.push_back({Inbox(sweep.network[rank]), {}, 0});

  Played played;
  for (double now = 0;;) {
    const bool finished = sweep.master.step() == Master::Step::finished;
    int idle = 0, hoarded = 0;
    for (Rank& rank : ranks) {
      const bool was_idle = rank.hand.empty();
      for (const std::int64_t task : rank.inbox.assigned()) rank.hand.push_back(task);
      if (was_idle && !rank.hand.empty()) {
        rank.end = now + seconds[static_cast<std::size_t>(rank.hand.front())];
        ++played.waits;
      }
      idle += rank.hand.empty();
      hoarded += rank.hand.size() > 1;
    }
    if (finished) {
      played.end = played.first_end = now;
      for (const Rank& rank : ranks) played.first_end = std::min(played.first_end, rank.end);
      return played;
    }
    Rank* next = nullptr;
    for (Rank& rank : ranks)
      if (!rank.hand.empty() && (next == nullptr || rank.end < next->end)) next = &rank;
    if (idle > 0 && hoarded > 0) played.idle_beside_hoard += next->end - now;
    now = next->end;
    const std::int64_t task = next->hand.front();
    next->hand.pop_front();
    played.work += seconds[static_cast<std::size_t>(task)];
    next->inbox.report(task);
    if (!next->hand.empty()) next->end = now + seconds[static_cast<std::size_t>(next->hand.front())];
  }
}

/// Tasks of one second, and the costs of others.
std::vector<double> seconds_and(int tasks, const std::vector<double>& others) {
  std::vector<double> costs(static_cast<std::size_t>(tasks), 1.0);
  costs.insert(costs.begin(), others.begin(), others.end());
  return costs;
}

TEST_CASE("with exact costs a sweep ends as soon as it can: long tasks begin first and are shared out") {
  struct Row {
    int workers;
    std::vector<double> costs;
    double end;
  };
  for (const auto& [workers, costs, end] :
       {Row{4, seconds_and(1000, {}), 250}, Row{4, std::vector<double>(8, 100), 200}, Row{3, seconds_and(40, {20}), 20},
        Row{10, seconds_and(90, {10}), 10}}) {
    const Played played = play(workers, tasks_of_cost(costs), costs);
    CHECK(played.end == end);
    CHECK(played.idle_beside_hoard == 0);
    // Of equal tasks a worker finds the next one in its hand, but for the first and the last round.
    if (end == 250) CHECK(played.waits <= 4 * 7);
  }
}

TEST_CASE("no worker idles beside a task in another's hand, though costs are wrong by up to a factor of 1.4") {
  const unsigned seed = GENERATE(1u, 2u, 3u, 4u, 5u, 6u);
  const int workers = GENERATE(2, 5, 16);
  std::mt19937 random(seed);
  std::vector<double> costs(200), seconds(200);
  for (std::size_t i = 0; i < costs.size(); ++i) {
    costs[i] = std::exp(std::normal_distribution<double>(0, 1.5)(random));
    seconds[i] = costs[i] * std::uniform_real_distribution<double>(1, 1.4)(random);
  }
  const Played played = play(workers, tasks_of_cost(costs), seconds);
  CHECK(played.idle_beside_hoard == 0);
  const double longest = *std::max_element(seconds.begin(), seconds.end());
  CHECK(played.end <= played.work / workers + longest);
}

TEST_CASE("with twenty tasks a worker, of lengths of ten to one and costs a third off, no worker idles for 5 percent") {
  const unsigned seed = GENERATE(1u, 2u, 3u);
  const int workers = GENERATE(2, 16, 128);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> decade(0, 1), error(-0.3, 0.3);
  std::vector<double> costs, durations;
  for (int task = 0; task < 20 * workers; ++task) {
    durations.push_back(std::pow(10, decade(random)));
    costs.push_back(durations.back() * std::exp(error(random)));
  }
  CHECK(play(workers, tasks_of_cost(costs), durations).idle_share() < 0.05);
}

}  // namespace test_dispatch_idle
