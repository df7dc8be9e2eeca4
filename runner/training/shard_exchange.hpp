// What ranks that train together tell each other. Nobody is master: every rank computes its shards of a step, and gets
// those of the others; sums are then formed in the order of shards on every rank, so that all have the same bits,
// which are also those of one rank alone.
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
  /// Collective. `size`: numbers of a shard.
  ShardExchange(MPI_Comm comm, int shards, std::size_t size);

  int rank() const { return rank_; }
  int ranks() const { return ranks_; }
  bool is_mine(std::int64_t part) const {
    return part % ranks_ == rank_;
  }  ///< a shard, or anything else that is shared

  using Compute = std::function<void(const std::vector<Trainer::Shard>& own)>;

  /// Collective: computes this rank's shards and gathers all. Returns whether any rank was given `stop`.
  bool gather(const Compute& compute, bool stop);
  /// As gathered last, in order.
  const std::vector<const float*>& shards() const { return shards_; }

  /// Collective: entries that one rank has set and the others left zero, on every rank.
  void share(std::vector<double>& values) const;

 private:
  std::size_t first_of(int rank) const { return static_cast<std::size_t>(first_[static_cast<std::size_t>(rank)]); }

  MPI_Comm comm_;
  int rank_ = 0, ranks_ = 1, count_;
  std::size_t size_;
  std::vector<int> first_, length_;  ///< each rank's part of `numbers_`: whether it stops, then its shards
  std::vector<float> numbers_;
  std::vector<const float*> shards_;
};

}  // namespace rodsweep
