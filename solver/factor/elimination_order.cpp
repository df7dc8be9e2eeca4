#include "solver/factor/elimination_order.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <numeric>

namespace rodsweep {

std::vector<int> given_order(const BlockMatrix& pattern) {
  std::vector<int> order(at(pattern.block_rows()));
  std::iota(order.begin(), order.end(), 0);
  return order;
}

std::vector<int> inverse(const std::vector<int>& order) {
  std::vector<int> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[at(order[i])] = static_cast<int>(i);
  return place;
}

bool fills_in(const BlockMatrix& pattern, const std::vector<int>& order) {
  const std::vector<int> place = inverse(order);
  const auto place_of = [&](int row) { return place[at(row)]; };
  std::vector<int> left;  // neighbours of a row that are eliminated after it
  for (const int row : order) {
    left.clear();
    for (int k = pattern.row_begin(row); k < pattern.row_end(row); ++k)
      if (place_of(pattern.column(k)) < place_of(row)) left.push_back(pattern.column(k));
    if (left.empty()) continue;
    // It suffices to check the next of them against the others: pairs of others are checked at its elimination.
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

namespace {

/// Appends the connected part around `first` to `order`, by distance; returns where the last distance begins.
std::size_t append_part(const BlockMatrix& pattern, int first, std::vector<bool>& seen, std::vector<int>& order) {
  const auto degree = [&](int row) { return pattern.row_end(row) - pattern.row_begin(row); };
  std::size_t level = order.size(), next_level = level + 1;
  order.push_back(first);
  seen[at(first)] = true;
  for (std::size_t i = level; i < order.size(); ++i) {
    if (i == next_level) {
      level = i;
      next_level = order.size();
    }
    const auto found = static_cast<std::ptrdiff_t>(order.size());
    const int row = order[i];
    for (int k = pattern.row_begin(row); k < pattern.row_end(row); ++k) {
      const int column = pattern.column(k);
      if (!seen[at(column)]) order.push_back(column);
      seen[at(column)] = true;
    }
    std::stable_sort(order.begin() + found, order.end(), [&](int a, int b) { return degree(a) < degree(b); });
  }
  return level;
}

}  // namespace

std::vector<int> breadth_first_order(const BlockMatrix& pattern) {
  std::vector<bool> seen(at(pattern.block_rows()), false);
  std::vector<int> order;
  for (int row = 0; row < pattern.block_rows(); ++row) {
    if (seen[at(row)]) continue;
    const std::size_t begin = order.size();
    int first = row;
    for (int tries = 0; tries < 3; ++tries) {  // from the far end of the last try, which is peripheral
      const std::size_t last = append_part(pattern, first, seen, order);
      first = *std::min_element(order.begin() + static_cast<std::ptrdiff_t>(last), order.end(), [&](int a, int b) {
        return pattern.row_end(a) - pattern.row_begin(a) < pattern.row_end(b) - pattern.row_begin(b);
      });
      for (std::size_t i = begin; i < order.size(); ++i) seen[at(order[i])] = false;
      order.resize(begin);
    }
    append_part(pattern, first, seen, order);
  }
  return order;
}

}  // namespace rodsweep
