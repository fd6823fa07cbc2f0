// SPDX-License-Identifier: Apache-2.0
#include "spirv/plain_lines.h"

#include <spirv/unified1/NonSemanticShaderDebugInfo100.h>
#include <algorithm>
#include <cstddef>
#include <cstring>
#include <initializer_list>
#include <map>
#include <set>
#include <spirv/unified1/spirv.hpp11>
#include <string_view>
#include <utility>

#include "spirv/raw_instructions.h"
#include "spirv/type.h"

namespace quintet::spirv {
namespace {

using spv::Op;

constexpr std::size_t kMaxInstruction = 65535;
constexpr auto kForwardReferences = static_cast<Op>(4433);  // OpExtInstWithForwardRefsKHR, of Slang
constexpr std::string_view kDebugInfoSet = "NonSemantic.Shader.DebugInfo.100";

struct Location {
  Id file = 0;  // OpString
  std::uint32_t line = 0, column = 0;
};

bool isText(Words literal, std::string_view text) {
  return literal.size() * sizeof(std::uint32_t) > text.size() &&
         std::memcmp(literal.data(), text.data(), text.size()) == 0 &&
         reinterpret_cast<const char*>(literal.data())[text.size()] == '\0';
}

class Converter {
 public:
  explicit Converter(Words words) : words_(words) {}

  std::vector<std::uint32_t> run() {
    for (const RawInstruction& i : RawInstructions(words_)) collect(i.op, i.operands);
    if (sets_.empty()) return {words_.begin(), words_.end()};
    for (const RawInstruction& i : RawInstructions(words_))
      if (isDebugInfo(i.op, i.operands)) collectDebugInfo(i.operands);
    result_ = headerOf(words_);
    for (const RawInstruction& i : RawInstructions(words_)) convert(i.op, i.operands, i.words);
    return std::move(result_);
  }

 private:
  static std::uint32_t at(Words operands, std::size_t i) { return i < operands.size() ? operands[i] : 0; }

  bool isDebugInfo(Op op, Words operands) const {
    return (op == Op::OpExtInst || op == kForwardReferences) && operands.size() > 3 && sets_.contains(operands[2]);
  }

  void collect(Op op, Words operands) {
    if (op == Op::OpExtInstImport && operands.size() > 1 && isText(operands.subspan(1), kDebugInfoSet))
      sets_.insert(operands[0]);
    if (op == Op::OpString && operands.size() > 1) strings_[operands[0]] = operands.subspan(1);
    if (op == Op::OpConstant && operands.size() > 2) constants_[operands[1]] = operands[2];
  }

  Location location(Words operands, std::size_t source, std::size_t line, std::size_t column) const {
    const auto file = files_.find(at(operands, source));
    const auto number = [&](std::size_t i) {
      const auto found = constants_.find(at(operands, i));
      return found == constants_.end() ? 0u : found->second;
    };
    return file == files_.end() ? Location{} : Location{file->second, number(line), number(column)};
  }

  // Operands: result type, result, set, instruction, arguments.
  void collectDebugInfo(Words operands) {
    switch (operands[3]) {
      case NonSemanticShaderDebugInfo100DebugSource:
        files_[operands[1]] = at(operands, 4);
        texts_.push_back({at(operands, 4), {}});
        if (strings_.contains(at(operands, 5))) texts_.back().second.push_back(at(operands, 5));
        break;
      case NonSemanticShaderDebugInfo100DebugSourceContinued:
        if (!texts_.empty() && strings_.contains(at(operands, 4))) texts_.back().second.push_back(at(operands, 4));
        break;
      case NonSemanticShaderDebugInfo100DebugGlobalVariable:
        declarations_[at(operands, 11)] = location(operands, 6, 7, 8);
        break;
      case NonSemanticShaderDebugInfo100DebugFunction: functions_[operands[1]] = location(operands, 6, 7, 8); break;
      case NonSemanticShaderDebugInfo100DebugFunctionDefinition:
        if (const auto found = functions_.find(at(operands, 4)); found != functions_.end())
          declarations_[at(operands, 5)] = found->second;
        break;
      default: break;
    }
  }

  void add(Op op, std::initializer_list<std::uint32_t> operands, Words literal = {}) {
    const std::size_t count = 1 + operands.size() + literal.size();
    if (count > kMaxInstruction) return;
    result_.push_back(static_cast<std::uint32_t>(count << 16) | static_cast<std::uint32_t>(op));
    result_.insert(result_.end(), operands);
    append(result_, literal);
  }

  // The instructions before names: sources must follow the strings.
  static bool isBeforeNames(Op op) {
    switch (op) {
      case Op::OpCapability:
      case Op::OpExtension:
      case Op::OpExtInstImport:
      case Op::OpMemoryModel:
      case Op::OpEntryPoint:
      case Op::OpExecutionMode:
      case Op::OpExecutionModeId:
      case Op::OpString:
      case Op::OpSourceExtension:
      case Op::OpSource:
      case Op::OpSourceContinued: return true;
      default: return false;
    }
  }

  void addSources() {
    for (const auto& [file, texts] : texts_)
      for (std::size_t i = 0; i < texts.size(); ++i) {
        if (i == 0)
          add(Op::OpSource, {static_cast<std::uint32_t>(spv::SourceLanguage::Unknown), 0, file}, strings_[texts[i]]);
        else
          add(Op::OpSourceContinued, {}, strings_[texts[i]]);
      }
    texts_.clear();
  }

  void convert(Op op, Words operands, Words instruction) {
    // While the set is imported, spirv-opt writes OpNoLine as one of its instructions, also where these are not allowed.
    if (op == Op::OpExtInstImport && sets_.contains(at(operands, 0))) return;
    if (!isBeforeNames(op)) addSources();
    if (isDebugInfo(op, operands)) {
      if (operands[3] == NonSemanticShaderDebugInfo100DebugLine) {
        const Location line = location(operands, 4, 5, 7);
        if (line.file != 0) add(Op::OpLine, {line.file, line.line, line.column});
      } else if (operands[3] == NonSemanticShaderDebugInfo100DebugNoLine) {
        add(Op::OpNoLine, {});
      }
      return;
    }
    const bool declares = op == Op::OpVariable || op == Op::OpFunction;
    const auto declared = declares ? declarations_.find(at(operands, 1)) : declarations_.end();
    const bool known = declared != declarations_.end() && declared->second.file != 0;
    if (known) add(Op::OpLine, {declared->second.file, declared->second.line, declared->second.column});
    append(result_, instruction);
    if (known && op == Op::OpVariable) add(Op::OpNoLine, {});
  }

  Words words_;
  std::set<Id> sets_;
  std::map<Id, Words> strings_;
  std::map<Id, std::uint32_t> constants_;
  std::map<Id, Id> files_;  // DebugSource: OpString of the file
  std::vector<std::pair<Id, std::vector<Id>>> texts_;
  std::map<Id, Location> functions_, declarations_;
  std::vector<std::uint32_t> result_;
};

}  // namespace

std::vector<std::uint32_t> withPlainLines(std::span<const std::uint32_t> words) { return Converter(words).run(); }

}  // namespace quintet::spirv
