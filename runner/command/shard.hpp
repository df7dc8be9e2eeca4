// One of the parts that the tasks of a sweep are dealt out to (`run --shard 3/16`), each into a file of its own, which
// `merge` puts together.
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

/// Of "3/16"; none of anything else.
std::optional<Shard> shard_of(const std::string& text);

/// How many of a sweep's tasks are the shard's.
std::int64_t share_of(const Shard& shard, std::int64_t tasks);

/// Which they are: dealt out in the order of their costs, so that shards take about as long. Without a shard: all.
std::vector<bool> in_shard(const Plan& plan, const std::optional<Shard>& shard);

}  // namespace rodsweep
