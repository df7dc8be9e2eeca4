#include "solver/contact/delassus_operator.hpp"

#include <algorithm>
#include <utility>

namespace rodsweep {
namespace {

Block6 transposed(const Block6& block) {
  Block6 out{};
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c) out.column[r][c] = block.column[c][r];
  return out;
}

}  // namespace

void DelassusOperator::clear() {
  for (const int segment : touched_) place_[at(segment)] = -1;
  touched_.clear();
  known_ = 0;
  is_full_ = false;
}

void DelassusOperator::touch(int segment) {
  if (place_[at(segment)] >= 0) return;
  if (touched_.size() == most_touched_) {
    is_full_ = true;
    return;
  }
  place_[at(segment)] = static_cast<int>(touched_.size());
  touched_.push_back(segment);
}

void DelassusOperator::grow() {
  if (touched_.size() <= stride_) return;
  const std::size_t stride = std::max(touched_.size(), stride_ + stride_ / 2);
  grown_.resize(stride * stride);
  for (std::size_t by = 0; by < known_; ++by)
    std::copy_n(blocks_.data() + by * stride_, known_, grown_.data() + by * stride);
  std::swap(blocks_, grown_);
  stride_ = stride;
}

void DelassusOperator::update(const Rod& rod, RodResponse& response) {
  if (is_full_) return;
  grow();
  for (std::size_t by = known_; by < touched_.size(); ++by) {
    response.load(rod, touched_[by]);
    for (std::size_t of = 0; of < touched_.size(); ++of) {
      blocks_[by * stride_ + of] = response.compliance(rod, touched_[of]);
      if (of < known_) blocks_[of * stride_ + by] = transposed(blocks_[by * stride_ + of]);
    }
  }
  known_ = touched_.size();
}

}  // namespace rodsweep
