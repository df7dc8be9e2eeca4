// Benchmarks as medians over interleaved repetitions, for tables that set them beside each other.
#pragma once

#include <benchmark/benchmark.h>

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace rodsweep {

/// Prints and keeps [s] the medians only, of processor time: what other programs take meanwhile is not counted.
class Medians : public benchmark::ConsoleReporter {
 public:
  Medians() : ConsoleReporter(OO_None) {}
  void ReportRuns(const std::vector<Run>& runs) override;

  /// Of a benchmark by name and arguments, "multiply/50"; 0 if it did not run.
  double operator()(const std::string& name) const;
  double operator()(const std::string& name, std::int64_t argument) const {
    return (*this)(name + "/" + std::to_string(argument));
  }

 private:
  std::map<std::string, double> seconds_;
};

using Cases = std::vector<std::pair<const char*, void (*)(benchmark::State&)>>;

/// Registers every case with every argument.
template <class Arguments>
void register_cases(const Cases& cases, const Arguments& arguments) {
  for (const auto& [name, function] : cases)
    for (const std::int64_t argument : arguments)
      benchmark::RegisterBenchmark(name, function)->Arg(argument)->Unit(benchmark::kNanosecond);
}

/// Runs what is registered, then prints tables; the command line wins over the defaults. The exit code: 2 where it is
/// not understood.
int run_benchmarks(int argc, char** argv, const std::function<void(const Medians&)>& print);

}  // namespace rodsweep
