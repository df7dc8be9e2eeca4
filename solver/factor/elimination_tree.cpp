#include "solver/factor/elimination_tree.hpp"

#include <numeric>
#include <utility>

#include "solver/factor/elimination_order.hpp"

namespace rodsweep {
namespace {

/// Parents of columns that are in the order of elimination.
std::vector<int> parents(const BlockMatrix& pattern, const std::vector<int>& row, const std::vector<int>& place) {
  std::vector<int> parent(row.size(), -1), ancestor(row.size(), -1);
  for (int k = 0; k < static_cast<int>(row.size()); ++k)
    for (int e = pattern.row_begin(row[at(k)]); e < pattern.row_end(row[at(k)]); ++e)
      for (int i = place[at(pattern.column(e))]; i != -1 && i < k;) {
        const int next = std::exchange(ancestor[at(i)], k);  // shortens the next climb
        if (next == -1) parent[at(i)] = k;
        i = next;
      }
  return parent;
}

/// Counts blocks of the columns of L by the row subtrees: column j is a leaf of row i's subtree if A has (i, j) and no
/// descendant of j has it.
class ColumnCounts {
 public:
  ColumnCounts(const BlockMatrix& pattern, const EliminationTree& tree)
      : parent_(tree.parent),
        place_(inverse(tree.row)),
        first_(parent_.size(), -1),
        latest_first_(parent_.size(), -1),
        previous_leaf_(parent_.size(), -1),
        ancestor_(parent_.size()),
        count_(parent_.size()) {
    std::iota(ancestor_.begin(), ancestor_.end(), 0);
    for (int k = 0; k < tree.columns(); ++k) {
      count_[at(k)] = first_[at(k)] == -1 ? 1 : 0;
      for (int j = k; j != -1 && first_[at(j)] == -1; j = parent_[at(j)]) first_[at(j)] = k;
    }
    for (int j = 0; j < tree.columns(); ++j) {
      if (parent_[at(j)] != -1) --count_[at(parent_[at(j)])];
      for (int e = pattern.row_begin(tree.row[at(j)]); e < pattern.row_end(tree.row[at(j)]); ++e)
        see(place_[at(pattern.column(e))], j);
      if (parent_[at(j)] != -1) ancestor_[at(j)] = parent_[at(j)];
    }
    for (int j = 0; j < tree.columns(); ++j)
      if (parent_[at(j)] != -1) count_[at(parent_[at(j)])] += count_[at(j)];
  }
  std::vector<int> take() { return std::move(count_); }

 private:
  void see(int i, int j) {
    if (i <= j || first_[at(j)] <= latest_first_[at(i)]) return;
    latest_first_[at(i)] = first_[at(j)];
    const int previous = std::exchange(previous_leaf_[at(i)], j);
    ++count_[at(j)];
    if (previous == -1) return;
    int common = previous;
    while (common != ancestor_[at(common)]) common = ancestor_[at(common)];
    for (int s = previous; s != common;) s = std::exchange(ancestor_[at(s)], common);
    --count_[at(common)];
  }

  const std::vector<int>& parent_;
  std::vector<int> place_, first_, latest_first_, previous_leaf_, ancestor_, count_;
};

}  // namespace

std::int64_t EliminationTree::blocks() const { return std::accumulate(count.begin(), count.end(), std::int64_t{0}); }

double EliminationTree::flops() const {
  double sum = 0;
  for (const int c : count) sum += static_cast<double>(c) * c;
  return 6 * 6 * 6 * sum;
}

std::vector<int> postorder(const std::vector<int>& parent) {
  const int n = static_cast<int>(parent.size());
  std::vector<int> child(parent.size(), -1), sibling(parent.size(), -1), order, stack;
  order.reserve(parent.size());
  int root = -1;
  for (int k = n; k-- > 0;) {
    int& head = parent[at(k)] == -1 ? root : child[at(parent[at(k)])];
    sibling[at(k)] = std::exchange(head, k);
  }
  for (; root != -1; root = sibling[at(root)])
    for (stack.push_back(root); !stack.empty();) {
      const int top = stack.back();
      if (child[at(top)] != -1) {
        stack.push_back(std::exchange(child[at(top)], sibling[at(child[at(top)])]));
      } else {
        order.push_back(top);
        stack.pop_back();
      }
    }
  return order;
}

EliminationTree elimination_tree(const BlockMatrix& pattern, const std::vector<int>& order) {
  const std::vector<int> row(order.rbegin(), order.rend());
  const std::vector<int> parent = parents(pattern, row, inverse(row));
  const std::vector<int> post = postorder(parent), place = inverse(post);
  EliminationTree tree;
  for (const int k : post) {
    tree.row.push_back(row[at(k)]);
    tree.parent.push_back(parent[at(k)] == -1 ? -1 : place[at(parent[at(k)])]);
  }
  tree.count = ColumnCounts(pattern, tree).take();
  return tree;
}

}  // namespace rodsweep
