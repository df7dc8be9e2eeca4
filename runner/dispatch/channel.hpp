// All messages between master (rank 0) and workers, and the interface that sends them.
//
// Messages are plain structs. Between two ranks they arrive in the order sent. Sending never waits for the receiver:
// messages are far below any eager limit, with only a few per worker in flight. Probing never waits either.
// MpiChannel (runner/dispatch/mpi_channel.hpp) uses MPI. MemoryNetwork does the same in one process and one thread,
// for the tests of dispatch and for a sweep on a single rank.
#pragma once

#include <mpi.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <exception>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <type_traits>
#include <vector>

#include "runner/plan/task_outcome.hpp"
#include "runner/text/formatted_error.hpp"

namespace rodsweep {

enum class Tag : int { assign = 1, stop, finish, report, interrupted, alive, gone };

/// Master to worker: run this task after those assigned before.
struct Assign {
  static constexpr Tag tag = Tag::assign;
  std::int64_t task = 0;
};

/// Master to worker: abandon all your tasks, report each, wait for Finish.
struct Stop {
  static constexpr Tag tag = Tag::stop;
};

/// Master to worker: no more tasks; exit.
struct Finish {
  static constexpr Tag tag = Tag::finish;
  bool ranks_lost = false;  ///< make no collective call; send Gone when your results are on disk
};

/// Worker to master: one per Assign.
struct Report {
  static constexpr Tag tag = Tag::report;
  std::int64_t task = 0;
  TaskOutcome outcome = TaskOutcome::pending;  ///< pending: abandoned, nothing was written
  double busy_s = 0;                           ///< wall time, writing included
  std::array<char, 200> text{};                ///< error message, truncated; ends with a zero

  Report() = default;
  Report(std::int64_t task, TaskOutcome outcome, double busy_s, std::string_view message);
  std::string_view message() const { return text.data(); }
};

/// Worker to master, about every second: a heartbeat.
struct Alive {
  static constexpr Tag tag = Tag::alive;
  std::int64_t saved = 0;  ///< number of its finished tasks that are on disk, in order of finishing
};

/// Worker to master: all its results are on disk; it exits.
struct Gone {
  static constexpr Tag tag = Tag::gone;
};

/// Worker to master: this rank received a signal; stop the sweep.
struct Interrupted {
  static constexpr Tag tag = Tag::interrupted;
  int signal = 0;
};

/// A message that violates the protocol: a bug.
struct ProtocolError : FormattedError<std::logic_error> {
  using FormattedError::FormattedError;
};

struct Envelope {
  int source = 0;
  Tag tag{};
  std::size_t bytes = 0;
};

class Channel {
 public:
  virtual ~Channel() = default;
  virtual int rank() const = 0;
  virtual int size() const = 0;
  /// The next message, if one has arrived. It stays in the queue until receive().
  virtual std::optional<Envelope> probe() = 0;
  virtual void send_bytes(int destination, Tag tag, const void* data, std::size_t bytes) = 0;
  virtual void receive_bytes(const Envelope& envelope, void* data) = 0;

  template <class Message>
  void send(int destination, const Message& message) {
    static_assert(std::is_trivially_copyable_v<Message>);
    send_bytes(destination, Message::tag, &message, sizeof message);
  }

  template <class Message>
  Message receive(const Envelope& envelope) {
    static_assert(std::is_trivially_copyable_v<Message>);
    if (envelope.tag != Message::tag || envelope.bytes != sizeof(Message)) unexpected(envelope);
    Message message;
    receive_bytes(envelope, &message);
    return message;
  }

  /// Throws ProtocolError with the message's tag, size and source.
  [[noreturn]] void unexpected(const Envelope& envelope) const;
};

/// Mailboxes of `size` ranks in one thread. Must outlive its channels.
class MemoryNetwork {
 public:
  explicit MemoryNetwork(int size);
  Channel& operator[](int rank) { return endpoints_[static_cast<std::size_t>(rank)]; }

 private:
  struct Letter {
    Envelope envelope;
    std::vector<char> data;
  };

  class Endpoint : public Channel {
   public:
    Endpoint(MemoryNetwork& network, int rank) : network_(&network), rank_(rank) {}
    int rank() const override { return rank_; }
    int size() const override { return static_cast<int>(network_->endpoints_.size()); }
    std::optional<Envelope> probe() override;
    void send_bytes(int destination, Tag tag, const void* data, std::size_t bytes) override;
    void receive_bytes(const Envelope& envelope, void* data) override;

   private:
    MemoryNetwork* network_;
    int rank_;
    std::deque<Letter> inbox_;
  };

  std::vector<Endpoint> endpoints_;
};

/// Polling that leaves the core to other ranks: a short spin with sched_yield, then sleeps that grow from 50 us to 2 ms.
/// Open MPI's blocking calls spin forever and take a core away from the workers.
class Backoff {
 public:
  void wait();                  ///< no message: wait, longer each time
  void reset() { polls_ = 0; }  ///< a message arrived

 private:
  int polls_ = 0;
  std::chrono::microseconds pause_{};
};

/// The channel between ranks of an MPI communicator; uses a duplicate of it. Throws MpiError.
///
/// Sends with MPI_Isend, because MPI_Send to a rank on a dead host never returns.
class MpiChannel : public Channel {
 public:
  explicit MpiChannel(MPI_Comm comm);  ///< collective
  /// Collective, except during stack unwinding: the other ranks may never get here, and waiting for them would block
  /// the error message.
  ~MpiChannel() override;
  /// Leaks the communicator and all pending messages. After a rank is lost, the collective MPI_Comm_free would hang.
  void abandon();
  MpiChannel(const MpiChannel&) = delete;
  MpiChannel& operator=(const MpiChannel&) = delete;

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  std::optional<Envelope> probe() override;
  void send_bytes(int destination, Tag tag, const void* data, std::size_t bytes) override;
  void receive_bytes(const Envelope& envelope, void* data) override;

 private:
  struct Outgoing {
    std::unique_ptr<char[]> data;
    MPI_Request request = MPI_REQUEST_NULL;
  };

  void forget_sent();

  MPI_Comm comm_ = MPI_COMM_NULL;
  int rank_ = 0, size_ = 1;
  std::vector<Outgoing> outgoing_;
  int exceptions_ = std::uncaught_exceptions();  ///< at construction
};

}  // namespace rodsweep
