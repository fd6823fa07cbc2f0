// SPDX-License-Identifier: Apache-2.0
#include "spirv/value_checks.h"

#include <spirv/unified1/GLSL.std.450.h>
#include <array>
#include <map>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "base/error.h"
#include "spirv/module_writer.h"

namespace quintet::spirv {
namespace {

using spv::Op;

// Components of a 32-bit float or a vector of them; 0 for all other types.
std::uint32_t componentsOf(const Module& module, Id typeId) {
  const Type* type = &module.types().get(typeId);
  std::uint32_t count = 1;
  if (type->kind == Type::Kind::vector) {
    count = type->count;
    type = &module.types().get(type->element);
  }
  return type->kind == Type::Kind::floating && type->width == 32 && count <= 4 ? count : 0;
}

Id typeIdOf(const Module& module, Id value) {
  const Instruction* const definition = module.definition(value);
  return definition ? definition->type : 0;
}

// Functions that pass values on, or that never make a finite value infinite, are not listed.
std::string_view functionName(std::uint32_t function) {
  switch (function) {
    case GLSLstd450Sqrt: return "sqrt";
    case GLSLstd450InverseSqrt: return "inversesqrt";
    case GLSLstd450Pow: return "pow";
    case GLSLstd450Exp: return "exp";
    case GLSLstd450Exp2: return "exp2";
    case GLSLstd450Log: return "log";
    case GLSLstd450Log2: return "log2";
    case GLSLstd450Sin: return "sin";
    case GLSLstd450Cos: return "cos";
    case GLSLstd450Tan: return "tan";
    case GLSLstd450Asin: return "asin";
    case GLSLstd450Acos: return "acos";
    case GLSLstd450Atan2: return "atan";
    case GLSLstd450Sinh: return "sinh";
    case GLSLstd450Cosh: return "cosh";
    case GLSLstd450Acosh: return "acosh";
    case GLSLstd450Atanh: return "atanh";
    case GLSLstd450Normalize: return "normalize";
    case GLSLstd450Length: return "length";
    case GLSLstd450Distance: return "distance";
    case GLSLstd450Cross: return "cross";
    case GLSLstd450Reflect: return "reflect";
    case GLSLstd450Refract: return "refract";
    case GLSLstd450FMix: return "mix";
    case GLSLstd450SmoothStep: return "smoothstep";
    case GLSLstd450Fma: return "fma";
    case GLSLstd450Fract: return "fract";
    case GLSLstd450Ldexp: return "ldexp";
    case GLSLstd450UnpackHalf2x16: return "unpackHalf2x16";
    default: return {};
  }
}

bool readsMemory(const Module& module, const Instruction& load) {
  const Instruction* const pointer = module.definition(load.at(0));
  if (!pointer) return false;
  const Instruction* const type = module.definition(pointer->type);
  if (!type || type->op != Op::OpTypePointer) return false;
  switch (static_cast<spv::StorageClass>(type->at(0))) {
    case spv::StorageClass::PhysicalStorageBuffer:
    case spv::StorageClass::StorageBuffer:
    case spv::StorageClass::Uniform: return true;
    default: return false;
  }
}

// Empty for operations that are not checked.
std::string_view operationOf(const Module& module, const Instruction& i) {
  if (componentsOf(module, i.type) == 0) return {};
  switch (i.op) {
    case Op::OpFAdd: return "addition";
    case Op::OpFSub: return "subtraction";
    case Op::OpFMul:
    case Op::OpVectorTimesScalar:
    case Op::OpMatrixTimesVector:
    case Op::OpVectorTimesMatrix: return "multiplication";
    case Op::OpFDiv: return "division";
    case Op::OpFRem:
    case Op::OpFMod: return "mod";
    case Op::OpDot: return "dot";
    case Op::OpFConvert: return "conversion to float";
    case Op::OpBitcast: return "conversion of bits";
    case Op::OpExtInst: return module.extendedSet(i.at(0)) == "GLSL.std.450" ? functionName(i.at(1)) : "";
    case Op::OpLoad: return readsMemory(module, i) ? "read of a buffer" : "";
    case Op::OpImageSampleImplicitLod:
    case Op::OpImageSampleExplicitLod:
    case Op::OpImageFetch:
    case Op::OpImageRead: return "read of an image";
    default: return {};
  }
}

class ValueChecks {
 public:
  ValueChecks(const Module& module, const std::vector<std::uint32_t>& words, std::uint32_t firstNumber)
      : module_(module), out_(words), number_(firstNumber), values_(findCheckedValues(module)) {
    for (std::size_t i = 0; i < functions_.size(); ++i)
      functions_[i] = module.functionNamed("valueResult" + std::to_string(i + 1) + "_");
    keep_ = module.functionNamed("valuesKeep_");
    if (keep_ == 0 || functions_[0] == 0 || functions_[1] == 0 || functions_[2] == 0 || functions_[3] == 0)
      throw Error("a module whose values are checked has no functions for it");
    voidType_ = module.definition(keep_)->type;
    // The parameters of valueResult1_ are the number and three floats.
    const Function* const first = module.function(functions_[0]);
    numberType_ = first && !first->parameters.empty() ? typeIdOf(module, first->parameters.front()) : 0;
    if (numberType_ == 0) throw Error("a module whose values are checked has other functions for it");
  }

  std::vector<std::uint32_t> run() {
    std::size_t value = 0;
    bool inFunctions = false;
    while (!out_.atEnd()) {
      const Op op = out_.next();
      if (op == Op::OpFunction && !inFunctions) {
        inFunctions = true;
        emitConstants();
      }
      if (op == Op::OpFunctionCall && out_.word(3) == keep_) {
        out_.skip();
        continue;
      }
      const bool isChecked = value < values_.size() && inFunctions && hasResult(values_[value]);
      out_.copy();
      if (!isChecked) continue;
      check(values_[value], value);
      ++value;
    }
    return out_.take();
  }

 private:
  const Instruction& instructionOf(const CheckedValue& value) const {
    return module_.instructions()[value.instruction];
  }
  // Whether the next instruction of the source is this one: operations with a type have the result in the second word.
  bool hasResult(const CheckedValue& value) const {
    const Instruction& i = instructionOf(value);
    return out_.next() == i.op && out_.word(1) == i.type && out_.word(2) == i.result;
  }

  void emitConstants() {
    for (std::size_t k = 0; k < values_.size(); ++k) {
      numbers_.push_back(out_.newId());
      out_.emit(Op::OpConstant, {numberType_, numbers_.back(), number_ + static_cast<std::uint32_t>(k)});
      const Instruction& i = instructionOf(values_[k]);
      addZero(i.type);
      for (const Id operand : valueOperands(i))
        if (const Id type = typeIdOf(module_, operand); componentsOf(module_, type) > 0) addZero(type);
    }
  }
  void addZero(Id type) {
    if (zeros_.contains(type)) return;
    zeros_[type] = out_.newId();
    out_.emit(Op::OpConstantNull, {type, zeros_[type]});
  }

  void check(const CheckedValue& value, std::size_t k) {
    const Instruction& i = instructionOf(value);
    const std::uint32_t count = componentsOf(module_, i.type);
    std::array<Id, 2> operands{zeros_.at(i.type), zeros_.at(i.type)};
    std::size_t known = 0;
    // What an operation reads has no operands, and bits are no number.
    const bool reads = i.op == Op::OpBitcast || i.op == Op::OpLoad || i.op == Op::OpImageSampleImplicitLod ||
                       i.op == Op::OpImageSampleExplicitLod || i.op == Op::OpImageFetch || i.op == Op::OpImageRead;
    if (!reads)
      for (const Id operand : valueOperands(i)) {
        const Id type = typeIdOf(module_, operand);
        if (componentsOf(module_, type) == 0 || known == operands.size()) continue;
        operands[known++] = type == i.type ? operand : converted(operand, type, i.type, count);
      }
    out_.emit(Op::OpFunctionCall,
              {voidType_, out_.newId(), functions_[count - 1], numbers_[k], i.result, operands[0], operands[1]});
  }

  // An operand with another number of components as a value of the result's type. Vectors become their product with 0,
  // which is 0 unless a component is not finite.
  Id converted(Id operand, Id type, Id resultType, std::uint32_t count) {
    Id scalar = operand;
    const Type& of = module_.types().get(type);
    if (of.kind == Type::Kind::vector) {
      scalar = out_.newId();
      out_.emit(Op::OpDot, {of.element, scalar, operand, zeros_.at(type)});
    }
    if (count == 1) return scalar;
    const Id result = out_.newId();
    std::vector<std::uint32_t> words{resultType, result};
    words.insert(words.end(), count, scalar);
    out_.emit(Op::OpCompositeConstruct, words);
    return result;
  }

  const Module& module_;
  ModuleWriter out_;
  std::uint32_t number_;
  const std::vector<CheckedValue> values_;
  std::array<Id, 4> functions_{};  // by the number of components - 1
  Id keep_ = 0, voidType_ = 0, numberType_ = 0;
  std::vector<Id> numbers_;  // constants, by value
  std::map<Id, Id> zeros_;   // constants, by type
};

}  // namespace

std::vector<CheckedValue> findCheckedValues(const Module& module) {
  std::vector<CheckedValue> values;
  for (std::size_t i = 0; i < module.instructions().size(); ++i) {
    const Instruction& instruction = module.instructions()[i];
    if (instruction.result == 0 || !module.position(i)) continue;  // outside of functions
    if (const std::string_view operation = operationOf(module, instruction); !operation.empty())
      values.push_back({i, operation});
  }
  return values;
}

std::vector<std::uint32_t> addValueChecks(const std::vector<std::uint32_t>& words, std::uint32_t firstNumber) {
  std::string why;
  const std::optional<Module> module = Module::read(words, &why);
  if (!module) throw Error(fmt::format("cannot read the SPIR-V of a stage whose values are checked: {}", why));
  return ValueChecks(*module, words, firstNumber).run();
}

}  // namespace quintet::spirv
