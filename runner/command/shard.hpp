// A shard: one of the parts of a sweep's tasks (`run --shard 3/16`). Each shard has its own results file; `merge`
// combines these files.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "runner/plan/plan.hpp"

namespace rodsweep {

struct Shard {
  int number = 1;  ///< from 1
  int of = 1;
};

/// Parses "3/16"; none if `text` is not a valid shard.
std::optional<Shard> shard_of(const std::string& text);

/// The number of tasks in the shard, for a sweep of `tasks` tasks.
std::int64_t share_of(const Shard& shard, std::int64_t tasks);

/// A flag per task; all set without a shard. Tasks are dealt out by descending cost, so that shards take similar times.
std::vector<bool> in_shard(const Plan& plan, const std::optional<Shard>& shard);

}  // namespace rodsweep
