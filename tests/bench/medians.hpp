// Medians of benchmarks over interleaved repetitions.
#pragma once

#include <benchmark/benchmark.h>

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace rodsweep {

/// Prints and stores the medians only [s]. They are processor time, so other programs do not count.
class Medians : public benchmark::ConsoleReporter {
 public:
  Medians() : ConsoleReporter(OO_None) {}
  void ReportRuns(const std::vector<Run>& runs) override;

  /// The median of a benchmark with its arguments, such as "multiply/50"; 0 if it did not run.
  double operator()(const std::string& name) const;
  double operator()(const std::string& name, std::int64_t argument) const {
    return (*this)(name + "/" + std::to_string(argument));
  }

 private:
  std::map<std::string, double> seconds_;
};

using Cases = std::vector<std::pair<const char*, void (*)(benchmark::State&)>>;

template <class Arguments>
void register_cases(const Cases& cases, const Arguments& arguments) {
  for (const auto& [name, function] : cases)
    for (const std::int64_t argument : arguments)
      benchmark::RegisterBenchmark(name, function)->Arg(argument)->Unit(benchmark::kNanosecond);
}

/// Runs the registered benchmarks, then `print`. The command line overrides the defaults. Returns the exit code: 2 for
/// an unknown option.
int run_benchmarks(int argc, char** argv, const std::function<void(const Medians&)>& print);

}  // namespace rodsweep
