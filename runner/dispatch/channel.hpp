// Every message between master (rank 0) and workers, and the small interface that carries them.
//
// Messages are plain structs; between two ranks they arrive in the order in which they were sent. Sending never waits
// for the receiver (messages are far below any eager limit and at most a few per worker are under way); probing never
// waits. MpiChannel (runner/dispatch/mpi_channel.hpp) is the real one. MemoryNetwork is its twin in one process and one
// thread: it serves the tests of dispatch, and a sweep on a single rank.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <type_traits>
#include <vector>

#include "runner/plan/task_outcome.hpp"

namespace rodsweep {

enum class Tag : int { assign = 1, stop, finish, report, interrupted, alive, gone };

/// Master to worker: run these tasks after those that you have, together where they can be.
struct Assign {
  static constexpr Tag tag = Tag::assign;
  static constexpr std::size_t most = 8;
  std::uint64_t count = 0;
  std::array<std::int64_t, most> task{};

  void add(std::int64_t index) { task.at(count++) = index; }
  std::vector<std::int64_t> tasks() const { return {task.begin(), task.begin() + count}; }
};

/// Master to worker: abandon all your tasks, report each, wait for Finish.
struct Stop {
  static constexpr Tag tag = Tag::stop;
};

/// Master to worker: no more tasks; exit.
struct Finish {
  static constexpr Tag tag = Tag::finish;
  bool ranks_lost = false;  ///< make no collective call; answer Gone when your results are on disk
};

/// Worker to master: one for every task of every Assign.
struct Report {
  static constexpr Tag tag = Tag::report;
  std::int64_t task = 0;
  TaskOutcome outcome = TaskOutcome::pending;  ///< pending: abandoned, nothing was written
  double busy_s = 0;                           ///< wall time, writing included
  double share = 1;                            ///< of its work that was done; below 1 if abandoned
  std::array<char, 200> text{};                ///< what went wrong, cut if long; ends with a zero

  Report() = default;
  Report(std::int64_t task, TaskOutcome outcome, double busy_s, std::string_view message);
  std::string_view message() const { return text.data(); }
};

/// Worker to master, about every second: a heartbeat.
struct Alive {
  static constexpr Tag tag = Tag::alive;
  std::int64_t saved = 0;  ///< of the tasks that it finished, the first so many are on disk
};

/// Worker to master: all that it wrote is on disk; it exits.
struct Gone {
  static constexpr Tag tag = Tag::gone;
};

/// Worker to master: this rank received a signal; stop the sweep.
struct Interrupted {
  static constexpr Tag tag = Tag::interrupted;
  int signal = 0;
};

/// A message that does not belong to the protocol: a bug.
class ProtocolError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
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
  /// The next message that has arrived, if any; it stays until receive().
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

  /// Throws ProtocolError naming the message.
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

}  // namespace rodsweep
