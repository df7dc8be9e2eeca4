// The report of `status` and `info` on a results file, as text and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "runner/command/shard.hpp"
#include "runner/file/inspect.hpp"

namespace rodsweep {

std::string outcomes_text(const FileSummary& file);  ///< "98 ok, 2 torn"

/// The tasks of the last run: all tasks, or those of its shard.
struct Share {
  std::optional<Shard> shard;
  std::int64_t tasks = 0;
  std::int64_t left = 0;
};
Share share_of(const FileSummary& file);

/// Whether a run is writing the file. Uses the run's lock, which the system releases when the run dies. Without locks,
/// uses the file's modification time, which a run renews.
bool is_alive(const FileSummary& file);

/// Tasks per second of the current run; none before its first task.
std::optional<double> rate_of(const FileSummary& file);

/// Time left of the current run, by its own estimate; none before its first task and when it is overdue.
std::optional<double> seconds_left(const FileSummary& file);

/// One line about run `index` of the sweep.
std::string run_text(const FileSummary& file, std::size_t index);

nlohmann::ordered_json to_json(const FileSummary& file);

}  // namespace rodsweep
