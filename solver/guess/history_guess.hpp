// The part of guesses that are made from earlier solutions: a history for each rod and Newton iteration j, with the
// solutions of iteration j of the last steps. A step without a solution at that iteration starts it again.
#pragma once

#include <algorithm>
#include <vector>

#include "solver/guess/initial_guess.hpp"

namespace rodsweep {

/// Which solutions a history has, and their places in a ring.
struct RecentSteps {
  int size;         ///< solutions at most
  int known = 0;    ///< solutions of consecutive steps
  int newest = -1;  ///< place of the last one
  int last_step = -2;

  /// Solutions that a step can use.
  int usable(int step) const { return last_step == step - 1 ? known : 0; }
  int place(int age) const { return (newest - age + size) % size; }
  /// Writes the places of the known ones, the newest first.
  void put_order(Eigen::VectorXi& order) const {
    for (int age = 0; age < known; ++age) order[age] = place(age);
  }
  /// Makes `newest` the place of a step's solution.
  void add(int step) {
    known = usable(step);
    newest = known == 0 ? 0 : (newest + 1) % size;
    known = std::min(known + 1, size);
    last_step = step;
  }
};

/// `History` is RecentSteps with its solutions, of which keep() sets the newest.
template <class History>
class HistoryGuess : public InitialGuess {
 public:
  explicit HistoryGuess(int newton_iterations) : newton_iterations_(newton_iterations) {}
  void accept_total(int rod, int step, const VectorX& total) override {
    History& h = history({step, 0, rod});
    if (h.last_step == step) h.keep(total);
  }

 protected:
  void add_rod(const History& none) { histories_.insert(histories_.end(), rodsweep::at(newton_iterations_), none); }
  History& history(const SolvePosition& at) {
    return histories_[static_cast<std::size_t>(at.rod * newton_iterations_ + at.newton)];
  }

 private:
  int newton_iterations_;
  std::vector<History> histories_;
};

}  // namespace rodsweep
