#include "runner/training/training.hpp"

#include <limits>
#include <stdexcept>

#include "runner/mpi/mpi_session.hpp"

namespace rodsweep {

ShardExchange::ShardExchange(MPI_Comm comm, int shards, std::size_t size) : comm_(comm), count_(shards), size_(size) {
  rank_ = rank_in(comm);
  ranks_ = ranks_in(comm);
  const std::size_t total = static_cast<std::size_t>(ranks_) + static_cast<std::size_t>(shards) * size;
  if (total > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw std::length_error("the gradients of all shards exceed the largest count of MPI: use fewer shards");
  int first = 0;
  for (int rank = 0; rank < ranks_; ++rank) {
    const int own = shards / ranks_ + (rank < shards % ranks_ ? 1 : 0);
    first_.push_back(first);
    length_.push_back(1 + own * static_cast<int>(size));
    first += length_.back();
  }
  numbers_.resize(total);
  for (int shard = 0; shard < shards; ++shard)
    shards_.push_back(numbers_.data() + first_of(shard % ranks_) + 1 + static_cast<std::size_t>(shard / ranks_) * size);
}

bool ShardExchange::gather(const Compute& compute, bool stop) {
  float* own = numbers_.data() + first_of(rank_);
  *own++ = stop ? 1.F : 0.F;
  std::vector<Trainer::Shard> shards;
  for (int shard = rank_; shard < count_; shard += ranks_, own += size_) shards.push_back({shard, own});
  compute(shards);
  if (ranks_ == 1) return stop;
  check_mpi(MPI_Allgatherv(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, numbers_.data(), length_.data(), first_.data(),
                           MPI_FLOAT, comm_),
            "MPI_Allgatherv");
  bool stops = false;
  for (int rank = 0; rank < ranks_; ++rank) stops = stops || numbers_[first_of(rank)] != 0;
  return stops;
}

void ShardExchange::share(std::vector<double>& values) const {
  if (ranks_ == 1) return;
  check_mpi(MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, comm_),
            "MPI_Allreduce");
}

}  // namespace rodsweep
