// SPDX-License-Identifier: Apache-2.0
// The latest values of a quantity, for a graph.
#ifndef QUINTET_VIEWER_RATE_HISTORY_H
#define QUINTET_VIEWER_RATE_HISTORY_H

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace quintet::viewer {

class RateHistory {
 public:
  static constexpr std::size_t kLength = 240;

  void add(float value) {
    values_[next_] = value;
    next_ = (next_ + 1) % kLength;
    count_ = std::min(count_ + 1, kLength);
  }
  // Oldest first.
  std::vector<float> values() const {
    std::vector<float> result;
    for (std::size_t i = 0; i < count_; ++i) result.push_back(values_[(next_ + kLength - count_ + i) % kLength]);
    return result;
  }
  bool empty() const { return count_ == 0; }
  float latest() const { return values_[(next_ + kLength - 1) % kLength]; }  // 0 if empty
  float largest() const {
    float result = 0.0f;
    for (const float value : values()) result = std::max(result, value);
    return result;
  }

 private:
  std::array<float, kLength> values_{};
  std::size_t next_ = 0, count_ = 0;
};

}  // namespace quintet::viewer
#endif
