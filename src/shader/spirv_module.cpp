#include "shader/spirv_module.h"

#include <algorithm>
#include <bit>
#include <cctype>

#include "shader/spirv_reader.h"

namespace quintet::shader {
namespace {

constexpr int kMaxChain = 64;  // access chains upon access chains
constexpr std::size_t kMaxValues = 16;
constexpr int kMaxCallLines = 16;

bool isWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

std::string_view lineOf(std::string_view text, std::uint32_t line) {
  for (std::uint32_t i = 1; i < line && !text.empty(); ++i) {
    const std::size_t end = text.find('\n');
    text = end == text.npos ? std::string_view() : text.substr(end + 1);
  }
  return text.substr(0, text.find('\n'));
}

// Column of a word in a line, 1-based; 0: not there.
int columnOf(std::string_view line, std::string_view token) {
  for (std::size_t at = token.empty() ? line.npos : line.find(token); at != line.npos; at = line.find(token, at + 1)) {
    const bool starts = at == 0 || !isWord(token.front()) || !isWord(line[at - 1]);
    const std::size_t end = at + token.size();
    if (starts && (end >= line.size() || !isWord(token.back()) || !isWord(line[end]))) return static_cast<int>(at) + 1;
  }
  return 0;
}

}  // namespace

std::optional<SpirvModule> SpirvModule::read(std::vector<std::uint32_t> words, std::string* why) {
  SpirvModule module;
  module.words_ = std::move(words);
  SpirvReader reader(module);
  if (reader.read()) return module;
  if (why) *why = reader.error();
  return {};
}

const SpirvFunction* SpirvModule::entry() const { return function(entry_); }

const SpirvFunction* SpirvModule::function(SpirvId id) const {
  const auto found = std::ranges::find(functions_, id, &SpirvFunction::id);
  return found == functions_.end() || id == 0 ? nullptr : &*found;
}

std::size_t SpirvModule::definitionIndex(SpirvId id) const {
  return id < definitions_.size() ? definitions_[id] : kNone;
}

const SpirvInstruction* SpirvModule::definition(SpirvId id) const {
  const std::size_t index = definitionIndex(id);
  return index < instructions_.size() ? &instructions_[index] : nullptr;
}

const std::vector<std::size_t>& SpirvModule::users(SpirvId id) const {
  static const std::vector<std::size_t> kNobody;
  return id < users_.size() ? users_[id] : kNobody;
}

std::optional<SpirvModule::Position> SpirvModule::position(std::size_t instruction) const {
  if (instruction < firstInFunctions_ || instruction - firstInFunctions_ >= positions_.size()) return {};
  const Position position = positions_[instruction - firstInFunctions_];
  return position.function == kNone ? std::nullopt : std::optional(position);
}

std::string SpirvModule::name(SpirvId id) const {
  const auto found = names_.find(id);
  return found == names_.end() ? std::string() : found->second;
}

std::optional<std::uint32_t> SpirvModule::decoration(SpirvId id, spv::Decoration decoration) const {
  const auto found = decorations_.find({id, static_cast<std::uint32_t>(decoration)});
  return found == decorations_.end() ? std::nullopt : std::optional(found->second);
}

const SpirvVariable* SpirvModule::variable(SpirvId id) const {
  const auto found = std::ranges::find(variables_, id, &SpirvVariable::id);
  return found == variables_.end() || id == 0 ? nullptr : &*found;
}

std::string_view SpirvModule::extendedSet(SpirvId id) const {
  const auto found = extendedSets_.find(id);
  return found == extendedSets_.end() ? std::string_view() : std::string_view(found->second);
}

std::optional<std::uint32_t> SpirvModule::constantBits(SpirvId id) const {
  const SpirvInstruction* value = definition(id);
  if (!value) return {};
  switch (value->op) {
    case spv::Op::OpConstantTrue: return 1u;
    case spv::Op::OpConstantFalse:
    case spv::Op::OpConstantNull: return 0u;
    case spv::Op::OpConstant: {
      const SpirvType& type = types_.get(value->type);
      if (type.kind != SpirvType::Kind::integer || type.width > 32 || value->operands.empty()) return {};
      return value->at(0);
    }
    default: return {};
  }
}

std::optional<double> SpirvModule::constantFloat(SpirvId id) const {
  const SpirvInstruction* value = definition(id);
  if (!value) return {};
  const SpirvType& type = types_.get(value->type);
  if (type.kind != SpirvType::Kind::real) return {};
  if (value->op == spv::Op::OpConstantNull) return 0.0;
  if (value->op != spv::Op::OpConstant) return {};
  if (type.width == 32 && value->operands.size() == 1) return std::bit_cast<float>(value->at(0));
  if (type.width == 64 && value->operands.size() == 2)
    return std::bit_cast<double>(value->at(0) | std::uint64_t{value->at(1)} << 32);
  return {};
}

bool SpirvModule::isConstant(SpirvId id) const {
  const SpirvInstruction* value = definition(id);
  return value && (value->op == spv::Op::OpConstant || value->op == spv::Op::OpConstantTrue ||
                   value->op == spv::Op::OpConstantFalse || value->op == spv::Op::OpConstantNull ||
                   value->op == spv::Op::OpConstantComposite || value->op == spv::Op::OpUndef);
}

std::optional<std::vector<std::uint32_t>> SpirvModule::possibleValues(SpirvId id) const {
  std::vector<SpirvId> open{id}, seen;
  std::vector<std::uint32_t> values;
  while (!open.empty()) {
    const SpirvId next = open.back();
    open.pop_back();
    if (std::ranges::find(seen, next) != seen.end()) continue;
    seen.push_back(next);
    if (const auto bits = constantBits(next)) {
      if (std::ranges::find(values, *bits) == values.end()) values.push_back(*bits);
      if (values.size() > kMaxValues) return {};
      continue;
    }
    const SpirvInstruction* value = definition(next);
    if (!value || seen.size() > 8 * kMaxValues) return {};
    if (value->op == spv::Op::OpSelect) {
      open.push_back(value->at(1));
      open.push_back(value->at(2));
    } else if (value->op == spv::Op::OpPhi) {
      for (std::size_t i = 0; i < value->operands.size(); i += 2) open.push_back(value->at(i));
    } else {
      return {};
    }
  }
  std::ranges::sort(values);
  return values;
}

SpirvAccess SpirvModule::access(SpirvId pointer) const {
  SpirvAccess result;
  for (int depth = 0; depth < kMaxChain; ++depth) {
    const SpirvInstruction* value = definition(pointer);
    if (!value) break;
    if (value->op == spv::Op::OpVariable || value->op == spv::Op::OpFunctionParameter) {
      result.variable = pointer;
      return result;
    }
    const bool chain = value->op == spv::Op::OpAccessChain || value->op == spv::Op::OpInBoundsAccessChain;
    if (!chain && value->op != spv::Op::OpCopyObject) break;
    std::vector<std::optional<std::uint32_t>> indices;
    for (std::size_t i = 1; chain && i < value->operands.size(); ++i) indices.push_back(constantBits(value->at(i)));
    result.indices.insert(result.indices.begin(), indices.begin(), indices.end());
    pointer = value->at(0);
  }
  return {};
}

Place SpirvModule::place(const SpirvInstruction& instruction, std::string_view token) const {
  const auto file = strings_.find(instruction.file);
  if (file == strings_.end()) return {};
  Place place{file->second, static_cast<int>(instruction.line & 0x7FFFFFFFu),
              static_cast<int>(instruction.column & 0x7FFFFFFFu)};
  // glslang names the line where a call ends: a call over several lines starts some lines before it.
  for (int back = 0; place.column == 0 && back < kMaxCallLines && place.line - back > 0 && !token.empty(); ++back) {
    const int column = columnOf(lineOf(source(place.file), static_cast<std::uint32_t>(place.line - back)), token);
    if (column > 0) place.line -= back, place.column = column;
  }
  return place;
}

std::string_view SpirvModule::source(const std::string& file) const {
  for (const auto* texts : {&sources_, &otherSources_})
    if (const auto found = texts->find(file); found != texts->end()) return found->second;
  return {};
}

}  // namespace quintet::shader
