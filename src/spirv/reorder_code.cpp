// SPDX-License-Identifier: Apache-2.0
#include "spirv/reorder_code.h"

#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "spirv/raw_instructions.h"

namespace quintet::spirv {
namespace {

using spv::Op;

// Numbers of SPV_EXT_shader_invocation_reorder, revision 3.
enum class ExtOp : std::uint16_t {
  recordFromQuery = 5304,
  recordMiss = 5305,
  recordMissMotion = 5306,
  getVertexPositions = 5307,
  getRayFlags = 5308,
  setRecordIndex = 5309,
  reorderExecute = 5310,
  traceReorderExecute = 5311,
  traceMotionReorderExecute = 5312,
  traceRayMotion = 5317
};
constexpr std::uint32_t kCapability = 5388, kRecordBuffer = 5389, kAttributeStorage = 5411;
constexpr std::string_view kExtension = "SPV_EXT_shader_invocation_reorder",
                           kKnownExtension = "SPV_NV_shader_invocation_reorder";
constexpr std::size_t kBoundWord = 3;         // of the header
constexpr std::size_t kRayOperands = 11;      // hit object to tmax
constexpr std::uint32_t kIdLimit = 1u << 22;  // the validator's limit

// The instructions with the same operands in both extensions.
std::optional<Op> sameInNv(std::uint32_t op) {
  static const std::unordered_map<std::uint32_t, Op> kSame{{5313, Op::OpTypeHitObjectNV},
                                                           {5314, Op::OpReorderThreadWithHintNV},
                                                           {5315, Op::OpReorderThreadWithHitObjectNV},
                                                           {5316, Op::OpHitObjectTraceRayNV},
                                                           {5318, Op::OpHitObjectRecordEmptyNV},
                                                           {5319, Op::OpHitObjectExecuteShaderNV},
                                                           {5320, Op::OpHitObjectGetCurrentTimeNV},
                                                           {5321, Op::OpHitObjectGetAttributesNV},
                                                           {5322, Op::OpHitObjectGetHitKindNV},
                                                           {5323, Op::OpHitObjectGetPrimitiveIndexNV},
                                                           {5324, Op::OpHitObjectGetGeometryIndexNV},
                                                           {5325, Op::OpHitObjectGetInstanceIdNV},
                                                           {5326, Op::OpHitObjectGetInstanceCustomIndexNV},
                                                           {5327, Op::OpHitObjectGetObjectRayOriginNV},
                                                           {5328, Op::OpHitObjectGetObjectRayDirectionNV},
                                                           {5329, Op::OpHitObjectGetWorldRayDirectionNV},
                                                           {5330, Op::OpHitObjectGetWorldRayOriginNV},
                                                           {5331, Op::OpHitObjectGetObjectToWorldNV},
                                                           {5332, Op::OpHitObjectGetWorldToObjectNV},
                                                           {5333, Op::OpHitObjectGetRayTMaxNV},
                                                           {5347, Op::OpHitObjectGetRayTMinNV},
                                                           {5348, Op::OpHitObjectGetShaderBindingTableRecordIndexNV},
                                                           {5349, Op::OpHitObjectGetShaderRecordBufferHandleNV},
                                                           {5350, Op::OpHitObjectIsEmptyNV},
                                                           {5351, Op::OpHitObjectIsHitNV},
                                                           {5352, Op::OpHitObjectIsMissNV}};
  const auto found = kSame.find(op);
  return found == kSame.end() ? std::nullopt : std::optional(found->second);
}

// Instructions of both extensions with the time of motion blur, and those without.
struct MotionForm {
  Op motion, plain;
  std::size_t time, operands;  // index of the time, and number of operands with it
};
constexpr MotionForm kMotionForms[] = {
    {Op::OpHitObjectTraceRayMotionNV, Op::OpHitObjectTraceRayNV, kRayOperands, kRayOperands + 2},
    {Op::OpHitObjectRecordHitMotionNV, Op::OpHitObjectRecordHitNV, 12, 14},
    {Op::OpHitObjectRecordHitWithIndexMotionNV, Op::OpHitObjectRecordHitWithIndexNV, 11, 13},
    {Op::OpHitObjectRecordMissMotionNV, Op::OpHitObjectRecordMissNV, 6, 7}};

class Rewriter {
 public:
  explicit Rewriter(Words words) : result_(headerOf(words)), isExt_(usesReorderExt(words)) {
    result_.reserve(words.size());
  }

  std::vector<std::uint32_t> run(Words words) {
    for (const RawInstruction& i : RawInstructions(words))
      if (!(isExt_ && rewriteExt(i)) && !rewriteMotion(i)) append(result_, i.words);
    return std::move(result_);
  }

 private:
  // Puts an instruction with the operands and those in `more`.
  void put(Op op, Words operands, std::initializer_list<std::uint32_t> more = {}) {
    const std::size_t count = 1 + operands.size() + more.size();
    result_.push_back(static_cast<std::uint32_t>(count << 16) | static_cast<std::uint32_t>(op));
    append(result_, operands);
    result_.insert(result_.end(), more.begin(), more.end());
  }

  // Puts the operands without the one at `index`.
  void putWithout(Op op, Words operands, std::size_t index) {
    std::vector<std::uint32_t> rest(operands.begin(), operands.end());
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(index));
    put(op, rest);
  }

  bool rewriteMotion(const RawInstruction& i) {
    const auto form = std::ranges::find(kMotionForms, i.op, &MotionForm::motion);
    if (form == std::end(kMotionForms) || i.operands.size() != form->operands) return false;
    putWithout(form->plain, i.operands, form->time);
    return true;
  }

  bool rewriteExt(const RawInstruction& i) {
    noteType(i);
    switch (i.op) {
      case Op::OpCapability:
        if (i.at(0) != kCapability) return false;
        put(i.op, {}, {static_cast<std::uint32_t>(spv::Capability::ShaderInvocationReorderNV)});
        return true;
      case Op::OpExtension: return rewriteExtension(i);
      case Op::OpTypePointer: return replaceAt(i, 1, kAttributeStorage, spv::StorageClass::HitObjectAttributeNV);
      case Op::OpVariable: return replaceAt(i, 2, kAttributeStorage, spv::StorageClass::HitObjectAttributeNV);
      case Op::OpDecorate: return replaceAt(i, 1, kRecordBuffer, spv::Decoration::HitObjectShaderRecordBufferNV);
      default: break;
    }
    const auto op = static_cast<std::uint32_t>(i.op);
    if (const auto same = sameInNv(op)) {
      put(*same, i.operands);
      return true;
    }
    return rewriteOther(static_cast<ExtOp>(op), i);
  }

  // The instructions without an equivalent with the same operands.
  bool rewriteOther(ExtOp op, const RawInstruction& i) {
    const Words all = i.operands;
    constexpr std::size_t kMissOperands = 7;  // hit object, flags, miss index, ray
    switch (op) {
      case ExtOp::recordFromQuery:
      case ExtOp::setRecordIndex:
        if (all.empty()) return false;
        put(Op::OpHitObjectRecordEmptyNV, all.first(1));
        return true;
      case ExtOp::recordMiss:
      case ExtOp::recordMissMotion:
        if (all.size() < kMissOperands) return false;
        putWithout(Op::OpHitObjectRecordMissNV, all.first(kMissOperands), 1);  // the flags
        return true;
      case ExtOp::getRayFlags:  // another integer that the hit object gives
        put(Op::OpHitObjectGetPrimitiveIndexNV, all);
        return true;
      case ExtOp::getVertexPositions: return rewriteVertices(i);
      case ExtOp::reorderExecute:
        if (all.size() < 2) return false;
        put(Op::OpHitObjectExecuteShaderNV, all.first(2));
        return true;
      case ExtOp::traceReorderExecute:
        if (all.size() <= kRayOperands) return false;
        put(Op::OpHitObjectTraceRayNV, all.first(kRayOperands + 1));
        put(Op::OpHitObjectExecuteShaderNV, {}, {all[0], all[kRayOperands]});
        return true;
      case ExtOp::traceRayMotion:
      case ExtOp::traceMotionReorderExecute:
        if (all.size() <= kRayOperands + 1) return false;
        putWithout(Op::OpHitObjectTraceRayNV, all.first(kRayOperands + 2), kRayOperands);
        if (op == ExtOp::traceMotionReorderExecute)
          put(Op::OpHitObjectExecuteShaderNV, {}, {all[0], all[kRayOperands + 1]});
        return true;
      default: return false;
    }
  }

  // The vertices become three times another vector that the hit object gives.
  bool rewriteVertices(const RawInstruction& i) {
    const auto vector = elements_.find(i.at(0));
    if (vector == elements_.end() || i.operands.size() != 3 || result_[kBoundWord] + 3 >= kIdLimit) return false;
    const std::uint32_t first = result_[kBoundWord];
    result_[kBoundWord] += 3;
    for (std::uint32_t k = 0; k < 3; ++k)
      put(Op::OpHitObjectGetObjectRayOriginNV, {}, {vector->second, first + k, i.at(2)});
    put(Op::OpCompositeConstruct, i.operands.first(2), {first, first + 1, first + 2});
    return true;
  }

  bool rewriteExtension(const RawInstruction& i) {
    if (literalText(i.operands) != kExtension) return false;
    std::vector<std::uint32_t> text(kKnownExtension.size() / sizeof(std::uint32_t) + 1, 0);
    std::memcpy(text.data(), kKnownExtension.data(), kKnownExtension.size());
    put(i.op, text);
    return true;
  }

  template <class Enum>
  bool replaceAt(const RawInstruction& i, std::size_t operand, std::uint32_t from, Enum to) {
    if (i.at(operand) != from || operand >= i.operands.size()) return false;
    const std::size_t start = result_.size();
    append(result_, i.words);
    result_[start + 1 + operand] = static_cast<std::uint32_t>(to);
    return true;
  }

  void noteType(const RawInstruction& i) {
    if (i.op == Op::OpTypeArray) elements_[i.at(0)] = i.at(1);
  }

  std::vector<std::uint32_t> result_;
  bool isExt_;
  std::unordered_map<std::uint32_t, std::uint32_t> elements_;  // of array types
};

}  // namespace

bool usesReorderExt(std::span<const std::uint32_t> words) {
  for (const RawInstruction& i : RawInstructions(words)) {
    if (i.op == Op::OpCapability && i.at(0) == kCapability) return true;
    if (i.op == Op::OpFunction) return false;
  }
  return false;
}

std::vector<std::uint32_t> withReorderNv(std::span<const std::uint32_t> words) { return Rewriter(words).run(words); }

}  // namespace quintet::spirv
