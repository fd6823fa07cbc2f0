// SPDX-License-Identifier: Apache-2.0
// A SPIR-V module for analysis: instructions with their source lines, functions with their basic blocks, types,
// constants, names, decorations and variables. The reader is our own, on top of spirv-headers. Any input is safe: a
// malformed module is rejected with a reason, and every accessor accepts any id.
//
// The analyses expect modules that shader::Compiler made with `optimize` and `debugInfo`: spirv-opt has then inlined
// the functions, built SSA form and folded constants, while OpLine, names and sources are still present.
#ifndef QUINTET_SPIRV_MODULE_H
#define QUINTET_SPIRV_MODULE_H

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <spirv/unified1/spirv.hpp11>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/diagnostic.h"
#include "spirv/type.h"

namespace quintet::spirv {

struct Instruction {
  spv::Op op = spv::Op::OpNop;
  Id type = 0;                              // result type; 0 if the instruction has none
  Id result = 0;                            // 0 if the instruction has none
  std::span<const std::uint32_t> operands;  // without result type and result
  Id file = 0;                              // OpString of the current OpLine; 0 if unknown
  std::uint32_t line = 0;
  std::uint32_t column = 0;  // always 0 in glslang's output

  std::uint32_t at(std::size_t i) const { return i < operands.size() ? operands[i] : 0; }  // 0 if missing
};

// A basic block. Instructions are indices into Module::instructions(), blocks are indices into Function::blocks.
struct Block {
  Id label = 0;
  std::size_t first = 0;  // the OpLabel
  std::size_t end = 0;    // one past the terminator
  std::vector<std::size_t> successors;
  std::vector<std::size_t> predecessors;
};

struct Function {
  Id id = 0;
  std::vector<Id> parameters;
  std::vector<Block> blocks;  // in module order: the entry block first, each block after its dominator
};

// A variable at module scope.
struct Variable {
  Id id = 0;
  spv::StorageClass storage = spv::StorageClass::Max;
  Id type = 0;  // the type that it points to
  std::string name;
  std::optional<spv::BuiltIn> builtIn;
};

// A pointer resolved through access chains and copies. The index of OpPtrAccessChain into the array around the base is
// left out.
struct Access {
  Id base = 0;      // where the chains start: a variable, a function parameter, or the pointer of a buffer reference
  Id variable = 0;  // the base if it is a variable or a function parameter, otherwise 0
  Id type = 0;      // of what the base points to
  std::vector<std::optional<std::uint32_t>> indices;  // from the outermost type inwards; nullopt for dynamic indices
  std::vector<Id> indexIds;
};

// An entry point of a module. Libraries of HLSL and Slang have several.
struct EntryPoint {
  spv::ExecutionModel stage = spv::ExecutionModel::Max;
  std::string name;
};

// Separates the file and the id in SourceLocation::file.
inline constexpr char kIdMark = '\x1f';
// True if Module::location() names an instruction without a known line by its SPIR-V id.
bool isIdLocation(const SourceLocation& location);
// Returns the name of the module and "SPIR-V id %57 'payload'"; the file of any other location and an empty text.
std::pair<std::string, std::string> splitIdLocation(const std::string& file);

bool isAccessChain(spv::Op op);  // OpAccessChain, OpPtrAccessChain and their InBounds forms

class Module {
 public:
  // Returns nullopt if the words cannot be analyzed, with the reason in `why` (which can be null).
  static std::optional<Module> read(std::vector<std::uint32_t> words, std::string* why = nullptr);
  Module(Module&&) noexcept = default;
  Module& operator=(Module&&) noexcept = default;

  std::optional<spv::ExecutionModel> stage() const { return stage_; }  // of the first entry point
  const std::vector<EntryPoint>& entryPoints() const { return entryPoints_; }
  const Function* entry() const;  // null if the module has no entry point
  const std::vector<Instruction>& instructions() const { return instructions_; }
  const std::vector<Function>& functions() const { return functions_; }
  const Function* function(Id id) const;          // null if unknown
  Id functionNamed(std::string_view name) const;  // by its name in GLSL, with OpName; 0 if unknown

  const Instruction* definition(Id id) const;          // the instruction with this result; null if unknown
  std::size_t definitionIndex(Id id) const;            // its index; kNone if unknown
  const std::vector<std::size_t>& users(Id id) const;  // instructions inside functions that use the value
  struct Position {
    std::size_t function = 0, block = 0;
  };
  // Returns the function and block of an instruction; nullopt outside of functions.
  std::optional<Position> position(std::size_t instruction) const;
  static constexpr std::size_t kNone = ~std::size_t{0};

  const Types& types() const { return types_; }
  std::string name(Id id) const;           // OpName; empty if unknown
  const std::string* string(Id id) const;  // OpString; null if unknown
  // Returns the first operand of a decoration, or 0 if it has none; nullopt if the id is not decorated with it.
  std::optional<std::uint32_t> decoration(Id id, spv::Decoration decoration) const;
  const std::vector<Variable>& variables() const { return variables_; }
  const Variable* variable(Id id) const;      // null if unknown
  std::string_view extendedSet(Id id) const;  // name in OpExtInstImport, e.g. "GLSL.std.450"

  // Value of a scalar constant: integers and booleans of up to 32 bits as bits, floats as numbers.
  std::optional<std::uint32_t> constantBits(Id id) const;
  std::optional<double> constantFloat(Id id) const;
  bool isConstant(Id id) const;  // OpConstant…, including composites, and OpUndef
  // Returns an Access without base if the pointer is malformed.
  Access access(Id pointer) const;

  // Source location of an instruction. `token` is the text to look for in that line; it gives the column, which
  // glslang does not write. glslang names the line where a call ends, so the lines before it are searched as well.
  SourceLocation location(const Instruction& instruction, std::string_view token = {}) const;
  // Where a variable at module scope or a function is declared, from OpLine or NonSemantic.Shader.DebugInfo.100.
  SourceLocation declaration(Id id) const;
  // From now on, location() and declaration() name what has no known line by `file` and its SPIR-V id. For modules whose
  // source is unknown.
  void locateByIds(const std::string& file) { file_ = file; }
  // Text of a source file as the compiler got it; empty if unknown.
  std::string_view source(const std::string& file) const;
  const std::map<std::string, std::string>& sources() const { return sources_; }
  // Adds the text of a file that the module only names (#line "name"). Existing texts are kept.
  void addSource(const std::string& file, const std::string& text) { addedSources_.emplace(file, text); }

 private:
  Module() = default;
  friend class ModuleReader;

  std::vector<std::uint32_t> words_;
  std::vector<Instruction> instructions_;
  std::vector<Function> functions_;
  std::vector<std::size_t> definitions_;         // by id
  std::vector<std::vector<std::size_t>> users_;  // by id
  std::vector<Position> positions_;              // by instruction - firstInFunctions_
  std::size_t firstInFunctions_ = 0;
  std::optional<spv::ExecutionModel> stage_;
  Id entry_ = 0;
  Types types_;
  std::map<Id, std::string> names_;
  std::map<Id, std::string> strings_;
  std::map<Id, std::string> extendedSets_;
  std::map<std::pair<Id, std::uint32_t>, std::uint32_t> decorations_;
  std::vector<Variable> variables_;
  std::map<std::string, std::string> sources_;       // from the module itself
  std::map<std::string, std::string> addedSources_;  // from addSource()
  std::vector<EntryPoint> entryPoints_;
  std::map<Id, SourceLocation> declarations_;
  std::string file_;  // of locateByIds(); empty if it was not called

  SourceLocation idLocation(Id id) const;
  SourceLocation idLocation(const Instruction& instruction) const;
};

// Returns the GLSL name of a ray tracing built-in: "gl_PrimitiveID", "gl_RayTmaxEXT" (also for gl_HitTEXT).
std::string_view glslName(spv::BuiltIn builtIn);

// Returns the operands of an instruction that are ids of values (neither types nor literals), in order. Constants have
// none, except those that other constants make up.
std::vector<Id> valueOperands(const Instruction& instruction);

// Returns a copy without sources, lines, names and non-semantic instructions (debugPrintfEXT): the module that the driver
// gets.
std::vector<std::uint32_t> withoutDebugInfo(std::span<const std::uint32_t> words);

// Returns a copy without sources and lines, and with names only of types, their members and global variables: what checks between
// stages print.
std::vector<std::uint32_t> withInterfaceNames(std::span<const std::uint32_t> words);

// Returns a copy with one of the entry points. What only the others use stays, unreachable. Words that cannot be read as
// instructions are copied.
std::vector<std::uint32_t> withEntryPoint(std::span<const std::uint32_t> words, const EntryPoint& entryPoint);

}  // namespace quintet::spirv
#endif
