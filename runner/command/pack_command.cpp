#include "runner/command/pack_command.hpp"

#include <fmt/format.h>

#include "runner/dispatch/stop_signal.hpp"
#include "runner/file/pack.hpp"
#include "runner/file/unfinished_file.hpp"
#include "runner/terminal/text.hpp"

namespace rodsweep {
namespace {

struct Stopped {};

}  // namespace

ExitCode execute(const PackOptions& options, Console& console) {
  const std::filesystem::path output = options.output.value_or(file_beside(options.file, "-packed"));
  if (const std::string left = unfinished_text(output); !left.empty()) console.warn(left);
  const StopSignal signal;
  Packing packing;
  try {
    packing = pack_results(options.file, output, [&] {
      if (signal.received() != 0) throw Stopped();
    });
  } catch (Stopped) {
    console.error(fmt::format("stopped by {}: {} was not written", signal_cause(signal.received()), output.native()));
    return ExitCode::stopped;
  }
  if (packing.verified < packing.tasks)
    console.warn(
        fmt::format("{} of {} tasks are pending, and a packed file cannot be resumed: keep {}, complete the sweep, "
                    "then pack it again",
                    packing.tasks - packing.verified, packing.tasks, options.file.native()));
  const auto before = static_cast<std::int64_t>(packing.bytes_before);
  const auto after = static_cast<std::int64_t>(packing.bytes_after);
  console.result(fmt::format("{}: {}, from {} ({:.0f} %); {} verified", output.native(), bytes_text(after),
                             bytes_text(before), 100 * static_cast<double>(after) / static_cast<double>(before),
                             counted(packing.verified, "finished task")));
  return ExitCode::ok;
}

}  // namespace rodsweep
