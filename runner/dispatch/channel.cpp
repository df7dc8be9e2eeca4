#include "runner/dispatch/channel.hpp"

#include <sched.h>

#include <algorithm>
#include <cstring>
#include <thread>
#include <utility>

#include "runner/mpi/mpi_session.hpp"

namespace rodsweep {

Report::Report(std::int64_t task_index, TaskOutcome task_outcome, double seconds, std::string_view message)
    : task(task_index), outcome(task_outcome), busy_s(seconds) {
  message.copy(text.data(), text.size() - 1);
}

void Channel::unexpected(const Envelope& envelope) const {
  throw ProtocolError("rank {} received an unexpected message of tag {} and {} bytes from rank {}", rank(),
                      static_cast<int>(envelope.tag), envelope.bytes, envelope.source);
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

void Backoff::wait() {
  using std::chrono::microseconds;
  constexpr int spins = 50;
  if (polls_ < spins) {
    ++polls_;
    pause_ = microseconds(50);
    sched_yield();
    return;
  }
  std::this_thread::sleep_for(pause_);
  pause_ = std::min(pause_ + pause_ / 2, microseconds(2000));
}

MpiChannel::MpiChannel(MPI_Comm comm) {
  check_mpi(MPI_Comm_dup(comm, &comm_), "MPI_Comm_dup");
  rank_ = rank_in(comm_);
  size_ = ranks_in(comm_);
}

MpiChannel::~MpiChannel() {
  if (comm_ == MPI_COMM_NULL) return;
  if (std::uncaught_exceptions() > exceptions_) {
    abandon();
    return;
  }
  for (Outgoing& message : outgoing_) MPI_Wait(&message.request, MPI_STATUS_IGNORE);
  MPI_Comm_free(&comm_);
}

void MpiChannel::abandon() {
  for (Outgoing& message : outgoing_) static_cast<void>(message.data.release());  // MPI may still read it
  outgoing_.clear();
  comm_ = MPI_COMM_NULL;
}

std::optional<Envelope> MpiChannel::probe() {
  int arrived = 0, bytes = 0;
  MPI_Status status;
  check_mpi(MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, comm_, &arrived, &status), "MPI_Iprobe");
  if (!arrived) return std::nullopt;
  check_mpi(MPI_Get_count(&status, MPI_BYTE, &bytes), "MPI_Get_count");
  return Envelope{status.MPI_SOURCE, static_cast<Tag>(status.MPI_TAG), static_cast<std::size_t>(bytes)};
}

void MpiChannel::send_bytes(int destination, Tag tag, const void* data, std::size_t bytes) {
  forget_sent();
  Outgoing message{std::make_unique<char[]>(bytes)};
  std::memcpy(message.data.get(), data, bytes);
  check_mpi(MPI_Isend(message.data.get(), static_cast<int>(bytes), MPI_BYTE, destination, static_cast<int>(tag), comm_,
                      &message.request),
            "MPI_Isend");
  outgoing_.push_back(std::move(message));
}

void MpiChannel::forget_sent() {
  const auto is_sent = [](Outgoing& message) {
    int sent = 0;
    check_mpi(MPI_Test(&message.request, &sent, MPI_STATUS_IGNORE), "MPI_Test");
    return sent != 0;
  };
  outgoing_.erase(std::remove_if(outgoing_.begin(), outgoing_.end(), is_sent), outgoing_.end());
}

void MpiChannel::receive_bytes(const Envelope& envelope, void* data) {
  check_mpi(MPI_Recv(data, static_cast<int>(envelope.bytes), MPI_BYTE, envelope.source, static_cast<int>(envelope.tag),
                     comm_, MPI_STATUS_IGNORE),
            "MPI_Recv");
}

}  // namespace rodsweep
