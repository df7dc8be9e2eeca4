// The multifrontal Cholesky factorisation A = L L^T of matrices with fill-in (Duff & Reid 1983; assembly_tree.hpp
// describes the storage). From the leaves of the tree to its roots, every front gathers its blocks of A and the updates
// of its children, factorises its pivots, and passes its own update to its parent:
//
//   P = L L^T,   R <- R L^-T,   U <- sum of the children's U - R R^T
//
// Nearly all of the work is dense products. Nothing allocates after construction; the same matrix gives the same bits.
#pragma once

#include <vector>

#include "solver/factor/assembly_tree.hpp"

namespace rodsweep {

class MultifrontalFactor {
 public:
  /// `pattern` is that of the elimination tree from which `tree` was made.
  MultifrontalFactor(const BlockMatrix& pattern, AssemblyTree tree);

  /// Returns false if `a` is not positive definite; the factor is invalid then.
  bool factorise(const BlockMatrix& a);

  /// x <- A^-1 x with the matrix of the last factorise().
  void substitute(VectorX& x);
  void substitute(std::vector<Lane8>& x);  ///< as in BlockFactor

 private:
  struct Source {
    int block;       ///< of A
    std::size_t to;  ///< first entry in the panels
  };
  void add_update(const Supernode& child, const Supernode& node);
  void forward(const Supernode& node);
  void backward(const Supernode& node);
  void forward_in_lanes(const Supernode& node);
  void backward_in_lanes(const Supernode& node);
  double* update_of(const Supernode& node) { return entries(stacks_[at(node.stack)]) + node.update; }
  static double* entries(std::vector<Lane8>& of) { return reinterpret_cast<double*>(of.data()); }

  AssemblyTree tree_;
  std::vector<Source> sources_;          ///< sorted by front
  std::vector<std::size_t> source_end_;  ///< of every front
  std::vector<Lane8> panels_;
  std::array<std::vector<Lane8>, 2> stacks_;
  std::vector<double> inverse_pivot_;
  std::vector<double> solution_;  ///< in the order of elimination
  std::vector<Lane8> pivots_;     ///< solution at one front's pivots
  std::vector<Lane8> known_;      ///< solution at one front's rows
  std::vector<Lane8> solutions_;  ///< of eight right-hand sides, in the order of elimination
};

}  // namespace rodsweep
