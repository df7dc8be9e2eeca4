#include "tests/bench/medians.hpp"

namespace rodsweep {

void Medians::ReportRuns(const std::vector<Run>& runs) {
  for (const Run& run : runs) {
    if (run.aggregate_name != "median") continue;
    ConsoleReporter::ReportRuns({run});
    seconds_[run.run_name.function_name + "/" + run.run_name.args] = run.GetAdjustedCPUTime() * 1e-9;
  }
}

double Medians::operator()(const std::string& name) const {
  const auto at = seconds_.find(name);
  return at == seconds_.end() ? 0 : at->second;
}

int run_benchmarks(int argc, char** argv, const std::function<void(const Medians&)>& print) {
  std::string defaults[] = {"--benchmark_repetitions=9", "--benchmark_enable_random_interleaving=true",
                            "--benchmark_min_time=0.05", "--benchmark_report_aggregates_only=true"};
  std::vector<char*> arguments{argv[0]};
  for (std::string& argument : defaults) arguments.push_back(argument.data());
  arguments.insert(arguments.end(), argv + 1, argv + argc);
  argc = static_cast<int>(arguments.size());
  benchmark::Initialize(&argc, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(argc, arguments.data())) return 2;
  Medians medians;
  benchmark::RunSpecifiedBenchmarks(&medians);
  print(medians);
  return 0;
}

}  // namespace rodsweep
