#include "runner/command/shard.hpp"

#include <algorithm>
#include <charconv>
#include <numeric>
#include <system_error>

namespace rodsweep {

std::optional<Shard> shard_of(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto number = std::from_chars(text.data(), end, shard.number);
  if (number.ec != std::errc() || number.ptr == end || *number.ptr != '/') return std::nullopt;
  const auto of = std::from_chars(number.ptr + 1, end, shard.of);
  if (of.ec != std::errc() || of.ptr != end || shard.number < 1 || shard.number > shard.of) return std::nullopt;
  return shard;
}

std::int64_t share_of(const Shard& shard, std::int64_t tasks) { return (tasks - shard.number + shard.of) / shard.of; }

std::vector<bool> in_shard(const Plan& plan, const std::optional<Shard>& shard) {
  if (!shard) return std::vector<bool>(static_cast<std::size_t>(plan.size()), true);
  std::vector<std::int64_t> order(static_cast<std::size_t>(plan.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::int64_t a, std::int64_t b) { return plan.cost(a) > plan.cost(b); });
  std::vector<bool> mine(order.size(), false);
  for (auto i = static_cast<std::size_t>(shard->number) - 1; i < order.size(); i += static_cast<std::size_t>(shard->of))
    mine[static_cast<std::size_t>(order[i])] = true;
  return mine;
}

}  // namespace rodsweep
