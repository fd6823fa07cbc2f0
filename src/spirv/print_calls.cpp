// SPDX-License-Identifier: Apache-2.0
#include "spirv/print_calls.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <string_view>

#include <fmt/format.h>

#include "base/error.h"
#include "spirv/module_writer.h"
#include "spirv/raw_instructions.h"

namespace quintet::spirv {
namespace {

using spv::Op;

constexpr std::string_view kPrintSet = "NonSemantic.DebugPrintf";
constexpr std::uint32_t kDebugPrintf = 1;  // its only instruction

bool isPrint(const Module& module, const Instruction& instruction) {
  return instruction.op == Op::OpExtInst && instruction.at(1) == kDebugPrintf &&
         module.extendedSet(instruction.at(0)) == kPrintSet;
}

PrintArgument argumentOf(const Module& module, Id value) {
  PrintArgument argument;
  if (module.string(value)) {
    argument.typeName = "a string";
    return argument;
  }
  const Instruction* const definition = module.definition(value);
  const Id typeId = definition ? definition->type : 0;
  const Type* type = &module.types().get(typeId);
  argument.typeName = module.types().nameOf(typeId);
  if (type->kind == Type::Kind::vector) {
    argument.count = type->count;
    type = &module.types().get(type->element);
  }
  argument.bits = type->width;
  argument.isSigned = type->isSigned;
  switch (type->kind) {
    case Type::Kind::boolean: argument.kind = PrintArgument::Kind::boolean; break;
    case Type::Kind::integer: argument.kind = PrintArgument::Kind::integer; break;
    case Type::Kind::floating: argument.kind = PrintArgument::Kind::floating; break;
    default: break;
  }
  return argument;
}

class Replacement {
 public:
  Replacement(const Module& module, const std::vector<std::uint32_t>& words, std::uint32_t firstNumber)
      : module_(module), out_(words), number_(firstNumber), calls_(findPrintCalls(module)) {
    begin_ = module.functionNamed("printBegin_");
    word_ = module.functionNamed("printWord_");
    keep_ = module.functionNamed("printKeep_");
    if (begin_ == 0 || word_ == 0 || keep_ == 0) throw Error("a module that prints has no functions for it");
    uintType_ = module.definition(begin_)->type;
  }

  std::vector<std::uint32_t> run() {
    std::size_t call = 0;
    bool inFunctions = false;
    while (!out_.atEnd()) {
      const Op op = out_.next();
      if (op == Op::OpFunction && !inFunctions) {
        inFunctions = true;
        emitConstants();
      }
      if (call < calls_.size() && op == Op::OpExtInst &&
          out_.word(2) == module_.instructions()[calls_[call].instruction].result) {
        replace(calls_[call++]);
        out_.skip();
      } else if (op == Op::OpFunctionCall && out_.word(3) == keep_) {
        out_.skip();
      } else {
        out_.copy();
      }
    }
    return out_.take();
  }

 private:
  // A type that exists, or a new one. Types must be unique.
  Id type(Op op, const std::vector<std::uint32_t>& operands) {
    for (const Instruction& i : module_.instructions())
      if (i.op == op && std::ranges::equal(i.operands, operands)) return i.result;
    std::vector<std::uint32_t> all{out_.newId()};
    all.insert(all.end(), operands.begin(), operands.end());
    out_.emit(op, all);
    return all.front();
  }
  Id constant(std::uint32_t value) { return constants_.at(value); }

  // The types and constants that the replacements use.
  void emitConstants() {
    const auto add = [&](std::size_t value) {
      const auto word = static_cast<std::uint32_t>(value);
      if (constants_.contains(word)) return;
      const Id id = constants_[word] = out_.newId();
      out_.emit(Op::OpConstant, {uintType_, id, word});
    };
    bool hasHalf = false, hasLong = false;
    for (std::size_t k = 0; k < calls_.size(); ++k) {
      std::size_t count = 0;
      for (const PrintArgument& argument : calls_[k].arguments) {
        count += argument.wordCount();
        hasHalf = hasHalf || (argument.kind == PrintArgument::Kind::floating && argument.bits == 16);
        hasLong = hasLong || argument.bits == 64;
        if (argument.kind == PrintArgument::Kind::boolean) add(0), add(1);
      }
      add(count);
      add(number_ + k);
    }
    if (hasHalf) floatType_ = type(Op::OpTypeFloat, {32});
    if (hasLong) uvec2Type_ = type(Op::OpTypeVector, {uintType_, 2});
  }

  void replace(const PrintCall& call) {
    std::size_t count = 0;
    for (const PrintArgument& argument : call.arguments) count += argument.wordCount();
    Id at = out_.newId();
    out_.emit(Op::OpFunctionCall,
              {uintType_, at, begin_, constant(number_++), constant(static_cast<std::uint32_t>(count))});
    const Instruction& print = module_.instructions()[call.instruction];
    for (std::size_t i = 0; i < call.arguments.size(); ++i) {
      const PrintArgument& argument = call.arguments[i];
      const Id value = print.at(3 + i);
      const Id valueType = module_.definition(value)->type;
      for (std::uint32_t component = 0; component < argument.count; ++component) {
        Id scalar = value, scalarType = valueType;
        if (argument.count > 1) {
          scalarType = module_.types().get(valueType).element;
          scalar = emitNew(Op::OpCompositeExtract, scalarType, {value, component});
        }
        for (const Id word : wordsOf(scalar, argument)) at = emitNew(Op::OpFunctionCall, uintType_, {word_, at, word});
      }
    }
  }

  Id emitNew(Op op, Id type, std::vector<std::uint32_t> operands) {
    const Id id = out_.newId();
    operands.insert(operands.begin(), {type, id});
    out_.emit(op, operands);
    return id;
  }

  std::vector<Id> wordsOf(Id scalar, const PrintArgument& argument) {
    using Kind = PrintArgument::Kind;
    if (argument.kind == Kind::boolean) return {emitNew(Op::OpSelect, uintType_, {scalar, constant(1), constant(0)})};
    if (argument.bits == 64) {
      const Id both = emitNew(Op::OpBitcast, uvec2Type_, {scalar});
      return {emitNew(Op::OpCompositeExtract, uintType_, {both, 0}),
              emitNew(Op::OpCompositeExtract, uintType_, {both, 1})};
    }
    if (argument.kind == Kind::floating) {
      if (argument.bits == 16) scalar = emitNew(Op::OpFConvert, floatType_, {scalar});
      return {emitNew(Op::OpBitcast, uintType_, {scalar})};
    }
    if (argument.bits < 32) return {emitNew(argument.isSigned ? Op::OpSConvert : Op::OpUConvert, uintType_, {scalar})};
    return {argument.isSigned ? emitNew(Op::OpBitcast, uintType_, {scalar}) : scalar};
  }

  const Module& module_;
  ModuleWriter out_;
  std::uint32_t number_;
  const std::vector<PrintCall> calls_;
  Id begin_ = 0, word_ = 0, keep_ = 0;  // functions
  Id uintType_ = 0, uvec2Type_ = 0, floatType_ = 0;
  std::map<std::uint32_t, Id> constants_;
};

}  // namespace

bool importsDebugPrintf(std::span<const std::uint32_t> words) {
  // OpExtInstImport: opcode, result, then the name as words.
  std::array<std::uint32_t, 6> name{};
  static_assert(sizeof(name) == kPrintSet.size() + 1);
  std::memcpy(name.data(), kPrintSet.data(), kPrintSet.size());
  for (const RawInstruction& i : RawInstructions(words)) {
    if (i.op == Op::OpExtInstImport && !i.operands.empty() && std::ranges::equal(i.operands.subspan(1), name))
      return true;
    if (i.op == Op::OpFunction) return false;
  }
  return false;
}

std::vector<PrintCall> findPrintCalls(const Module& module) {
  std::vector<PrintCall> calls;
  for (std::size_t i = 0; i < module.instructions().size(); ++i) {
    const Instruction& instruction = module.instructions()[i];
    if (!isPrint(module, instruction)) continue;
    PrintCall& call = calls.emplace_back();
    call.instruction = i;
    if (const std::string* format = module.string(instruction.at(2))) call.format = *format;
    for (std::size_t k = 3; k < instruction.operands.size(); ++k)
      call.arguments.push_back(argumentOf(module, instruction.at(k)));
  }
  return calls;
}

std::vector<std::uint32_t> replacePrintCalls(const std::vector<std::uint32_t>& words, std::uint32_t firstNumber) {
  std::string why;
  const std::optional<Module> module = Module::read(words, &why);
  if (!module) throw Error(fmt::format("cannot read the SPIR-V of a stage that prints: {}", why));
  return Replacement(*module, words, firstNumber).run();
}

}  // namespace quintet::spirv
