// SPDX-License-Identifier: Apache-2.0
#include "spirv/plain_code.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <map>
#include <unordered_map>

#include "spirv/newer_queries.h"
#include "spirv/raw_instructions.h"
#include "spirv/reorder_code.h"
#include "spirv/type.h"

namespace quintet::spirv {
namespace {

constexpr std::size_t kMotionTrace = 13;  // words of OpTraceRayMotionNV
constexpr std::size_t kMotionTime = 11;   // word of its time; the payload follows
constexpr std::size_t kFunctionMask = 3;  // word of the function control of OpFunction
constexpr auto kLastLanguage = static_cast<std::uint32_t>(spv::SourceLanguage::HLSL);

std::uint32_t firstWord(std::size_t count, spv::Op op) {
  return static_cast<std::uint32_t>(count << 16) | static_cast<std::uint32_t>(op);
}

void emit(std::vector<std::uint32_t>& result, spv::Op op, std::initializer_list<std::uint32_t> operands,
          Words more = {}) {
  result.push_back(firstWord(1 + operands.size() + more.size(), op));
  result.insert(result.end(), operands);
  append(result, more);
}

// Replaces OpGroupDecorate and OpGroupMemberDecorate by the decorations of the group.
class DecorationGroups {
 public:
  explicit DecorationGroups(Words words) {
    for (const RawInstruction& i : RawInstructions(words)) {
      if (i.op == spv::Op::OpFunction) break;
      if (i.op == spv::Op::OpDecorationGroup) groups_[i.at(0)];
    }
    if (groups_.empty()) return;
    for (const RawInstruction& i : RawInstructions(words)) {
      if (i.op == spv::Op::OpFunction) break;
      if (const auto found = groups_.find(i.at(0)); i.op == spv::Op::OpDecorate && found != groups_.end())
        found->second.push_back(i.operands.subspan(1));
    }
  }

  // Returns false if the instruction has nothing to do with groups, or if the result would be absurdly large.
  bool replace(const RawInstruction& i, std::vector<std::uint32_t>& result) const {
    const auto group = groups_.find(i.at(0));
    if (group == groups_.end()) return false;
    std::size_t words = 0;
    for (const Words& decoration : group->second) words += decoration.size() + 3;
    if (words * i.operands.size() > kMaxWords) return false;
    const bool members = i.op == spv::Op::OpGroupMemberDecorate;
    switch (i.op) {
      case spv::Op::OpName:
      case spv::Op::OpDecorate:
      case spv::Op::OpDecorationGroup: return true;
      case spv::Op::OpGroupDecorate:
      case spv::Op::OpGroupMemberDecorate: break;
      default: return false;
    }
    for (std::size_t k = 1; k + (members ? 1 : 0) < i.operands.size(); k += members ? 2 : 1)
      for (const Words& decoration : group->second) {
        if (members)
          emit(result, spv::Op::OpMemberDecorate, {i.at(k), i.at(k + 1)}, decoration);
        else
          emit(result, spv::Op::OpDecorate, {i.at(k)}, decoration);
      }
    return true;
  }

 private:
  static constexpr std::size_t kMaxWords = 1u << 16;  // in place of one instruction

  std::map<Id, std::vector<Words>> groups_;
};

// Replaces OpCopyMemory without memory operands by a load and a store, so that what it copies can be followed.
class MemoryCopies {
 public:
  void replaceOrCopy(const RawInstruction& i, std::vector<std::uint32_t>& result) {
    using spv::Op;
    switch (i.op) {
      case Op::OpTypePointer: pointees_[i.at(0)] = i.at(2); break;
      case Op::OpVariable:
      case Op::OpFunctionParameter:
      case Op::OpAccessChain:
      case Op::OpInBoundsAccessChain:
      case Op::OpCopyObject: types_[i.at(1)] = i.at(0); break;
      default: break;
    }
    const Id type = i.op == Op::OpCopyMemory && i.operands.size() == 2 ? pointeeOf(i.at(0)) : 0;
    constexpr Id kMaxId = 1u << 22;  // the validator's limit
    if (type == 0 || type != pointeeOf(i.at(1)) || result[kBound] >= kMaxId) return append(result, i.words);
    const Id value = result[kBound]++;
    emit(result, Op::OpLoad, {type, value, i.at(1)});
    emit(result, Op::OpStore, {i.at(0), value});
  }

 private:
  static constexpr std::size_t kBound = 3;  // word of the header

  Id pointeeOf(Id pointer) const {
    const auto type = types_.find(pointer);
    const auto pointee = type == types_.end() ? pointees_.end() : pointees_.find(type->second);
    return pointee == pointees_.end() ? 0 : pointee->second;
  }

  std::unordered_map<Id, Id> pointees_, types_;  // of pointer types; of pointers
};

}  // namespace

std::vector<std::uint32_t> withPlainCode(std::span<const std::uint32_t> given) {
  constexpr auto kDontInline = static_cast<std::uint32_t>(spv::FunctionControlMask::DontInline);
  const std::vector<std::uint32_t> words = withKnownQueries(withReorderNv(given));
  std::vector<std::uint32_t> result = headerOf(words);
  const DecorationGroups groups(words);
  MemoryCopies copies;
  for (const RawInstruction& i : RawInstructions(words)) {
    const std::size_t start = result.size(), count = i.words.size();
    if (groups.replace(i, result)) continue;
    copies.replaceOrCopy(i, result);
    if (i.op == spv::Op::OpTraceRayMotionNV && count == kMotionTrace) {
      result.erase(result.begin() + static_cast<std::ptrdiff_t>(start + kMotionTime));
      result[start] = firstWord(count - 1, spv::Op::OpTraceRayKHR);
    } else if (i.op == spv::Op::OpFunction && count > kFunctionMask) {
      result[start + kFunctionMask] &= ~kDontInline;
    } else if (i.op == spv::Op::OpSource && count > 1 && result[start + 1] > kLastLanguage) {
      result[start + 1] = static_cast<std::uint32_t>(spv::SourceLanguage::Unknown);
    }
  }
  return result;
}

std::optional<std::vector<std::uint32_t>> withoutDeclaration(std::span<const std::uint32_t> words, std::size_t number) {
  using spv::Op;
  std::size_t reached = 0;
  for (const RawInstruction& i : RawInstructions(words)) {
    if (++reached < number) continue;
    switch (i.op) {
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
    std::vector<std::uint32_t> result;
    append(result, words.first(i.position));
    append(result, words.subspan(i.position + i.words.size()));
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
  std::vector<std::uint32_t> result = headerOf(words);
  for (const RawInstruction& i : RawInstructions(words)) {
    if (i.op == spv::Op::OpExtension && std::ranges::find(kOld, literalText(i.operands)) == kOld.end()) continue;
    append(result, i.words);
  }
  if (result.size() == words.size()) return {};
  return result;
}

std::string_view otherTrace(const Module& module) {
  using spv::Op;
  for (const Instruction& i : module.instructions()) {
    switch (i.op) {
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
