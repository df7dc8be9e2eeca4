#include "solver/factor/assembly_tree.hpp"

#include <algorithm>
#include <utility>

#include "solver/factor/elimination_order.hpp"

namespace rodsweep {
namespace {

/// A front during the merging of supernodes.
struct Front {
  std::vector<int> columns{};  ///< of the elimination tree
  int parent = -1;             ///< front
  int rows = 0;                ///< of R
  std::int64_t entries = 0;    ///< blocks of L without padding
};

/// Whether a merged front with this padding is cheaper. Zeros cost less than the edges of small fronts.
bool worth_merging(std::int64_t columns, std::int64_t stored, std::int64_t zeros) {
  const double share = static_cast<double>(zeros) / static_cast<double>(stored);
  return share < (columns <= 4 ? 0.5 : columns <= 8 ? 0.25 : columns <= 16 ? 0.1 : 0.05);
}

/// Chains of columns with the same rows, children before parents.
std::vector<Front> fundamental(const EliminationTree& tree) {
  std::vector<Front> fronts;
  std::vector<int> front_of(tree.row.size());
  for (int k = 0; k < tree.columns(); ++k) {
    const bool goes_on = k > 0 && tree.parent[at(k - 1)] == k && tree.count[at(k - 1)] == tree.count[at(k)] + 1;
    if (!goes_on) fronts.emplace_back();
    Front& front = fronts.back();
    front_of[at(k)] = static_cast<int>(fronts.size()) - 1;
    front.columns.push_back(k);
    front.rows = tree.count[at(k)] - 1;
    front.entries += tree.count[at(k)];
  }
  for (Front& front : fronts) {
    const int parent = tree.parent[at(front.columns.back())];
    front.parent = parent == -1 ? -1 : front_of[at(parent)];
  }
  return fronts;
}

/// Merges children into every front, from the leaves on, if that is cheaper. A merged child has no columns left.
void merge(std::vector<Front>& fronts) {
  std::vector<std::vector<int>> children(fronts.size());
  std::vector<int> into(fronts.size());
  for (int f = 0; f < static_cast<int>(fronts.size()); ++f) {
    into[at(f)] = f;
    Front& front = fronts[at(f)];
    std::sort(children[at(f)].begin(), children[at(f)].end(), [&](int a, int b) {
      return std::make_pair(-fronts[at(a)].rows, a) < std::make_pair(-fronts[at(b)].rows, b);
    });
    std::vector<int> left, taken, first;
    std::size_t width = front.columns.size();
    for (const int c : children[at(f)]) {
      Front& child = fronts[at(c)];
      const auto columns = static_cast<std::int64_t>(width + child.columns.size());
      const std::int64_t stored = columns * (columns + 1) / 2 + columns * front.rows;
      if (!worth_merging(columns, stored, stored - front.entries - child.entries)) {
        left.push_back(c);
        continue;
      }
      taken.push_back(c);
      width = static_cast<std::size_t>(columns);
      front.entries += child.entries;
    }
    if (!taken.empty()) {
      for (const int c : taken) {
        first.insert(first.end(), fronts[at(c)].columns.begin(), fronts[at(c)].columns.end());
        fronts[at(c)].columns.clear();
        left.insert(left.end(), children[at(c)].begin(), children[at(c)].end());
        into[at(c)] = f;
      }
      first.insert(first.end(), front.columns.begin(), front.columns.end());
      front.columns = std::move(first);
      for (const int c : left) fronts[at(c)].parent = f;
      children[at(f)] = std::move(left);
    }
    if (front.parent != -1) children[at(front.parent)].push_back(f);
  }
}

/// Children before parents; among siblings first the one that releases the most memory.
std::vector<int> order_of_fronts(const std::vector<Front>& fronts) {
  std::vector<std::vector<int>> children(fronts.size());
  std::vector<double> peak(fronts.size(), 0);
  const auto update = [&](int f) { return static_cast<double>(fronts[at(f)].rows) * fronts[at(f)].rows; };
  std::vector<int> roots;
  for (int f = 0; f < static_cast<int>(fronts.size()); ++f) {
    if (fronts[at(f)].columns.empty()) continue;
    std::vector<int>& own = children[at(f)];
    std::stable_sort(own.begin(), own.end(),
                     [&](int a, int b) { return peak[at(a)] - update(a) > peak[at(b)] - update(b); });
    double waiting = 0;
    for (const int c : own) {
      peak[at(f)] = std::max(peak[at(f)], waiting + peak[at(c)]);
      waiting += update(c);
    }
    peak[at(f)] = std::max(peak[at(f)], waiting + update(f));
    (fronts[at(f)].parent == -1 ? roots : children[at(fronts[at(f)].parent)]).push_back(f);
  }
  std::vector<int> order, stack(roots.rbegin(), roots.rend());  // parents first, their last child next
  while (!stack.empty()) {
    const int f = stack.back();
    stack.pop_back();
    order.push_back(f);
    stack.insert(stack.end(), children[at(f)].begin(), children[at(f)].end());
  }
  std::reverse(order.begin(), order.end());
  return order;
}

}  // namespace

AssemblyTree::AssemblyTree(const EliminationTree& tree) {
  std::vector<Front> fronts = fundamental(tree);
  merge(fronts);
  const std::vector<int> order = order_of_fronts(fronts);
  std::vector<int> place(fronts.size(), -1);
  for (std::size_t s = 0; s < order.size(); ++s) place[at(order[s])] = static_cast<int>(s);

  std::vector<int> depth(order.size(), 0);
  for (const int f : order) {
    const Front& front = fronts[at(f)];
    Supernode node{};
    node.first = static_cast<int>(row.size());
    node.columns = static_cast<int>(front.columns.size());
    node.parent = front.parent == -1 ? -1 : place[at(front.parent)];
    node.row_count = front.rows;
    node.panel = panel_size;
    panel_size += node.panel_size();
    for (const int k : front.columns) row.push_back(tree.row[at(k)]);
    supernodes.push_back(node);
  }
  std::vector<std::vector<int>> children_of(order.size());
  for (int s = static_cast<int>(order.size()); s-- > 0;)
    if (supernodes[at(s)].parent != -1) depth[at(s)] = depth[at(supernodes[at(s)].parent)] + 1;
  std::array<std::size_t, 2> top{};
  for (int s = 0; s < static_cast<int>(order.size()); ++s) {
    Supernode& node = supernodes[at(s)];
    node.child_begin = static_cast<int>(children.size());
    children.insert(children.end(), children_of[at(s)].begin(), children_of[at(s)].end());
    node.child_end = static_cast<int>(children.size());
    node.stack = depth[at(s)] % 2;
    const auto stack = at(node.stack);
    node.update = top[stack];
    top[stack] += node.update_size();
    stack_size[stack] = std::max(stack_size[stack], top[stack]);
    for (const int c : children_of[at(s)]) top[1 - stack] -= supernodes[at(c)].update_size();
    if (node.parent != -1) children_of[at(node.parent)].push_back(s);
  }
}

void AssemblyTree::find_rows(const BlockMatrix& pattern) {
  const std::vector<int> column_of = inverse(row);
  std::vector<int> seen_by(row.size(), -1), place(row.size());
  for (int s = 0; s < static_cast<int>(supernodes.size()); ++s) {
    Supernode& node = supernodes[at(s)];
    const int end = node.first + node.columns;
    node.row_begin = static_cast<int>(rows.size());
    const auto see = [&](int column) {
      if (column >= end && std::exchange(seen_by[at(column)], s) != s) rows.push_back(column);
    };
    for (int k = node.first; k < end; ++k)
      for (int e = pattern.row_begin(row[at(k)]); e < pattern.row_end(row[at(k)]); ++e)
        see(column_of[at(pattern.column(e))]);
    for (int c = node.child_begin; c < node.child_end; ++c) {
      const Supernode& child = supernodes[at(children[at(c)])];
      for (int r = 0; r < child.row_count; ++r) see(rows[at(child.row_begin + r)]);
    }
    std::sort(rows.begin() + node.row_begin, rows.end());
    in_parent.resize(rows.size());

    for (int k = node.first; k < end; ++k) place[at(k)] = k - node.first;
    for (int r = 0; r < node.row_count; ++r) place[at(rows[at(node.row_begin + r)])] = node.columns + r;
    for (int c = node.child_begin; c < node.child_end; ++c) {
      const Supernode& child = supernodes[at(children[at(c)])];
      for (int r = child.row_begin; r < child.row_begin + child.row_count; ++r)
        in_parent[at(r)] = place[at(rows[at(r)])];
    }
  }
}

}  // namespace rodsweep
