// SPDX-License-Identifier: Apache-2.0
#include "gpu/timer.h"

#include <cassert>

#include "gpu/error.h"

namespace quintet::gpu {

Timer::Timer(Context& context, std::uint32_t markCount) : context_(context), count_(markCount) {
  if (context.info().timestampPeriod == 0.0f) return;
  VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
  info.queryType = VK_QUERY_TYPE_TIMESTAMP;
  info.queryCount = markCount;
  check(context.vk().vkCreateQueryPool(context.device(), &info, nullptr, &pool_), "create the timer's queries");
}

Timer::~Timer() {
  if (!pool_) return;
  context_.retire(
      [&context = context_, pool = pool_] { context.vk().vkDestroyQueryPool(context.device(), pool, nullptr); });
}

void Timer::reset(Commands& commands) {
  if (pool_) context_.vk().vkCmdResetQueryPool(commands.handle(), pool_, 0, count_);
}

void Timer::mark(Commands& commands, std::uint32_t index) {
  assert(index < count_);
  if (pool_) context_.vk().vkCmdWriteTimestamp2(commands.handle(), VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_, index);
}

std::uint64_t Timer::ticks(std::uint32_t index) const {
  std::uint64_t value = 0;
  check(context_.vk().vkGetQueryPoolResults(context_.device(), pool_, index, 1, sizeof value, &value, sizeof value,
                                            VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
        "read the timer");
  return value;
}

double Timer::stamp(std::uint32_t index) const {
  assert(index < count_);
  if (!pool_) return 0.0;
  return static_cast<double>(ticks(index)) * static_cast<double>(context_.info().timestampPeriod) * 1e-9;
}

double Timer::seconds(std::uint32_t first, std::uint32_t second) const {
  assert(first < count_ && second < count_);
  if (!pool_) return 0.0;
  // The counter wraps around at its valid bits, and so does the difference.
  const std::uint32_t bits = context_.info().timestampBits;
  const std::uint64_t mask = bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
  const std::uint64_t difference = (ticks(second) - ticks(first)) & mask;
  return static_cast<double>(difference) * static_cast<double>(context_.info().timestampPeriod) * 1e-9;
}

}  // namespace quintet::gpu
