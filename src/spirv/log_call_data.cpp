// SPDX-License-Identifier: Apache-2.0
#include "spirv/log_call_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "base/error.h"
#include "spirv/module.h"
#include "spirv/module_writer.h"

namespace quintet::spirv {
namespace {

using spv::Op;

// A field, and how the module gets its words.
struct LoggedPart {
  Path path;         // from the variable
  Id type = 0;       // of the scalar or vector
  Id component = 0;  // type of its components
};

constexpr std::uint64_t kMostWords = 1u << 16;  // parts beyond them are not counted

class FieldList {
 public:
  FieldList(const Types& types, std::uint32_t maxWords) : types_(types), maxWords_(maxWords) {}

  void add(Id id, const std::string& name) {
    const Type& type = types_.get(id);
    switch (type.kind) {
      case Type::Kind::boolean:
      case Type::Kind::integer:
      case Type::Kind::floating: return addScalars(id, id, 1, name);
      case Type::Kind::vector: return addScalars(id, type.element, type.count, name);
      case Type::Kind::matrix:
      case Type::Kind::array:
      case Type::Kind::structure: return addParts(type, name);
      default: complete = false;
    }
  }

  std::vector<DataField> fields;
  std::vector<LoggedPart> parts;
  bool complete = true;
  std::uint64_t words = 0;  // of all fields, also of those that do not fit

 private:
  void addParts(const Type& type, const std::string& name) {
    for (std::uint32_t i = 0; i < type.partCount() && words <= kMostWords; ++i) {
      path_.push_back(i);
      const bool named = type.kind == Type::Kind::structure && i < type.memberNames.size();
      add(type.part(i), named ? name + "." + type.memberNames[i] : fmt::format("{}[{}]", name, i));
      path_.pop_back();
    }
    complete = complete && words <= kMostWords;
  }

  void addScalars(Id id, Id component, std::uint32_t count, const std::string& name) {
    const Type& type = types_.get(component);
    DataField field;
    field.name = name;
    field.type = types_.nameOf(id);
    field.components = count;
    field.firstWord = words_;
    field.width = type.kind == Type::Kind::boolean ? 32 : std::max(type.width, 32u);
    field.kind = type.kind == Type::Kind::boolean    ? DataField::Kind::boolean
                 : type.kind == Type::Kind::floating ? DataField::Kind::floating
                 : type.isSigned                     ? DataField::Kind::signedInteger
                                                     : DataField::Kind::unsignedInteger;
    words += field.wordCount();
    if (words_ + field.wordCount() > maxWords_) {
      complete = false;
      return;
    }
    words_ += field.wordCount();
    fields.push_back(std::move(field));
    parts.push_back({path_, id, component});
  }

  const Types& types_;
  const std::uint32_t maxWords_;
  std::uint32_t words_ = 0;
  Path path_;
};

// The data of a call.
struct Call {
  const Variable* variable = nullptr;
  std::vector<LoggedPart> parts;
};

// A marking store, by its instruction.
struct Marker {
  std::size_t call = Module::kNone;  // index of the call; kNone: none
};

class DataLogger {
 public:
  DataLogger(const Module& module, const std::vector<std::uint32_t>& words, const DataMarkers& markers,
             std::uint32_t firstNumber)
      : module_(module), markers_(markers), firstNumber_(firstNumber), out_(words) {}

  LoggedCalls run() {
    findCalls();
    if (stores_.empty()) return {};
    decideIds();
    std::size_t index = 0;
    bool constantsDone = false;
    while (!out_.atEnd()) {
      const Op op = out_.next();
      if (op == Op::OpFunction && !constantsDone) {
        emitConstants();
        constantsDone = true;
      }
      const bool isLine = op == Op::OpLine || op == Op::OpNoLine;  // Module::instructions() does not have them
      if (const auto found = isLine ? stores_.end() : stores_.find(index++); found != stores_.end())
        replaceStore(module_.instructions()[found->first], found->second);
      else
        out_.copy();
    }
    return {out_.take(), std::move(sites_), maxWords_};
  }

 private:
  // Pairs the markers with the calls: in the order of the module they alternate before, call, after.
  void findCalls() {
    std::vector<std::size_t> open;  // markers before the next call
    std::size_t last = Module::kNone;
    for (std::size_t i = 0; i < module_.instructions().size(); ++i) {
      const Instruction& instruction = module_.instructions()[i];
      if (instruction.op == Op::OpStore) {
        const std::optional<std::uint32_t> value = module_.constantBits(instruction.at(1));
        if (!value || !isWordPointer(instruction.at(0))) continue;
        if (value == markers_.before) {
          stores_[i] = {};
          open.push_back(i);
        } else if (value == markers_.after) {
          stores_[i] = {last};
        }
      } else if (const Variable* data = dataOf(instruction)) {
        last = addCall(instruction, *data);
        for (const std::size_t marker : open) stores_[marker] = {last};
        open.clear();
      }
    }
  }

  const Variable* dataOf(const Instruction& instruction) const {
    if (instruction.op == Op::OpTraceRayKHR) return module_.variable(module_.access(instruction.at(10)).variable);
    if (instruction.op == Op::OpExecuteCallableKHR) return module_.variable(module_.access(instruction.at(1)).variable);
    return nullptr;
  }

  // The last index is the position in the log.
  bool isWordPointer(Id pointer) const {
    const Instruction* chain = module_.definition(pointer);
    return chain && isAccessChain(chain->op) && chain->operands.size() >= 2;
  }

  std::size_t addCall(const Instruction& instruction, const Variable& variable) {
    FieldList list(module_.types(), markers_.maxWords);
    list.add(variable.type, variable.name);
    maxWords_ = std::max(maxWords_, static_cast<std::uint32_t>(list.words));
    const bool trace = instruction.op == Op::OpTraceRayKHR;
    sites_.push_back({variable.name, module_.types().nameOf(variable.type), std::move(list.fields), list.complete,
                      module_.location(instruction, trace ? "traceRayEXT" : "executeCallableEXT")});
    calls_.push_back({&variable, std::move(list.parts)});
    return calls_.size() - 1;
  }

  // Types and constants that the stores use. All of them are new ids, except types that the module has.
  void decideIds() {
    const Instruction& store = module_.instructions()[stores_.begin()->first];
    wordType_ = module_.definition(store.at(1))->type;
    for (const auto& [index, marker] : stores_) useConstant(numberOf(marker));
    useConstant(0);
    useConstant(1);
    for (std::uint32_t i = 0; i <= markers_.maxWords; ++i) useConstant(i);
    for (const Instruction& instruction : module_.instructions())
      if (instruction.op == Op::OpTypeVector && instruction.at(0) == wordType_ && instruction.at(1) == 2)
        pairType_ = instruction.result;
    for (const Instruction& instruction : module_.instructions())
      if (instruction.op == Op::OpTypeFloat && instruction.at(0) == 32) floatType_ = instruction.result;
    if (pairType_ == 0) newPairType_ = pairType_ = out_.newId();
    if (floatType_ == 0) newFloatType_ = floatType_ = out_.newId();
  }
  void useConstant(std::uint32_t value) {
    if (!constants_.contains(value)) constants_[value] = out_.newId();
  }

  void emitConstants() {
    for (const auto& [value, id] : constants_) out_.emit(Op::OpConstant, {wordType_, id, value});
    if (newFloatType_ != 0) out_.emit(Op::OpTypeFloat, {newFloatType_, 32});
    if (newPairType_ != 0) out_.emit(Op::OpTypeVector, {newPairType_, wordType_, 2});
  }

  std::uint32_t numberOf(const Marker& marker) const {
    return marker.call == Module::kNone ? kNoCallSite : firstNumber_ + static_cast<std::uint32_t>(marker.call);
  }

  void replaceStore(const Instruction& store, const Marker& marker) {
    out_.skip();
    const Instruction& chain = *module_.definition(store.at(0));
    storeWord(store, chain, 0, constants_.at(numberOf(marker)));
    if (marker.call == Module::kNone) return;
    const Call& call = calls_[marker.call];
    const Id value = out_.newId();
    out_.emit(Op::OpLoad, {call.variable->type, value, call.variable->id});
    std::uint32_t word = 1;
    for (const LoggedPart& part : call.parts) {
      Id scalars = value;
      if (!part.path.empty()) {
        scalars = out_.newId();
        std::vector<std::uint32_t> operands{part.type, scalars, value};
        operands.insert(operands.end(), part.path.begin(), part.path.end());
        out_.emit(Op::OpCompositeExtract, operands);
      }
      const Type& type = module_.types().get(part.type);
      if (type.kind != Type::Kind::vector) {
        storeScalar(store, chain, word, part.component, scalars);
        continue;
      }
      for (std::uint32_t i = 0; i < type.count; ++i) {
        const Id component = out_.newId();
        out_.emit(Op::OpCompositeExtract, {part.component, component, scalars, i});
        storeScalar(store, chain, word, part.component, component);
      }
    }
  }

  void storeScalar(const Instruction& store, const Instruction& chain, std::uint32_t& word, Id typeId, Id value) {
    const Type& type = module_.types().get(typeId);
    if (type.kind != Type::Kind::boolean && type.width == 64) {
      const Id pair = out_.newId();
      out_.emit(Op::OpBitcast, {pairType_, pair, value});
      for (std::uint32_t i = 0; i < 2; ++i) {
        const Id half = out_.newId();
        out_.emit(Op::OpCompositeExtract, {wordType_, half, pair, i});
        storeWord(store, chain, word++, half);
      }
      return;
    }
    Id bits = value;
    if (type.kind == Type::Kind::floating && type.width < 32) {
      const Id wide = out_.newId();
      out_.emit(Op::OpFConvert, {floatType_, wide, value});
      bits = out_.newId();
      out_.emit(Op::OpBitcast, {wordType_, bits, wide});
    } else if (type.kind == Type::Kind::integer && type.width < 32) {
      bits = out_.newId();
      out_.emit(type.isSigned ? Op::OpSConvert : Op::OpUConvert, {wordType_, bits, value});
    } else if (typeId != wordType_) {
      bits = out_.newId();
      if (type.kind == Type::Kind::boolean)
        out_.emit(Op::OpSelect, {wordType_, bits, value, constants_.at(1), constants_.at(0)});
      else
        out_.emit(Op::OpBitcast, {wordType_, bits, value});
    }
    storeWord(store, chain, word++, bits);
  }

  // Stores `bits` that many words behind the pointer of the marking store.
  void storeWord(const Instruction& store, const Instruction& chain, std::uint32_t word, Id bits) {
    Id pointer = store.at(0);
    if (word > 0) {
      const Id position = out_.newId();
      const Id first = chain.operands.back();
      const Instruction* definition = module_.definition(first);
      out_.emit(Op::OpIAdd, {definition ? definition->type : wordType_, position, first, constants_.at(word)});
      pointer = out_.newId();
      std::vector<std::uint32_t> operands{chain.type, pointer};
      operands.insert(operands.end(), chain.operands.begin(), chain.operands.end());
      operands.back() = position;
      out_.emit(chain.op, operands);
    }
    std::vector<std::uint32_t> operands{pointer, bits};
    operands.insert(operands.end(), store.operands.begin() + 2, store.operands.end());  // alignment
    out_.emit(Op::OpStore, operands);
  }

  const Module& module_;
  const DataMarkers& markers_;
  const std::uint32_t firstNumber_;
  ModuleWriter out_;
  std::map<std::size_t, Marker> stores_;  // by instruction
  std::vector<Call> calls_;
  std::vector<CallSite> sites_;
  std::map<std::uint32_t, Id> constants_;  // new ones, by value
  Id wordType_ = 0;                        // uint
  Id pairType_ = 0, newPairType_ = 0;      // uvec2; the second is 0 if the module has it
  Id floatType_ = 0, newFloatType_ = 0;    // float, as well
  std::uint32_t maxWords_ = 0;             // LoggedCalls::maxWords
};

}  // namespace

LoggedCalls logCallData(const std::vector<std::uint32_t>& words, const DataMarkers& markers,
                        std::uint32_t firstNumber) {
  std::string why;
  const std::optional<Module> module = Module::read(words, &why);
  if (!module) throw Error("logCallData: " + why);
  LoggedCalls result = DataLogger(*module, words, markers, firstNumber).run();
  if (result.spirv.empty()) result.spirv = words;
  return result;
}

}  // namespace quintet::spirv
