// Exchanges gradients between the ranks of a training. There is no master: each rank computes its shards of a step and
// receives the others. Every rank sums in the order of shards, so that all ranks get the same bits, as does a single
// rank.
#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "network/training/trainer.hpp"

namespace rodsweep {

class ShardExchange {
 public:
  /// Collective. `size`: number of values in a shard.
  ShardExchange(MPI_Comm comm, int shards, std::size_t size);

  int rank() const { return rank_; }
  int ranks() const { return ranks_; }
  bool is_mine(std::int64_t part) const {
    return part % ranks_ == rank_;
  }  ///< for shards and any other distributed work

  using Compute = std::function<void(const std::vector<Trainer::Shard>& own)>;

  /// Collective: computes this rank's shards and gathers all. Returns whether any rank was given `stop`.
  bool gather(const Compute& compute, bool stop);
  /// All shards of the last gather(), in order.
  const std::vector<const float*>& shards() const { return shards_; }

  /// Collective sum. Each entry is set on one rank and zero on the others.
  void share(std::vector<double>& values) const;

 private:
  std::size_t first_of(int rank) const { return static_cast<std::size_t>(first_[static_cast<std::size_t>(rank)]); }

  MPI_Comm comm_;
  int rank_ = 0, ranks_ = 1, count_;
  std::size_t size_;
  std::vector<int> first_, length_;  ///< each rank's part of `numbers_`: stop flag, then its shards
  std::vector<float> numbers_;
  std::vector<const float*> shards_;
};

}  // namespace rodsweep
