// SPDX-License-Identifier: Apache-2.0
// Measures GPU time with timestamp queries.
#ifndef QUINTET_GPU_TIMER_H
#define QUINTET_GPU_TIMER_H

#include <cstdint>

#include "gpu/commands.h"

namespace quintet::gpu {

class Timer {
 public:
  Timer(Context& context, std::uint32_t markCount);
  ~Timer();
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;
  void reset(Commands& commands);  // required before the first mark of a submission
  void mark(Commands& commands, std::uint32_t index);
  // The submission with the marks must have ended. Without timestamps both functions return 0.
  // Returns the seconds since a fixed time of the device.
  double stamp(std::uint32_t index) const;
  // Returns the seconds between two marks.
  double seconds(std::uint32_t first, std::uint32_t second) const;

 private:
  std::uint64_t ticks(std::uint32_t index) const;
  Context& context_;
  VkQueryPool pool_ = VK_NULL_HANDLE;
  std::uint32_t count_ = 0;
};

}  // namespace quintet::gpu
#endif
