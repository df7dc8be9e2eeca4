#include "runner/command/shard.hpp"

#include <charconv>
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

}  // namespace rodsweep
