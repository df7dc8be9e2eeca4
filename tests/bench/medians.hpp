// Benchmarks as medians over interleaved repetitions, for tables that set them beside each other.
#pragma once

#include <benchmark/benchmark.h>

#include <map>
#include <string>

namespace rodsweep {

/// Prints and keeps [s] the medians only, of processor time: what other programs take meanwhile is not counted.
class Medians : public benchmark::ConsoleReporter {
 public:
  Medians() : ConsoleReporter(OO_None) {}
  void ReportRuns(const std::vector<Run>& runs) override;

  /// Of a benchmark by name and arguments, "multiply/50"; 0 if it did not run.
  double operator()(const std::string& name) const;

 private:
  std::map<std::string, double> seconds_;
};

/// Runs what is registered; the command line wins over the defaults. False where it is not understood.
bool run_benchmarks(int argc, char** argv, Medians& medians);

}  // namespace rodsweep
