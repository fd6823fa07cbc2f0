#define SPV_ENABLE_UTILITY_CODE
#include "shader/spirv_reader.h"

#include <fmt/format.h>

#include <algorithm>

namespace quintet::shader {
namespace {

constexpr std::size_t kHeaderWords = 5;
constexpr std::size_t kMaxWords = std::size_t{1} << 26;

// A literal string: its bytes from the first operand word on, up to a NUL.
std::string literalString(std::span<const std::uint32_t> operands, std::size_t from, std::size_t* next = nullptr) {
  std::string text;
  for (std::size_t i = from; i < operands.size(); ++i) {
    for (unsigned shift = 0; shift < 32; shift += 8) {
      const char c = static_cast<char>((operands[i] >> shift) & 0xFFu);
      if (c == '\0') {
        if (next) *next = i + 1;
        return text;
      }
      text += c;
    }
  }
  if (next) *next = operands.size();
  return text;
}

bool isTerminator(spv::Op op) {
  switch (op) {
    case spv::Op::OpBranch:
    case spv::Op::OpBranchConditional:
    case spv::Op::OpSwitch:
    case spv::Op::OpReturn:
    case spv::Op::OpReturnValue:
    case spv::Op::OpKill:
    case spv::Op::OpUnreachable:
    case spv::Op::OpTerminateInvocation:
    case spv::Op::OpIgnoreIntersectionKHR:
    case spv::Op::OpTerminateRayKHR: return true;
    default: return false;
  }
}

std::vector<SpirvId> targets(const SpirvInstruction& terminator) {
  switch (terminator.op) {
    case spv::Op::OpBranch: return {terminator.at(0)};
    case spv::Op::OpBranchConditional: return {terminator.at(1), terminator.at(2)};
    case spv::Op::OpSwitch: {  // selector, default, then (literal, label); selectors of 64 bits are not supported
      std::vector<SpirvId> labels{terminator.at(1)};
      for (std::size_t i = 3; i < terminator.operands.size(); i += 2) labels.push_back(terminator.at(i));
      return labels;
    }
    default: return {};
  }
}

}  // namespace

bool SpirvReader::fail(std::string text) {
  error_ = std::move(text);
  return false;
}

bool SpirvReader::read() { return readHeader() && readInstructions() && readFunctions(); }

bool SpirvReader::readHeader() {
  const auto& words = m_.words_;
  if (words.size() < kHeaderWords || words[0] != spv::MagicNumber) return fail("no SPIR-V module");
  if (words.size() > kMaxWords) return fail("the module is larger than 256 MiB");
  bound_ = words[3];
  if (bound_ == 0 || bound_ > 64 * words.size()) return fail(fmt::format("the bound of ids, {}, cannot be", bound_));
  m_.definitions_.assign(bound_, SpirvModule::kNone);
  m_.users_.resize(bound_);
  return true;
}

bool SpirvReader::readInstructions() {
  const std::span<const std::uint32_t> words = m_.words_;
  m_.instructions_.reserve(words.size() / 4);
  for (std::size_t at = kHeaderWords; at < words.size();) {
    const std::size_t count = words[at] >> 16;
    if (count == 0 || count > words.size() - at)
      return fail(fmt::format("word {}: an instruction of {} words", at, count));
    SpirvInstruction instruction;
    instruction.op = static_cast<spv::Op>(words[at] & 0xFFFFu);
    bool hasResult = false, hasType = false;
    spv::HasResultAndType(instruction.op, &hasResult, &hasType);
    const std::size_t head = 1u + (hasResult ? 1u : 0u) + (hasType ? 1u : 0u);
    if (count < head) return fail(fmt::format("word {}: an instruction without its result", at));
    if (hasType) instruction.type = words[at + 1];
    if (hasResult) instruction.result = words[at + head - 1];
    instruction.operands = words.subspan(at + head, count - head);
    if (!add(instruction, at)) return false;
    at += count;
  }
  for (const auto& [type, member] : memberNames_) m_.types_.setMemberName(type, member.first, member.second);
  for (const auto& [id, name] : m_.names_) m_.types_.setName(id, name);
  for (SpirvVariable& variable : m_.variables_) {
    variable.name = m_.name(variable.id);
    if (const auto builtIn = m_.decoration(variable.id, spv::Decoration::BuiltIn))
      variable.builtIn = static_cast<spv::BuiltIn>(*builtIn);
  }
  return true;
}

bool SpirvReader::add(SpirvInstruction instruction, std::size_t where) {
  using spv::Op;
  if (instruction.result >= bound_ || instruction.type >= bound_)
    return fail(fmt::format("word {}: an id beyond the bound", where));
  switch (instruction.op) {
    case Op::OpLine:
      line_ = instruction.at(0), lineNumber_ = instruction.at(1), lineColumn_ = instruction.at(2);
      return true;
    case Op::OpNoLine: line_ = lineNumber_ = lineColumn_ = 0; return true;
    case Op::OpLabel: break;  // an OpLine may stand before a label
    default: break;
  }
  instruction.file = line_, instruction.line = lineNumber_, instruction.column = lineColumn_;
  if (instruction.result != 0) {
    if (m_.definitions_[instruction.result] != SpirvModule::kNone)
      return fail(fmt::format("word {}: id {} is defined twice", where, instruction.result));
    m_.definitions_[instruction.result] = m_.instructions_.size();
  }
  readDebug(instruction);
  if (!readType(instruction)) return false;
  readVariable(instruction);
  m_.instructions_.push_back(instruction);
  // A line's scope ends with the block.
  if (isTerminator(instruction.op) || instruction.op == Op::OpFunctionEnd) line_ = lineNumber_ = lineColumn_ = 0;
  return true;
}

void SpirvReader::readDebug(const SpirvInstruction& instruction) {
  using spv::Op;
  const auto& operands = instruction.operands;
  switch (instruction.op) {
    case Op::OpString: m_.strings_[instruction.result] = literalString(operands, 0); break;
    case Op::OpName: m_.names_[instruction.at(0)] = literalString(operands, 1); break;
    case Op::OpMemberName:
      memberNames_.push_back({instruction.at(0), {instruction.at(1), literalString(operands, 2)}});
      break;
    case Op::OpSource: readSource(instruction); break;
    case Op::OpSourceContinued:
      if (openSource_) *openSource_ += literalString(operands, 0);
      break;
    case Op::OpExtInstImport: m_.extendedSets_[instruction.result] = literalString(operands, 0); break;
    case Op::OpDecorate: m_.decorations_[{instruction.at(0), instruction.at(1)}] = instruction.at(2); break;
    case Op::OpEntryPoint:
      if (m_.entry_ == 0)
        m_.stage_ = static_cast<spv::ExecutionModel>(instruction.at(0)), m_.entry_ = instruction.at(1);
      break;
    default: break;
  }
}

// OpSource language version file text, the last two optional.
void SpirvReader::readSource(const SpirvInstruction& instruction) {
  openSource_ = nullptr;
  const auto file = m_.strings_.find(instruction.at(2));
  if (file == m_.strings_.end() || instruction.operands.size() < 4) return;
  std::string& text = m_.sources_[file->second];
  text = literalString(instruction.operands, 3);
  openSource_ = &text;
}

bool SpirvReader::readType(const SpirvInstruction& instruction) {
  using spv::Op;
  using Kind = SpirvType::Kind;
  SpirvType type;
  switch (instruction.op) {
    case Op::OpTypeVoid: type.kind = Kind::nothing; break;
    case Op::OpTypeBool: type.kind = Kind::boolean, type.width = 32; break;
    case Op::OpTypeInt:
      type.kind = Kind::integer, type.width = instruction.at(0), type.isSigned = instruction.at(1) != 0;
      break;
    case Op::OpTypeFloat: type.kind = Kind::real, type.width = instruction.at(0); break;
    case Op::OpTypeVector:
      type.kind = Kind::vector, type.element = instruction.at(0), type.count = instruction.at(1);
      break;
    case Op::OpTypeMatrix:
      type.kind = Kind::matrix, type.element = instruction.at(0), type.count = instruction.at(1);
      break;
    case Op::OpTypeArray:
      type.kind = Kind::array, type.element = instruction.at(0),
      type.count = m_.constantBits(instruction.at(1)).value_or(0);
      break;
    case Op::OpTypeRuntimeArray: type.kind = Kind::runtimeArray, type.element = instruction.at(0); break;
    case Op::OpTypeStruct:
      type.kind = Kind::structure, type.members.assign(instruction.operands.begin(), instruction.operands.end());
      break;
    case Op::OpTypePointer:
      type.kind = Kind::pointer, type.storage = instruction.at(0), type.element = instruction.at(1);
      break;
    case Op::OpTypeForwardPointer:  // of a buffer reference that a structure holds; OpTypePointer follows
      if (instruction.at(0) >= bound_) return fail("an id beyond the bound");
      type.kind = Kind::pointer, type.storage = instruction.at(1);
      m_.types_.add(instruction.at(0), std::move(type));
      return true;
    case Op::OpTypeAccelerationStructureKHR: type.kind = Kind::accelerationStructure; break;
    case Op::OpTypeImage:
    case Op::OpTypeSampler:
    case Op::OpTypeSampledImage:
    case Op::OpTypeFunction:
    case Op::OpTypeOpaque: type.kind = Kind::other; break;
    default: return true;
  }
  if (type.width > 64) return fail("a number of more than 64 bits");
  // What a type is made of comes before it, but for pointers: no type is part of itself.
  const auto known = [&](SpirvId id) { return m_.types_.get(id).kind != Kind::none; };
  if (type.kind != Kind::pointer && type.element != 0 && !known(type.element))
    return fail("a type of something that is no type");
  if (!std::ranges::all_of(type.members, known)) return fail("a member without a type");
  m_.types_.add(instruction.result, std::move(type));
  return true;
}

void SpirvReader::readVariable(const SpirvInstruction& instruction) {
  if (instruction.op != spv::Op::OpVariable) return;
  const auto storage = static_cast<spv::StorageClass>(instruction.at(0));
  if (storage == spv::StorageClass::Function) return;
  m_.variables_.push_back({instruction.result, storage, m_.types_.get(instruction.type).element, {}, {}});
}

bool SpirvReader::readFunctions() {
  using spv::Op;
  const auto& instructions = m_.instructions_;
  m_.firstInFunctions_ = instructions.size();
  bool inFunction = false, inBlock = false;
  for (std::size_t i = 0; i < instructions.size(); ++i) {
    const SpirvInstruction& instruction = instructions[i];
    if (instruction.op == Op::OpFunction) {
      if (inFunction) return fail("a function within a function");
      m_.firstInFunctions_ = std::min(m_.firstInFunctions_, i);
      m_.functions_.push_back({instruction.result, {}, {}});
      inFunction = true;
    } else if (instruction.op == Op::OpFunctionEnd) {
      if (!inFunction || inBlock) return fail("a function ends within a block");
      inFunction = false;
    } else if (inFunction && instruction.op == Op::OpFunctionParameter) {
      m_.functions_.back().parameters.push_back(instruction.result);
    } else if (inFunction && instruction.op == Op::OpLabel) {
      if (inBlock) return fail("a block without its end");
      m_.functions_.back().blocks.push_back({instruction.result, i, i + 1, {}, {}});
      inBlock = true;
    } else if (inFunction && inBlock && isTerminator(instruction.op)) {
      m_.functions_.back().blocks.back().end = i + 1;
      inBlock = false;
    } else if (inFunction && !inBlock) {
      return fail("an instruction outside of the blocks of its function");
    }
  }
  if (inFunction) return fail("the last function does not end");
  m_.positions_.resize(instructions.size() - m_.firstInFunctions_, {SpirvModule::kNone, SpirvModule::kNone});
  for (std::size_t f = 0; f < m_.functions_.size(); ++f) {
    if (!linkBlocks(m_.functions_[f])) return false;
    for (std::size_t b = 0; b < m_.functions_[f].blocks.size(); ++b)
      for (std::size_t i = m_.functions_[f].blocks[b].first; i < m_.functions_[f].blocks[b].end; ++i)
        m_.positions_[i - m_.firstInFunctions_] = {f, b};
  }
  collectUsers();
  return true;
}

bool SpirvReader::linkBlocks(SpirvFunction& function) {
  std::map<SpirvId, std::size_t> byLabel;
  for (std::size_t b = 0; b < function.blocks.size(); ++b) byLabel[function.blocks[b].label] = b;
  for (std::size_t b = 0; b < function.blocks.size(); ++b) {
    for (const SpirvId label : targets(m_.instructions_[function.blocks[b].end - 1])) {
      const auto found = byLabel.find(label);
      if (found == byLabel.end()) return fail("a branch to no block of its function");
      auto& successors = function.blocks[b].successors;
      if (std::ranges::find(successors, found->second) != successors.end()) continue;
      successors.push_back(found->second);
      function.blocks[found->second].predecessors.push_back(b);
    }
  }
  return true;
}

void SpirvReader::collectUsers() {
  for (std::size_t i = m_.firstInFunctions_; i < m_.instructions_.size(); ++i) {
    for (const SpirvId id : valueOperands(m_.instructions_[i])) {
      if (id == 0 || id >= bound_) continue;
      if (m_.users_[id].empty() || m_.users_[id].back() != i) m_.users_[id].push_back(i);
    }
  }
}

}  // namespace quintet::shader
