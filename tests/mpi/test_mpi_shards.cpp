// Shards on 1, 2 and 4 ranks: every rank gets all shards in order, whichever rank computes them.

#include "runner/training/training.hpp"
#include "tests/catch.hpp"

namespace rodsweep {
namespace test_mpi_shards {

TEST_CASE("every rank has all shards, in order, each computed by one rank") {
  constexpr std::size_t size = 3;
  for (const int count : {1, 3, 4, 7}) {
    CAPTURE(count);
    ShardExchange exchange(MPI_COMM_WORLD, count, size);
    for (const int step : {0, 1}) {
      std::vector<int> mine;
      const bool stops = exchange.gather(
          [&](const std::vector<Trainer::Shard>& own) {
            for (const auto& [shard, out] : own) {
              mine.push_back(shard);
              for (std::size_t i = 0; i < size; ++i)
                out[i] = static_cast<float>(100 * step + 10 * shard) + static_cast<float>(i);
            }
          },
          false);
      CHECK_FALSE(stops);
      for (const int shard : mine) CHECK(exchange.is_mine(shard));
      REQUIRE(exchange.shards().size() == static_cast<std::size_t>(count));
      for (int shard = 0; shard < count; ++shard)
        for (std::size_t i = 0; i < size; ++i)
          CHECK(exchange.shards()[static_cast<std::size_t>(shard)][i] ==
                static_cast<float>(100 * step + 10 * shard) + static_cast<float>(i));
      int computed = static_cast<int>(mine.size());
      MPI_Allreduce(MPI_IN_PLACE, &computed, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
      CHECK(computed == count);
    }
  }
}

TEST_CASE("one rank that wants to stop stops all, also one that has no shard") {
  ShardExchange exchange(MPI_COMM_WORLD, 2, 1);
  const auto compute = [](const std::vector<Trainer::Shard>& own) {
    for (const Trainer::Shard& shard : own) *shard.out = 1;
  };
  for (int rank = 0; rank < exchange.ranks(); ++rank) {
    CHECK(exchange.gather(compute, exchange.rank() == rank));
    CHECK_FALSE(exchange.gather(compute, false));
  }
}

TEST_CASE("values that one rank has are shared bit for bit") {
  const ShardExchange exchange(MPI_COMM_WORLD, 1, 1);
  std::vector<double> values(5);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (exchange.is_mine(static_cast<std::int64_t>(i))) values[i] = 1.0 / (3.0 + static_cast<double>(i));
  exchange.share(values);
  for (std::size_t i = 0; i < values.size(); ++i) CHECK(values[i] == 1.0 / (3.0 + static_cast<double>(i)));
}

}  // namespace test_mpi_shards
}  // namespace rodsweep
