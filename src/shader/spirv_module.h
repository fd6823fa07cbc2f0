// A SPIR-V module, read for analysis: instructions with their lines, functions with their control flow, types,
// constants, names, decorations and variables. Own reader on spirv-headers. Any words are safe to read: a module
// that is broken is refused with a reason, and every accessor takes any id.
//
// Made for modules of shader::Compiler with `optimize` and `debugInfo`: spirv-opt then has inlined every function,
// made SSA form and folded constants, and OpLine, names and the sources are still there.
#ifndef QUINTET_SHADER_SPIRV_MODULE_H
#define QUINTET_SHADER_SPIRV_MODULE_H

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <spirv/unified1/spirv.hpp11>
#include <string>
#include <string_view>
#include <vector>

#include "shader/spirv_type.h"

namespace quintet::shader {

// A place in a source file as the user knows it. 0: unknown.
struct Place {
  std::string file;
  int line = 0;
  int column = 0;
};

struct SpirvInstruction {
  spv::Op op = spv::Op::OpNop;
  SpirvId type = 0;                         // result type; 0: none
  SpirvId result = 0;                       // 0: none
  std::span<const std::uint32_t> operands;  // without type and result
  SpirvId file = 0;                         // OpString of the OpLine before it; 0: unknown
  std::uint32_t line = 0;
  std::uint32_t column = 0;  // glslang gives none: 0

  std::uint32_t at(std::size_t i) const { return i < operands.size() ? operands[i] : 0; }  // 0: not there
};

// Indices are into SpirvModule::instructions(); block indices into SpirvFunction::blocks.
struct SpirvBlock {
  SpirvId label = 0;
  std::size_t first = 0;  // the OpLabel
  std::size_t end = 0;    // one past the terminator
  std::vector<std::size_t> successors;
  std::vector<std::size_t> predecessors;
};

struct SpirvFunction {
  SpirvId id = 0;
  std::vector<SpirvId> parameters;
  std::vector<SpirvBlock> blocks;  // in the module's order: the entry first, a block after its dominator
};

// A module-scope variable.
struct SpirvVariable {
  SpirvId id = 0;
  spv::StorageClass storage = spv::StorageClass::Max;
  SpirvId type = 0;  // what it points to
  std::string name;
  std::optional<spv::BuiltIn> builtIn;
};

// An access chain followed to its variable.
struct SpirvAccess {
  SpirvId variable = 0;                               // OpVariable or a function parameter; 0: some other pointer
  std::vector<std::optional<std::uint32_t>> indices;  // from the variable's type inwards; empty value: dynamic
};

class SpirvModule {
 public:
  // Empty if the words are no module that can be analysed; `why` then says so (may be null).
  static std::optional<SpirvModule> read(std::vector<std::uint32_t> words, std::string* why = nullptr);
  SpirvModule(SpirvModule&&) noexcept = default;
  SpirvModule& operator=(SpirvModule&&) noexcept = default;

  std::optional<spv::ExecutionModel> stage() const { return stage_; }  // of the first entry point
  const SpirvFunction* entry() const;                                  // null: none
  const std::vector<SpirvInstruction>& instructions() const { return instructions_; }
  const std::vector<SpirvFunction>& functions() const { return functions_; }
  const SpirvFunction* function(SpirvId id) const;

  const SpirvInstruction* definition(SpirvId id) const;     // null: no such result
  std::size_t definitionIndex(SpirvId id) const;            // kNone: no such result
  const std::vector<std::size_t>& users(SpirvId id) const;  // instructions of functions that use the value
  // Block of an instruction in its function: {function, block}; empty outside of functions.
  struct Position {
    std::size_t function = 0, block = 0;
  };
  std::optional<Position> position(std::size_t instruction) const;
  static constexpr std::size_t kNone = ~std::size_t{0};

  const SpirvTypes& types() const { return types_; }
  std::string name(SpirvId id) const;                                                     // OpName; may be empty
  std::optional<std::uint32_t> decoration(SpirvId id, spv::Decoration decoration) const;  // its first operand, or 0
  const std::vector<SpirvVariable>& variables() const { return variables_; }
  const SpirvVariable* variable(SpirvId id) const;
  std::string_view extendedSet(SpirvId id) const;  // of OpExtInstImport: "GLSL.std.450"

  // Value of a scalar constant: integers and booleans of at most 32 bits as their bits; floats as numbers.
  std::optional<std::uint32_t> constantBits(SpirvId id) const;
  std::optional<double> constantFloat(SpirvId id) const;
  bool isConstant(SpirvId id) const;  // OpConstant…, also composites
  // Every value that an id can have, if all of them are constants: through OpPhi and OpSelect, 16 at most.
  std::optional<std::vector<std::uint32_t>> possibleValues(SpirvId id) const;

  // The variable that a pointer leads into.
  SpirvAccess access(SpirvId pointer) const;

  // Where an instruction comes from. `token`: what to look for in that line, or, as glslang names the line in which a
  // call ends, in the lines before it; gives the column (glslang's own is 0).
  Place place(const SpirvInstruction& instruction, std::string_view token = {}) const;
  // Text of a file that the module was made from, as given to the compiler; empty: not there.
  std::string_view source(const std::string& file) const;
  const std::map<std::string, std::string>& sources() const { return sources_; }
  // The text of a file that the module knows by name only (from #line "name"); kept if there is none yet.
  void addSource(const std::string& file, const std::string& text) { otherSources_.emplace(file, text); }

 private:
  SpirvModule() = default;
  friend class SpirvReader;

  std::vector<std::uint32_t> words_;
  std::vector<SpirvInstruction> instructions_;
  std::vector<SpirvFunction> functions_;
  std::vector<std::size_t> definitions_;         // by id
  std::vector<std::vector<std::size_t>> users_;  // by id
  std::vector<Position> positions_;              // by instruction - firstInFunctions_
  std::size_t firstInFunctions_ = 0;
  std::optional<spv::ExecutionModel> stage_;
  SpirvId entry_ = 0;
  SpirvTypes types_;
  std::map<SpirvId, std::string> names_;
  std::map<SpirvId, std::string> strings_;
  std::map<SpirvId, std::string> extendedSets_;
  std::map<std::pair<SpirvId, std::uint32_t>, std::uint32_t> decorations_;
  std::vector<SpirvVariable> variables_;
  std::map<std::string, std::string> sources_;
  std::map<std::string, std::string> otherSources_;  // that the module does not have itself
};

// The operands of an instruction that are ids of values (not of types, not literals), in their order.
std::vector<SpirvId> valueOperands(const SpirvInstruction& instruction);

// A copy without what only people read: sources, lines, names. What a driver gets.
std::vector<std::uint32_t> withoutDebugInfo(std::span<const std::uint32_t> words);

}  // namespace quintet::shader
#endif
