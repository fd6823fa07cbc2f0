// SPDX-License-Identifier: Apache-2.0
#include "spirv/plain_code.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace quintet::spirv {
namespace {

constexpr std::size_t kModuleHead = 5;    // words
constexpr std::size_t kMotionTrace = 13;  // words of OpTraceRayMotionNV
constexpr std::size_t kMotionTime = 11;   // word of its time; the payload follows
constexpr std::size_t kFunctionMask = 3;  // word of the function control of OpFunction
constexpr auto kLastLanguage = static_cast<std::uint32_t>(spv::SourceLanguage::HLSL);

std::uint32_t firstWord(std::size_t count, spv::Op op) {
  return static_cast<std::uint32_t>(count << 16) | static_cast<std::uint32_t>(op);
}

}  // namespace

std::vector<std::uint32_t> withPlainCode(std::span<const std::uint32_t> words) {
  constexpr auto kDontInline = static_cast<std::uint32_t>(spv::FunctionControlMask::DontInline);
  const std::size_t head = std::min(words.size(), kModuleHead);
  std::vector<std::uint32_t> result(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(head));
  for (std::size_t at = kModuleHead; at < words.size();) {
    const std::size_t count = std::clamp<std::size_t>(words[at] >> 16, 1, words.size() - at);
    const std::span<const std::uint32_t> instruction = words.subspan(at, count);
    const auto op = static_cast<spv::Op>(words[at] & 0xFFFFu);
    const std::size_t start = result.size();
    result.insert(result.end(), instruction.begin(), instruction.end());
    if (op == spv::Op::OpTraceRayMotionNV && count == kMotionTrace) {
      result.erase(result.begin() + static_cast<std::ptrdiff_t>(start + kMotionTime));
      result[start] = firstWord(count - 1, spv::Op::OpTraceRayKHR);
    } else if (op == spv::Op::OpFunction && count > kFunctionMask) {
      result[start + kFunctionMask] &= ~kDontInline;
    } else if (op == spv::Op::OpSource && count > 1 && result[start + 1] > kLastLanguage) {
      result[start + 1] = static_cast<std::uint32_t>(spv::SourceLanguage::Unknown);
    }
    at += count;
  }
  return result;
}

std::optional<std::vector<std::uint32_t>> withoutDeclaration(std::span<const std::uint32_t> words, std::size_t number) {
  using spv::Op;
  std::size_t reached = 0;
  for (std::size_t begin = kModuleHead; begin < words.size();) {
    const std::size_t count = std::clamp<std::size_t>(words[begin] >> 16, 1, words.size() - begin);
    if (++reached < number) {
      begin += count;
      continue;
    }
    switch (static_cast<Op>(words[begin] & 0xFFFFu)) {
      case Op::OpCapability:
      case Op::OpExtension:
      case Op::OpSource:
      case Op::OpExecutionMode:
      case Op::OpExecutionModeId:
      case Op::OpDecorate:
      case Op::OpDecorateId:
      case Op::OpDecorateString:
      case Op::OpMemberDecorate:
      case Op::OpMemberDecorateString: break;
      default: return {};
    }
    std::vector<std::uint32_t> result(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(begin));
    result.insert(result.end(), words.begin() + static_cast<std::ptrdiff_t>(begin + count), words.end());
    return result;
  }
  return {};
}

std::optional<std::vector<std::uint32_t>> withoutNewExtensions(std::span<const std::uint32_t> words) {
  constexpr std::array<std::string_view, 12> kOld{"SPV_KHR_ray_tracing",
                                                  "SPV_KHR_ray_query",
                                                  "SPV_KHR_non_semantic_info",
                                                  "SPV_EXT_descriptor_indexing",
                                                  "SPV_KHR_16bit_storage",
                                                  "SPV_KHR_8bit_storage",
                                                  "SPV_GOOGLE_decorate_string",
                                                  "SPV_GOOGLE_hlsl_functionality1",
                                                  "SPV_GOOGLE_user_type",
                                                  "SPV_EXT_physical_storage_buffer",
                                                  "SPV_KHR_physical_storage_buffer",
                                                  "SPV_KHR_storage_buffer_storage_class"};
  const std::size_t head = std::min(words.size(), kModuleHead);
  std::vector<std::uint32_t> result(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(head));
  for (std::size_t at = kModuleHead; at < words.size();) {
    const std::size_t count = std::clamp<std::size_t>(words[at] >> 16, 1, words.size() - at);
    const auto instruction = words.subspan(at, count);
    at += count;
    if (static_cast<spv::Op>(instruction[0] & 0xFFFFu) == spv::Op::OpExtension) {
      const auto* text = reinterpret_cast<const char*>(instruction.data() + 1);
      const std::string_view padded(text, (count - 1) * sizeof(std::uint32_t));
      if (std::ranges::find(kOld, padded.substr(0, padded.find('\0'))) == kOld.end()) continue;
    }
    result.insert(result.end(), instruction.begin(), instruction.end());
  }
  if (result.size() == words.size()) return {};
  return result;
}

std::string_view otherTrace(const Module& module) {
  using spv::Op;
  for (const Instruction& i : module.instructions()) {
    switch (i.op) {
      case Op::OpHitObjectTraceRayNV: return "OpHitObjectTraceRayNV";
      case Op::OpHitObjectTraceRayMotionNV: return "OpHitObjectTraceRayMotionNV";
      case Op::OpHitObjectExecuteShaderNV: return "OpHitObjectExecuteShaderNV";
      case Op::OpTraceRayMotionNV: return "OpTraceRayMotionNV";
      case Op::OpTraceNV: return "OpTraceNV";
      case Op::OpTraceMotionNV: return "OpTraceMotionNV";
      case Op::OpExecuteCallableNV: return "OpExecuteCallableNV";
      default: break;
    }
  }
  return {};
}

}  // namespace quintet::spirv
