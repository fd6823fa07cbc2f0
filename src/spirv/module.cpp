// SPDX-License-Identifier: Apache-2.0
#include "spirv/module.h"

#include <fmt/format.h>

#include <spirv/unified1/NonSemanticShaderDebugInfo100.h>
#include <algorithm>
#include <bit>
#include <set>
#include <utility>

#include "spirv/raw_instructions.h"
#include "spirv/source_text.h"

namespace quintet::spirv {
namespace {

constexpr int kMaxChain = 64;      // nested access chains
constexpr int kMaxCallLines = 16;  // lines of a call that location() searches
constexpr std::size_t kMaxWords = std::size_t{1} << 26;
constexpr std::string_view kDebugInfo = "NonSemantic.Shader.DebugInfo.100";

// Decodes a literal string: the bytes from operand word `from` up to a NUL. `next` becomes the word after it.
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

std::vector<Id> targets(const Instruction& terminator) {
  switch (terminator.op) {
    case spv::Op::OpBranch: return {terminator.at(0)};
    case spv::Op::OpBranchConditional: return {terminator.at(1), terminator.at(2)};
    case spv::Op::OpSwitch: {  // selector, default, then pairs (literal, label); 64-bit selectors are not supported
      std::vector<Id> labels{terminator.at(1)};
      for (std::size_t i = 3; i < terminator.operands.size(); i += 2) labels.push_back(terminator.at(i));
      return labels;
    }
    default: return {};
  }
}

// Number of leading operands that are values, the others being literals; -1 if all operands are values.
int valueCount(const Instruction& instruction) {
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
    case Op::OpConstant:
    case Op::OpSpecConstant:
    case Op::OpUndef:
    case Op::OpLine:
    case Op::OpNoLine:
    case Op::OpNop: return 0;
    default: return -1;
  }
}

// Index of the image operands mask in an image instruction: ids, mask, more ids. kNone for other instructions.
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
    default: return Module::kNone;
  }
}

}  // namespace

// Fills a Module and rejects what cannot be analyzed.
class ModuleReader {
 public:
  explicit ModuleReader(Module& module) : m_(module) {}
  bool read();  // error() has the reason if it returns false
  const std::string& error() const { return error_; }

 private:
  bool fail(std::string text);
  bool readHeader();
  bool readInstructions();
  bool add(Instruction instruction, std::size_t where);
  void readDebug(const Instruction& instruction);
  bool isDebugInfo(const Instruction& instruction) const;
  void readDebugInfo(const Instruction& instruction);
  SourceLocation debugLocation(Id source, Id line, Id column) const;
  void readSource(const Instruction& instruction);
  bool readType(const Instruction& instruction);
  void readVariable(const Instruction& instruction);
  bool readFunctions();
  bool linkBlocks(Function& function);
  void collectUsers();

  Module& m_;
  std::string error_;
  std::uint32_t bound_ = 0;
  Id file_ = 0;                          // OpString of the current OpLine
  std::uint32_t line_ = 0, column_ = 0;  // of the current OpLine
  std::string* openSource_ = nullptr;    // OpSourceContinued appends to it
  std::vector<std::pair<Id, std::pair<std::uint32_t, std::string>>> memberNames_;
  std::map<Id, Id> debugSources_;  // DebugSource: OpString of the file
  std::map<Id, SourceLocation> debugFunctions_;
};

bool ModuleReader::fail(std::string text) {
  error_ = std::move(text);
  return false;
}

bool ModuleReader::read() { return readHeader() && readInstructions() && readFunctions(); }

bool ModuleReader::readHeader() {
  const auto& words = m_.words_;
  if (words.size() < kHeaderWords || words[0] != spv::MagicNumber) return fail("not a SPIR-V module");
  if (words.size() > kMaxWords) return fail("the module is larger than 256 MiB");
  bound_ = words[3];
  if (bound_ == 0 || bound_ > 64 * words.size()) return fail(fmt::format("invalid id bound {}", bound_));
  m_.definitions_.assign(bound_, Module::kNone);
  m_.users_.resize(bound_);
  return true;
}

bool ModuleReader::readInstructions() {
  const std::span<const std::uint32_t> words = m_.words_;
  m_.instructions_.reserve(words.size() / 4);
  for (std::size_t at = kHeaderWords; at < words.size();) {
    const std::size_t count = words[at] >> 16;
    if (count == 0 || count > words.size() - at)
      return fail(fmt::format("word {}: instruction with {} words", at, count));
    Instruction instruction;
    instruction.op = static_cast<spv::Op>(words[at] & 0xFFFFu);
    bool hasResult = false, hasType = false;
    spv::HasResultAndType(instruction.op, &hasResult, &hasType);
    const std::size_t head = 1u + (hasResult ? 1u : 0u) + (hasType ? 1u : 0u);
    if (count < head) return fail(fmt::format("word {}: instruction without its result", at));
    if (hasType) instruction.type = words[at + 1];
    if (hasResult) instruction.result = words[at + head - 1];
    instruction.operands = words.subspan(at + head, count - head);
    if (!add(instruction, at)) return false;
    at += count;
  }
  for (const auto& [type, member] : memberNames_) m_.types_.setMemberName(type, member.first, member.second);
  for (const auto& [id, name] : m_.names_) m_.types_.setName(id, name);
  for (Variable& variable : m_.variables_) {
    variable.name = m_.name(variable.id);
    if (const auto builtIn = m_.decoration(variable.id, spv::Decoration::BuiltIn))
      variable.builtIn = static_cast<spv::BuiltIn>(*builtIn);
  }
  return true;
}

bool ModuleReader::add(Instruction instruction, std::size_t where) {
  using spv::Op;
  if (instruction.result >= bound_ || instruction.type >= bound_)
    return fail(fmt::format("word {}: id beyond the bound", where));
  if (instruction.op == Op::OpLine) {
    file_ = instruction.at(0), line_ = instruction.at(1), column_ = instruction.at(2);
    return true;
  }
  if (instruction.op == Op::OpNoLine) {
    file_ = line_ = column_ = 0;
    return true;
  }
  if (isDebugInfo(instruction)) {
    readDebugInfo(instruction);
    return true;
  }
  instruction.file = file_, instruction.line = line_, instruction.column = column_;
  if (instruction.result != 0) {
    if (m_.definitions_[instruction.result] != Module::kNone)
      return fail(fmt::format("word {}: id {} is defined twice", where, instruction.result));
    m_.definitions_[instruction.result] = m_.instructions_.size();
  }
  readDebug(instruction);
  if (!readType(instruction)) return false;
  readVariable(instruction);
  m_.instructions_.push_back(instruction);
  // The scope of an OpLine ends with its block.
  if (isTerminator(instruction.op) || instruction.op == Op::OpFunctionEnd) file_ = line_ = column_ = 0;
  return true;
}

void ModuleReader::readDebug(const Instruction& instruction) {
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
      m_.entryPoints_.push_back({static_cast<spv::ExecutionModel>(instruction.at(0)), literalString(operands, 2)});
      if (m_.entry_ == 0)
        m_.stage_ = static_cast<spv::ExecutionModel>(instruction.at(0)), m_.entry_ = instruction.at(1);
      break;
    default: break;
  }
}

bool ModuleReader::isDebugInfo(const Instruction& instruction) const {
  return instruction.op == spv::Op::OpExtInst && m_.extendedSet(instruction.at(0)) == kDebugInfo;
}

// Lines and columns are constants.
SourceLocation ModuleReader::debugLocation(Id source, Id line, Id column) const {
  const auto file = debugSources_.find(source);
  const auto name = file == debugSources_.end() ? m_.strings_.end() : m_.strings_.find(file->second);
  if (name == m_.strings_.end()) return {};
  const auto number = [&](Id id) { return static_cast<int>(m_.constantBits(id).value_or(0) & 0x7FFFFFFFu); };
  return {name->second, number(line), number(column)};
}

// The instructions of NonSemantic.Shader.DebugInfo.100 that say where something is. The others describe types and scopes.
void ModuleReader::readDebugInfo(const Instruction& instruction) {
  const auto at = [&](std::size_t i) { return instruction.at(i + 2); };  // after the set and the number
  switch (instruction.at(1)) {
    case NonSemanticShaderDebugInfo100DebugSource: {
      debugSources_[instruction.result] = at(0);
      const std::string *file = m_.string(at(0)), *text = m_.string(at(1));
      openSource_ = nullptr;
      if (!file || !text) return;
      openSource_ = &m_.sources_[*file];
      *openSource_ = *text;
      return;
    }
    case NonSemanticShaderDebugInfo100DebugSourceContinued:
      if (const std::string* text = m_.string(at(0)); text && openSource_) *openSource_ += *text;
      return;
    case NonSemanticShaderDebugInfo100DebugLine: {
      const auto file = debugSources_.find(at(0));
      file_ = file == debugSources_.end() ? 0 : file->second;
      line_ = m_.constantBits(at(1)).value_or(0), column_ = m_.constantBits(at(3)).value_or(0);
      return;
    }
    case NonSemanticShaderDebugInfo100DebugNoLine: file_ = line_ = column_ = 0; return;
    case NonSemanticShaderDebugInfo100DebugGlobalVariable:
      m_.declarations_[at(7)] = debugLocation(at(2), at(3), at(4));
      return;
    case NonSemanticShaderDebugInfo100DebugFunction:
      debugFunctions_[instruction.result] = debugLocation(at(2), at(3), at(4));
      return;
    case NonSemanticShaderDebugInfo100DebugFunctionDefinition:
      if (const auto found = debugFunctions_.find(at(0)); found != debugFunctions_.end())
        m_.declarations_[at(1)] = found->second;
      return;
    default: return;
  }
}

// OpSource: language, version, file, text. The last two are optional.
void ModuleReader::readSource(const Instruction& instruction) {
  openSource_ = nullptr;
  const auto file = m_.strings_.find(instruction.at(2));
  if (file == m_.strings_.end() || instruction.operands.size() < 4) return;
  std::string& text = m_.sources_[file->second];
  text = literalString(instruction.operands, 3);
  openSource_ = &text;
}

bool ModuleReader::readType(const Instruction& instruction) {
  using spv::Op;
  using Kind = Type::Kind;
  Type type;
  switch (instruction.op) {
    case Op::OpTypeVoid: type.kind = Kind::voidType; break;
    case Op::OpTypeBool: type.kind = Kind::boolean, type.width = 32; break;
    case Op::OpTypeInt:
      type.kind = Kind::integer, type.width = instruction.at(0), type.isSigned = instruction.at(1) != 0;
      break;
    case Op::OpTypeFloat: type.kind = Kind::floating, type.width = instruction.at(0); break;
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
    case Op::OpTypeForwardPointer:  // buffer reference inside a structure; its OpTypePointer follows
      if (instruction.at(0) >= bound_) return fail("id beyond the bound");
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
  if (type.width > 64) return fail("number with more than 64 bits");
  if ((type.kind == Kind::vector || type.kind == Kind::matrix) && (type.count < 2 || type.count > 4))
    return fail(fmt::format("vector or matrix with {} components", type.count));  // shaders have 2 to 4
  // Except for pointers, the parts of a type are declared before it: no type contains itself.
  const auto known = [&](Id id) { return m_.types_.get(id).kind != Kind::none; };
  if (type.kind != Kind::pointer && type.element != 0 && !known(type.element))
    return fail("type with an element that is not a type");
  if (!std::ranges::all_of(type.members, known)) return fail("structure member without a type");
  m_.types_.add(instruction.result, std::move(type));
  return true;
}

void ModuleReader::readVariable(const Instruction& instruction) {
  if (instruction.op != spv::Op::OpVariable) return;
  const auto storage = static_cast<spv::StorageClass>(instruction.at(0));
  if (storage == spv::StorageClass::Function) return;
  m_.variables_.push_back({instruction.result, storage, m_.types_.get(instruction.type).element, {}, {}});
}

bool ModuleReader::readFunctions() {
  using spv::Op;
  const auto& instructions = m_.instructions_;
  m_.firstInFunctions_ = instructions.size();
  bool inFunction = false, inBlock = false;
  for (std::size_t i = 0; i < instructions.size(); ++i) {
    const Instruction& instruction = instructions[i];
    if (instruction.op == Op::OpFunction) {
      if (inFunction) return fail("function inside a function");
      m_.firstInFunctions_ = std::min(m_.firstInFunctions_, i);
      m_.functions_.push_back({instruction.result, {}, {}});
      inFunction = true;
    } else if (instruction.op == Op::OpFunctionEnd) {
      if (!inFunction || inBlock) return fail("function ends inside a block");
      inFunction = false;
    } else if (inFunction && instruction.op == Op::OpFunctionParameter) {
      m_.functions_.back().parameters.push_back(instruction.result);
    } else if (inFunction && instruction.op == Op::OpLabel) {
      if (inBlock) return fail("block without a terminator");
      m_.functions_.back().blocks.push_back({instruction.result, i, i + 1, {}, {}});
      inBlock = true;
    } else if (inFunction && inBlock && isTerminator(instruction.op)) {
      m_.functions_.back().blocks.back().end = i + 1;
      inBlock = false;
    } else if (inFunction && !inBlock) {
      return fail("instruction outside of the blocks of its function");
    }
  }
  if (inFunction) return fail("the last function has no end");
  m_.positions_.resize(instructions.size() - m_.firstInFunctions_, {Module::kNone, Module::kNone});
  for (std::size_t f = 0; f < m_.functions_.size(); ++f) {
    if (!linkBlocks(m_.functions_[f])) return false;
    for (std::size_t b = 0; b < m_.functions_[f].blocks.size(); ++b)
      for (std::size_t i = m_.functions_[f].blocks[b].first; i < m_.functions_[f].blocks[b].end; ++i)
        m_.positions_[i - m_.firstInFunctions_] = {f, b};
  }
  collectUsers();
  return true;
}

bool ModuleReader::linkBlocks(Function& function) {
  std::map<Id, std::size_t> byLabel;
  for (std::size_t b = 0; b < function.blocks.size(); ++b) byLabel[function.blocks[b].label] = b;
  for (std::size_t b = 0; b < function.blocks.size(); ++b) {
    for (const Id label : targets(m_.instructions_[function.blocks[b].end - 1])) {
      const auto found = byLabel.find(label);
      if (found == byLabel.end()) return fail("branch to a block outside of its function");
      auto& successors = function.blocks[b].successors;
      if (std::ranges::find(successors, found->second) != successors.end()) continue;
      successors.push_back(found->second);
      function.blocks[found->second].predecessors.push_back(b);
    }
  }
  return true;
}

void ModuleReader::collectUsers() {
  for (std::size_t i = m_.firstInFunctions_; i < m_.instructions_.size(); ++i) {
    for (const Id id : valueOperands(m_.instructions_[i])) {
      if (id == 0 || id >= bound_) continue;
      if (m_.users_[id].empty() || m_.users_[id].back() != i) m_.users_[id].push_back(i);
    }
  }
}

std::vector<Id> valueOperands(const Instruction& instruction) {
  const auto& operands = instruction.operands;
  std::vector<Id> ids;
  if (instruction.op == spv::Op::OpPhi) {
    for (std::size_t i = 0; i < operands.size(); i += 2) ids.push_back(operands[i]);
  } else if (instruction.op == spv::Op::OpExtInst) {  // set, literal number, values
    for (std::size_t i = 2; i < operands.size(); ++i) ids.push_back(operands[i]);
  } else if (instruction.op == spv::Op::OpVariable) {  // storage class, initial value
    if (operands.size() > 1) ids.push_back(operands[1]);
  } else if (instruction.op == spv::Op::OpFunctionCall || instruction.op == spv::Op::OpSpecConstantOp) {
    // function or literal operation, values
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

namespace {

// Returns a copy without debug information, except the names of ids that `hasName` selects, and of their members.
template <class Predicate>
std::vector<std::uint32_t> stripped(Words words, const Predicate& hasName) {
  using spv::Op;
  std::vector<std::uint32_t> result = headerOf(words);
  std::vector<Id> nonSemanticSets;
  const auto isNonSemantic = [&](const RawInstruction& i) {
    switch (i.op) {
      case Op::OpExtension: return literalString(i.operands, 0) == "SPV_KHR_non_semantic_info";
      case Op::OpExtInstImport:
        if (!literalString(i.operands, 1).starts_with("NonSemantic.")) return false;
        nonSemanticSets.push_back(i.at(0));
        return true;
      case Op::OpExtInst:
        return i.operands.size() > 2 && std::ranges::find(nonSemanticSets, i.at(2)) != nonSemanticSets.end();
      default: return false;
    }
  };
  for (const RawInstruction& i : RawInstructions(words)) {
    if (isNonSemantic(i)) continue;
    const bool isName = i.op == Op::OpName || i.op == Op::OpMemberName;
    if (isName && (i.operands.empty() || !hasName(i.at(0)))) continue;
    switch (i.op) {
      case Op::OpSourceContinued:
      case Op::OpSource:
      case Op::OpSourceExtension:
      case Op::OpString:
      case Op::OpLine:
      case Op::OpNoLine:
      case Op::OpModuleProcessed: break;
      default: append(result, i.words);
    }
  }
  return result;
}

}  // namespace

std::vector<std::uint32_t> withoutDebugInfo(std::span<const std::uint32_t> words) {
  return stripped(words, [](Id) { return false; });
}

std::vector<std::uint32_t> withInterfaceNames(std::span<const std::uint32_t> words) {
  std::set<Id> named;
  for (const RawInstruction& i : RawInstructions(words)) {
    if (i.op == spv::Op::OpFunction) break;
    if (i.op >= spv::Op::OpTypeVoid && i.op <= spv::Op::OpTypeForwardPointer) named.insert(i.at(0));
    if (i.op == spv::Op::OpVariable) named.insert(i.at(1));
  }
  return stripped(words, [&](Id id) { return named.contains(id); });
}

std::vector<std::uint32_t> withEntryPoint(std::span<const std::uint32_t> words, const EntryPoint& entryPoint) {
  using spv::Op;
  std::vector<std::uint32_t> result = headerOf(words);
  std::vector<Id> removed;  // functions of the other entry points
  std::optional<Id> kept;
  for (const RawInstruction& i : RawInstructions(words)) {
    bool keep = true;
    if (i.op == Op::OpEntryPoint && i.operands.size() > 2) {
      keep = !kept && i.at(0) == static_cast<std::uint32_t>(entryPoint.stage) &&
             literalString(i.operands, 2) == entryPoint.name;
      if (keep)
        kept = i.at(1);
      else
        removed.push_back(i.at(1));
    } else if ((i.op == Op::OpExecutionMode || i.op == Op::OpExecutionModeId) && !i.operands.empty()) {
      keep = kept == i.at(0) || std::ranges::find(removed, i.at(0)) == removed.end();
    }
    if (keep) append(result, i.words);
  }
  return result;
}

bool isIdLocation(const SourceLocation& location) { return location.file.find(kIdMark) != std::string::npos; }

std::pair<std::string, std::string> splitIdLocation(const std::string& file) {
  const std::size_t mark = file.find(kIdMark);
  if (mark == file.npos) return {file, {}};
  return {file.substr(0, mark), file.substr(mark + 1)};
}

std::optional<Module> Module::read(std::vector<std::uint32_t> words, std::string* why) {
  Module module;
  module.words_ = std::move(words);
  ModuleReader reader(module);
  if (reader.read()) return module;
  if (why) *why = reader.error();
  return {};
}

const Function* Module::entry() const { return function(entry_); }

const Function* Module::function(Id id) const {
  const auto found = std::ranges::find(functions_, id, &Function::id);
  return found == functions_.end() || id == 0 ? nullptr : &*found;
}

std::size_t Module::definitionIndex(Id id) const { return id < definitions_.size() ? definitions_[id] : kNone; }

const Instruction* Module::definition(Id id) const {
  const std::size_t index = definitionIndex(id);
  return index < instructions_.size() ? &instructions_[index] : nullptr;
}

const std::vector<std::size_t>& Module::users(Id id) const {
  static const std::vector<std::size_t> kNoUsers;
  return id < users_.size() ? users_[id] : kNoUsers;
}

std::optional<Module::Position> Module::position(std::size_t instruction) const {
  if (instruction < firstInFunctions_ || instruction - firstInFunctions_ >= positions_.size()) return {};
  const Position position = positions_[instruction - firstInFunctions_];
  return position.function == kNone ? std::nullopt : std::optional(position);
}

std::string Module::name(Id id) const {
  const auto found = names_.find(id);
  return found == names_.end() ? std::string() : found->second;
}

Id Module::functionNamed(std::string_view name) const {
  // glslang adds the types of the parameters: "hit(vf3;".
  const auto found = std::ranges::find_if(functions_, [&](const Function& function) {
    const std::string mangled = this->name(function.id);
    return mangled.starts_with(name) && mangled.substr(name.size()).starts_with("(");
  });
  return found == functions_.end() ? 0 : found->id;
}

const std::string* Module::string(Id id) const {
  const auto found = strings_.find(id);
  return found == strings_.end() ? nullptr : &found->second;
}

std::optional<std::uint32_t> Module::decoration(Id id, spv::Decoration decoration) const {
  const auto found = decorations_.find({id, static_cast<std::uint32_t>(decoration)});
  return found == decorations_.end() ? std::nullopt : std::optional(found->second);
}

const Variable* Module::variable(Id id) const {
  const auto found = std::ranges::find(variables_, id, &Variable::id);
  return found == variables_.end() || id == 0 ? nullptr : &*found;
}

std::string_view Module::extendedSet(Id id) const {
  const auto found = extendedSets_.find(id);
  return found == extendedSets_.end() ? std::string_view() : std::string_view(found->second);
}

std::optional<std::uint32_t> Module::constantBits(Id id) const {
  const Instruction* value = definition(id);
  if (!value) return {};
  switch (value->op) {
    case spv::Op::OpConstantTrue: return 1u;
    case spv::Op::OpConstantFalse:
    case spv::Op::OpConstantNull: return 0u;
    case spv::Op::OpConstant: {
      const Type& type = types_.get(value->type);
      if (type.kind != Type::Kind::integer || type.width > 32 || value->operands.empty()) return {};
      return value->at(0);
    }
    default: return {};
  }
}

std::optional<double> Module::constantFloat(Id id) const {
  const Instruction* value = definition(id);
  if (!value) return {};
  const Type& type = types_.get(value->type);
  if (type.kind != Type::Kind::floating) return {};
  if (value->op == spv::Op::OpConstantNull) return 0.0;
  if (value->op != spv::Op::OpConstant) return {};
  if (type.width == 32 && value->operands.size() == 1) return std::bit_cast<float>(value->at(0));
  if (type.width == 64 && value->operands.size() == 2)
    return std::bit_cast<double>(value->at(0) | std::uint64_t{value->at(1)} << 32);
  return {};
}

bool Module::isConstant(Id id) const {
  const Instruction* value = definition(id);
  return value && (value->op == spv::Op::OpConstant || value->op == spv::Op::OpConstantTrue ||
                   value->op == spv::Op::OpConstantFalse || value->op == spv::Op::OpConstantNull ||
                   value->op == spv::Op::OpConstantComposite || value->op == spv::Op::OpUndef);
}

bool isAccessChain(spv::Op op) {
  return op == spv::Op::OpAccessChain || op == spv::Op::OpInBoundsAccessChain || op == spv::Op::OpPtrAccessChain ||
         op == spv::Op::OpInBoundsPtrAccessChain;
}

Access Module::access(Id pointer) const {
  Access result;
  for (int depth = 0; depth < kMaxChain; ++depth) {
    const Instruction* value = definition(pointer);
    if (!value) return {};
    const bool array = value->op == spv::Op::OpPtrAccessChain || value->op == spv::Op::OpInBoundsPtrAccessChain;
    const bool chain = isAccessChain(value->op);
    if (!chain && value->op != spv::Op::OpCopyObject) {
      result.base = pointer;
      if (value->op == spv::Op::OpVariable || value->op == spv::Op::OpFunctionParameter) result.variable = pointer;
      result.type = types_.get(value->type).element;
      for (const Id index : result.indexIds) result.indices.push_back(constantBits(index));
      return result;
    }
    if (chain) {
      const auto ids = value->operands.subspan(std::min<std::size_t>(array ? 2 : 1, value->operands.size()));
      result.indexIds.insert(result.indexIds.begin(), ids.begin(), ids.end());
    }
    pointer = value->at(0);
  }
  return {};
}

SourceLocation Module::location(const Instruction& instruction, std::string_view token) const {
  const auto file = strings_.find(instruction.file);
  if (file == strings_.end() || instruction.line == 0) return idLocation(instruction);
  SourceLocation result{file->second, static_cast<int>(instruction.line & 0x7FFFFFFFu),
                        static_cast<int>(instruction.column & 0x7FFFFFFFu)};
  // glslang names the line where a call ends: a call over several lines starts some lines earlier.
  for (int back = 0; result.column == 0 && back < kMaxCallLines && result.line - back > 0 && !token.empty(); ++back) {
    const std::size_t at = findToken(lineOf(source(result.file), result.line - back), token);
    if (at != token.npos) result.line -= back, result.column = static_cast<int>(at) + 1;
  }
  return result;
}

SourceLocation Module::declaration(Id id) const {
  if (const auto found = declarations_.find(id); found != declarations_.end() && found->second.line > 0)
    return found->second;
  if (const Instruction* declared = definition(id); declared && strings_.contains(declared->file) && declared->line > 0)
    return location(*declared);
  return idLocation(id);
}

namespace {

// The name of an instruction that runs shaders, without the extension of hit objects, and the operand with the payload or data.
std::pair<std::string_view, std::size_t> nameAndData(spv::Op op) {
  switch (op) {
    case spv::Op::OpTraceRayKHR: return {"OpTraceRayKHR", 10};
    case spv::Op::OpHitObjectTraceRayNV: return {"OpHitObjectTraceRay", 11};
    case spv::Op::OpHitObjectExecuteShaderNV: return {"OpHitObjectExecuteShader", 1};
    default: return {"OpExecuteCallableKHR", 1};
  }
}

}  // namespace

SourceLocation Module::idLocation(Id id) const {
  if (file_.empty()) return {};
  const std::string named = name(id);
  return {file_ + kIdMark + fmt::format("SPIR-V id %{}{}", id, named.empty() ? "" : " '" + named + "'"), 0, 0};
}

// An instruction without a result is named by the pointer that it uses. Traces can share it, so they are counted.
SourceLocation Module::idLocation(const Instruction& instruction) const {
  using spv::Op;
  if (file_.empty()) return {};
  const auto pointer = [&](std::size_t operand) {
    const Id variable = access(instruction.at(operand)).variable;
    return variable != 0 ? variable : instruction.at(operand);
  };
  switch (instruction.op) {
    case Op::OpTraceRayKHR:
    case Op::OpHitObjectTraceRayNV:
    case Op::OpHitObjectExecuteShaderNV:
    case Op::OpExecuteCallableKHR: {
      std::size_t number = 0;
      for (const Instruction& other : instructions_) {
        number += other.op == instruction.op ? 1 : 0;
        if (&other == &instruction) break;
      }
      const auto [name, data] = nameAndData(instruction.op);
      SourceLocation result = idLocation(pointer(data));
      result.file += fmt::format(", {} number {}", name, number);
      return result;
    }
    case Op::OpStore: return idLocation(pointer(0));
    case Op::OpLoad: return idLocation(pointer(0));
    case Op::OpIgnoreIntersectionKHR:
    case Op::OpTerminateRayKHR: return idLocation(entry_);
    default: return idLocation(instruction.result != 0 ? instruction.result : entry_);
  }
}

std::string_view Module::source(const std::string& file) const {
  for (const auto* texts : {&sources_, &addedSources_})
    if (const auto found = texts->find(file); found != texts->end()) return found->second;
  return {};
}

std::string_view glslName(spv::BuiltIn builtIn) {
  using spv::BuiltIn;
  switch (builtIn) {
    case BuiltIn::LaunchIdKHR: return "gl_LaunchIDEXT";
    case BuiltIn::LaunchSizeKHR: return "gl_LaunchSizeEXT";
    case BuiltIn::PrimitiveId: return "gl_PrimitiveID";
    case BuiltIn::InstanceId: return "gl_InstanceID";
    case BuiltIn::InstanceCustomIndexKHR: return "gl_InstanceCustomIndexEXT";
    case BuiltIn::RayGeometryIndexKHR: return "gl_GeometryIndexEXT";
    case BuiltIn::WorldRayOriginKHR: return "gl_WorldRayOriginEXT";
    case BuiltIn::WorldRayDirectionKHR: return "gl_WorldRayDirectionEXT";
    case BuiltIn::ObjectRayOriginKHR: return "gl_ObjectRayOriginEXT";
    case BuiltIn::ObjectRayDirectionKHR: return "gl_ObjectRayDirectionEXT";
    case BuiltIn::RayTminKHR: return "gl_RayTminEXT";
    case BuiltIn::RayTmaxKHR: return "gl_RayTmaxEXT";
    case BuiltIn::IncomingRayFlagsKHR: return "gl_IncomingRayFlagsEXT";
    case BuiltIn::HitKindKHR: return "gl_HitKindEXT";
    case BuiltIn::ObjectToWorldKHR: return "gl_ObjectToWorldEXT";
    case BuiltIn::WorldToObjectKHR: return "gl_WorldToObjectEXT";
    default: return "a built-in";
  }
}

}  // namespace quintet::spirv
