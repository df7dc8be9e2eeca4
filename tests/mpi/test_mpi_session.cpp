// Collective set-up: after an error on one rank, all ranks report the same text. Runs on several numbers of ranks.

#include "runner/mpi/mpi_session.hpp"
#include "tests/catch.hpp"
#include "tests/mpi/world.hpp"

using namespace rodsweep;

TEST_CASE("what all ranks do without an error raises none") {
  int done = 0;
  collectively(MPI_COMM_WORLD, [&] { ++done; });
  CHECK(done == 1);
}

TEST_CASE("an error of rank 0 is thrown by every rank, in its words") {
  const auto part = [] {
    if (own_rank() == 0) throw std::runtime_error("job.json: no such file");
  };
  CHECK_THROWS_WITH(collectively(MPI_COMM_WORLD, part), "job.json: no such file");
}

TEST_CASE("of several errors the lowest rank's is thrown by every rank, and names it") {
  if (rank_count() == 1) return;
  const auto part = [] {
    if (own_rank() > 0) throw std::runtime_error("cannot open out.h5");
  };
  CHECK_THROWS_WITH(collectively(MPI_COMM_WORLD, part), "rank 1: cannot open out.h5");
}

TEST_CASE("a text of any size travels from rank 0") {
  for (const std::size_t size : {0, 5, 3000000}) {
    const std::string text(size, 'x');
    CHECK(broadcast(own_rank() == 0 ? text : "mine", MPI_COMM_WORLD) == text);
  }
}

TEST_CASE("the least of all ranks' values is known to every rank") {
  CHECK(min_over_ranks(10.0 - own_rank(), MPI_COMM_WORLD) == 11.0 - rank_count());
}

TEST_CASE("placement counts workers without the master, and cores once") {
  const Placement here = placement(MPI_COMM_WORLD);
  CHECK(here.workers == std::max(1, rank_count() - 1));
  CHECK(here.cores >= 1);
  CHECK(here.oversubscribed == (here.workers > here.cores));
}

TEST_CASE("a failing MPI call is named") {
  CHECK_THROWS_WITH(broadcast(1, MPI_COMM_NULL), Catch::Matchers::StartsWith("MPI_Bcast failed: MPI_ERR_COMM"));
}
