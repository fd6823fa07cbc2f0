// SPDX-License-Identifier: Apache-2.0
#include "shader/optimizer.h"

#include <string>

#include <fmt/format.h>
#include <spirv-tools/optimizer.hpp>

#include "base/error.h"
#include "shader/deep_stack.h"

namespace quintet::shader {

std::vector<std::uint32_t> optimize(const std::vector<std::uint32_t>& words) {
  std::vector<std::uint32_t> result;
  std::string message;
  bool succeeded = false;
  runOnDeepStack(stackBytesFor(words.size() * sizeof(std::uint32_t)), [&] {
    spvtools::Optimizer optimizer(SPV_ENV_VULKAN_1_3);
    optimizer.SetMessageConsumer([&](spv_message_level_t level, const char*, const spv_position_t&, const char* text) {
      if (level <= SPV_MSG_ERROR) message = text;
    });
    optimizer.RegisterPerformancePasses();
    spvtools::OptimizerOptions options;
    options.set_run_validator(false);
    succeeded = optimizer.Run(words.data(), words.size(), &result, options);
  });
  if (!succeeded) throw Error(fmt::format("spirv-opt failed{}{}", message.empty() ? "" : ": ", message));
  return result;
}

}  // namespace quintet::shader
