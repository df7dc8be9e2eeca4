#include "solver/linear/elimination_order.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>

namespace rodsweep {

bool fills_in(const BlockMatrix& pattern, const std::vector<int>& order) {
  std::vector<std::size_t> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[static_cast<std::size_t>(order[i])] = i;
  const auto place_of = [&](int row) { return place[static_cast<std::size_t>(row)]; };
  std::vector<int> left;  // neighbours of a row that are eliminated after it
  for (const int row : order) {
    left.clear();
    for (int k = pattern.row_begin(row); k < pattern.row_end(row); ++k)
      if (place_of(pattern.column(k)) < place_of(row)) left.push_back(pattern.column(k));
    if (left.empty()) continue;
    // Enough that the next of them knows the others: whom that leaves uncoupled is found at its own elimination.
    const int next =
        *std::max_element(left.begin(), left.end(), [&](int a, int b) { return place_of(a) < place_of(b); });
    for (const int other : left)
      if (pattern.find(next, other) < 0) return true;
  }
  return false;
}

std::vector<int> minimum_degree_order(const BlockMatrix& pattern) {
  std::vector<Eigen::Triplet<double>> couplings;
  for (int row = 0; row < pattern.block_rows(); ++row)
    for (int k = pattern.row_begin(row); k < pattern.row_end(row); ++k)
      couplings.emplace_back(row, pattern.column(k), 1);
  Eigen::SparseMatrix<double> graph(pattern.block_rows(), pattern.block_rows());
  graph.setFromTriplets(couplings.begin(), couplings.end());
  Eigen::PermutationMatrix<Eigen::Dynamic> permutation;
  Eigen::AMDOrdering<int>()(graph, permutation);  // indices: rows in the order of their elimination
  std::vector<int> order(permutation.indices().begin(), permutation.indices().end());
  std::reverse(order.begin(), order.end());
  return order;
}

}  // namespace rodsweep
