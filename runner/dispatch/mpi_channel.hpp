// The channel between ranks of an MPI communicator; messages travel on a duplicate of it. Throws MpiError.
//
// Messages are sent without waiting: to a rank whose connection is broken, since its host died, MPI_Send never returns.
#pragma once

#include <mpi.h>

#include <exception>
#include <memory>
#include <vector>

#include "runner/dispatch/channel.hpp"

namespace rodsweep {

class MpiChannel : public Channel {
 public:
  explicit MpiChannel(MPI_Comm comm);  ///< collective
  /// Collective too, unless an exception unwinds this rank: the others need not be on their way here, and it must not
  /// wait for them before it can say what happened.
  ~MpiChannel() override;
  /// Leaves the communicator to the end of the process, with all that is under way: a rank is lost that would have to
  /// free it too.
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
  int exceptions_ = std::uncaught_exceptions();  ///< under way when this was made
};

}  // namespace rodsweep
