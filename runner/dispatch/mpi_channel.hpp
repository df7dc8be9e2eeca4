// The channel between ranks of an MPI communicator; uses a duplicate of it. Throws MpiError.
//
// Sends with MPI_Isend, because MPI_Send to a rank on a dead host never returns.
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
