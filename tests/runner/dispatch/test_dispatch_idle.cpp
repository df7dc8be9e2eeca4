// How long workers idle at the end of a sweep, in simulated time: the real master, workers that take as long as they
// are told, and costs that are estimates.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <deque>
#include <random>
#include <vector>

#include "tests/runner/dispatch_examples.hpp"

using namespace rodsweep;
using namespace rodsweep::examples;

namespace test_dispatch_idle {

/// A worker that runs what it has in hand, one task after the other.
struct Clerk {
  explicit Clerk(Channel& channel) : inbox(channel) {}

  Inbox inbox;
  std::deque<std::int64_t> hand;
  double end = 0;  ///< of the task that it runs, or of its last one
};

/// The largest time that a worker is idle before the last one ends, relative to the time that the sweep takes.
double idle_share(int workers, const std::vector<double>& costs, const std::vector<double>& durations) {
  Sweep sweep(workers, tasks_of_cost(costs));
  std::vector<Clerk> clerks;
  for (int rank = 1; rank <= workers; ++rank) clerks.emplace_back(sweep.network[rank]);
  const auto duration = [&](std::int64_t task) { return durations[static_cast<std::size_t>(task)]; };
  for (double now = 0; sweep.master.step() != Master::Step::finished;) {
    Clerk* next = nullptr;
    for (Clerk& clerk : clerks) {
      for (const std::int64_t task : clerk.inbox.assigned()) {
        if (clerk.hand.empty()) clerk.end = now + duration(task);
        clerk.hand.push_back(task);
      }
      if (!clerk.hand.empty() && (next == nullptr || clerk.end < next->end)) next = &clerk;
    }
    REQUIRE(next != nullptr);
    now = next->end;
    next->inbox.report(next->hand.front());
    next->hand.pop_front();
    if (!next->hand.empty()) next->end = now + duration(next->hand.front());
  }
  const auto by_end = [](const Clerk& a, const Clerk& b) { return a.end < b.end; };
  const auto [first, last] = std::minmax_element(clerks.begin(), clerks.end(), by_end);
  return 1 - first->end / last->end;
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
  CHECK(idle_share(workers, costs, durations) < 0.05);
}

TEST_CASE("a single task that takes a tenth of all the time is begun first, and holds nobody up") {
  std::vector<double> costs(90, 1.0);
  costs.push_back(10);
  CHECK(idle_share(10, costs, costs) < 1e-12);
}

}  // namespace test_dispatch_idle
