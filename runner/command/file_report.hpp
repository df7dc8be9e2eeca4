// What `status` and `info` say of a results file, in words and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "runner/command/shard.hpp"
#include "runner/file/inspect.hpp"

namespace rodsweep {

std::string outcomes_text(const FileSummary& file);  ///< "98 ok, 2 torn"

/// What its last start had to do: all tasks, or those of its shard.
struct Share {
  std::optional<Shard> shard;
  std::int64_t tasks = 0;
  std::int64_t left = 0;
};
Share share_of(const FileSummary& file);

/// Does a run work on it? By its lock, which dies with it; where the file system has none, by the file's time, which a
/// run renews.
bool is_alive(const FileSummary& file);

/// Tasks a second of the start that works on it; none before its first.
std::optional<double> rate_of(const FileSummary& file);

/// Start `index` of the sweep, a line.
std::string start_text(const FileSummary& file, std::size_t index);

nlohmann::ordered_json to_json(const FileSummary& file);

}  // namespace rodsweep
