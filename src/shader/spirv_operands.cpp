// Which operands of an instruction are values, and what of a module is for people only.
#include <algorithm>

#include "shader/spirv_module.h"

namespace quintet::shader {
namespace {

// Operands in front that are values; what follows is literal. -1: all are values.
int valueCount(const SpirvInstruction& instruction) {
  using spv::Op;
  switch (instruction.op) {
    case Op::OpLoad:
    case Op::OpCompositeExtract:
    case Op::OpArrayLength:
    case Op::OpBranchConditional:
    case Op::OpSwitch: return 1;
    case Op::OpStore:
    case Op::OpCopyMemory:
    case Op::OpCompositeInsert:
    case Op::OpVectorShuffle: return 2;
    case Op::OpLabel:
    case Op::OpBranch:
    case Op::OpSelectionMerge:
    case Op::OpLoopMerge:
    case Op::OpFunction:
    case Op::OpFunctionParameter:
    case Op::OpUndef:
    case Op::OpLine:
    case Op::OpNoLine:
    case Op::OpNop: return 0;
    default: return -1;
  }
}

// Image instructions: ids, a mask of image operands, ids again. Position of the mask.
std::size_t imageMask(spv::Op op) {
  using spv::Op;
  switch (op) {
    case Op::OpImageSampleImplicitLod:
    case Op::OpImageSampleExplicitLod:
    case Op::OpImageSampleProjImplicitLod:
    case Op::OpImageSampleProjExplicitLod:
    case Op::OpImageFetch:
    case Op::OpImageRead: return 2;
    case Op::OpImageSampleDrefImplicitLod:
    case Op::OpImageSampleDrefExplicitLod:
    case Op::OpImageGather:
    case Op::OpImageDrefGather:
    case Op::OpImageWrite: return 3;
    default: return SpirvModule::kNone;
  }
}

}  // namespace

std::vector<SpirvId> valueOperands(const SpirvInstruction& instruction) {
  const auto& operands = instruction.operands;
  std::vector<SpirvId> ids;
  if (instruction.op == spv::Op::OpPhi) {
    for (std::size_t i = 0; i < operands.size(); i += 2) ids.push_back(operands[i]);
  } else if (instruction.op == spv::Op::OpExtInst) {  // set, literal number, values
    for (std::size_t i = 2; i < operands.size(); ++i) ids.push_back(operands[i]);
  } else if (instruction.op == spv::Op::OpVariable) {  // storage class, initial value
    if (operands.size() > 1) ids.push_back(operands[1]);
  } else if (instruction.op == spv::Op::OpFunctionCall) {  // function, values
    for (std::size_t i = 1; i < operands.size(); ++i) ids.push_back(operands[i]);
  } else {
    const int count = valueCount(instruction);
    const std::size_t end =
        count < 0 ? operands.size() : std::min<std::size_t>(operands.size(), static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < end; ++i)
      if (i != imageMask(instruction.op)) ids.push_back(operands[i]);
  }
  return ids;
}

std::vector<std::uint32_t> withoutDebugInfo(std::span<const std::uint32_t> words) {
  constexpr std::size_t kHeaderWords = 5;
  using spv::Op;
  std::vector<std::uint32_t> result(words.begin(),
                                    words.begin() + static_cast<std::ptrdiff_t>(std::min(words.size(), kHeaderWords)));
  for (std::size_t at = kHeaderWords; at < words.size();) {
    const std::size_t count = std::clamp<std::size_t>(words[at] >> 16, 1, words.size() - at);
    switch (static_cast<Op>(words[at] & 0xFFFFu)) {
      case Op::OpSourceContinued:
      case Op::OpSource:
      case Op::OpSourceExtension:
      case Op::OpName:
      case Op::OpMemberName:
      case Op::OpString:
      case Op::OpLine:
      case Op::OpNoLine:
      case Op::OpModuleProcessed: break;
      default:
        result.insert(result.end(), words.begin() + static_cast<std::ptrdiff_t>(at),
                      words.begin() + static_cast<std::ptrdiff_t>(at + count));
    }
    at += count;
  }
  return result;
}

}  // namespace quintet::shader
