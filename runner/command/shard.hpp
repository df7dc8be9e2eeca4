// A shard: one of the parts of a sweep's tasks (`run --shard 3/16`). Each shard has its own results file; `merge`
// combines these files.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace rodsweep {

struct Shard {
  int number = 1;  ///< from 1
  int of = 1;
};

/// Parses "3/16"; none if `text` is not a valid shard.
std::optional<Shard> shard_of(const std::string& text);

/// The number of tasks in the shard, for a sweep of `tasks` tasks.
std::int64_t share_of(const Shard& shard, std::int64_t tasks);

}  // namespace rodsweep
