#include "solver/factor/elimination_order.hpp"

#include <metis.h>

#include <algorithm>
#include <csignal>
#include <mutex>
#include <new>

namespace rodsweep {
namespace {

/// METIS replaces the handlers of SIGTERM and SIGABRT during a call and uses the C library's global random generator.
/// Therefore one call runs at a time, and SIGTERM is blocked until its end.
class MetisCall {
 public:
  MetisCall() : one_(mutex()) {
    sigset_t stop;
    sigemptyset(&stop);
    sigaddset(&stop, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &stop, &before_);
  }
  ~MetisCall() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  MetisCall(const MetisCall&) = delete;
  MetisCall& operator=(const MetisCall&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex only;
    return only;
  }
  std::lock_guard<std::mutex> one_;
  sigset_t before_{};
};

}  // namespace

std::vector<int> nested_dissection_order(const BlockMatrix& pattern) {
  static_assert(sizeof(idx_t) == sizeof(int));
  idx_t n = pattern.block_rows();
  std::vector<idx_t> start{0}, neighbours;
  for (int row = 0; row < n; ++row) {
    for (int k = pattern.row_begin(row); k < pattern.row_end(row); ++k)
      if (pattern.column(k) != row) neighbours.push_back(pattern.column(k));
    start.push_back(static_cast<idx_t>(neighbours.size()));
  }
  if (neighbours.empty()) return {};
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_NUMBERING] = 0;
  options[METIS_OPTION_SEED] = 1;
  std::vector<idx_t> order(at(n)), place(order);  // in the order of elimination, and its inverse
  const MetisCall call;
  const int done = METIS_NodeND(&n, start.data(), neighbours.data(), nullptr, options, order.data(), place.data());
  if (done == METIS_ERROR_MEMORY) throw std::bad_alloc();  // another order would give other bits
  if (done != METIS_OK) return {};
  std::reverse(order.begin(), order.end());
  return order;
}

}  // namespace rodsweep
