// GPU time between marks, by timestamp queries.
#ifndef QUINTET_GPU_TIMER_H
#define QUINTET_GPU_TIMER_H

#include "gpu/commands.h"

namespace quintet::gpu {

class Timer {
 public:
  Timer(Context& context, std::uint32_t markCount);
  ~Timer();
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;
  void reset(Commands& commands);  // before the first mark of a submission
  void mark(Commands& commands, std::uint32_t index);
  // Seconds of a mark since some fixed moment of the device, of a submission that has ended; 0 without timestamps.
  double stamp(std::uint32_t index) const;
  // Seconds between two marks of a submission that has ended; 0 if the device has no timestamps.
  double seconds(std::uint32_t first, std::uint32_t second) const;

 private:
  std::uint64_t ticks(std::uint32_t index) const;
  Context& context_;
  VkQueryPool pool_ = VK_NULL_HANDLE;
  std::uint32_t count_ = 0;
};

}  // namespace quintet::gpu
#endif
