#include "runner/dispatch/channel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace rodsweep {

Report::Report(std::int64_t task_index, TaskOutcome task_outcome, double seconds, std::string_view message)
    : task(task_index), outcome(task_outcome), busy_s(seconds) {
  message.copy(text.data(), text.size() - 1);
}

void Channel::unexpected(const Envelope& envelope) const {
  throw ProtocolError(fmt::format("rank {} received an unexpected message of tag {} and {} bytes from rank {}", rank(),
                                  static_cast<int>(envelope.tag), envelope.bytes, envelope.source));
}

MemoryNetwork::MemoryNetwork(int size) {
  endpoints_.reserve(static_cast<std::size_t>(size));
  for (int rank = 0; rank < size; ++rank) endpoints_.emplace_back(*this, rank);
}

std::optional<Envelope> MemoryNetwork::Endpoint::probe() {
  if (inbox_.empty()) return std::nullopt;
  return inbox_.front().envelope;
}

void MemoryNetwork::Endpoint::send_bytes(int destination, Tag tag, const void* data, std::size_t bytes) {
  const auto* first = static_cast<const char*>(data);
  network_->endpoints_.at(static_cast<std::size_t>(destination))
      .inbox_.push_back({{rank_, tag, bytes}, std::vector<char>(first, first + bytes)});
}

void MemoryNetwork::Endpoint::receive_bytes(const Envelope& envelope, void* data) {
  std::memcpy(data, inbox_.front().data.data(), envelope.bytes);
  inbox_.pop_front();
}

}  // namespace rodsweep
