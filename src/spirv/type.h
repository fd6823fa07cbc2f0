// SPDX-License-Identifier: Apache-2.0
// Types of a SPIR-V module: sizes, GLSL names, and a member-by-member comparison across modules.
#ifndef QUINTET_SPIRV_TYPE_H
#define QUINTET_SPIRV_TYPE_H

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace quintet::spirv {

using Id = std::uint32_t;
// Literal indices into a composite, from the outermost type inwards. Empty for the whole value.
using Path = std::vector<std::uint32_t>;

struct Type {
  enum class Kind {
    none,
    voidType,
    boolean,
    integer,
    floating,
    vector,
    matrix,
    array,
    runtimeArray,
    structure,
    pointer,
    accelerationStructure,
    other
  };
  Kind kind = Kind::none;   // none if the id is not a type
  std::uint32_t width = 0;  // bits of a number
  bool isSigned = false;
  std::uint32_t count = 0;    // number of components, columns or elements; 0 if a specialization constant decides it
  Id element = 0;             // type of a component, column, element, or of what a pointer points to
  std::uint32_t storage = 0;  // of a pointer
  std::string name;           // of a structure
  std::vector<Id> members;
  std::vector<std::string> memberNames;
  std::uint64_t bytes = 0;  // in scalar layout (each scalar has its own size, bool has 4); 0 if unknown

  // Members of a structure, or elements of any other composite.
  std::size_t partCount() const { return kind == Kind::structure ? members.size() : count; }
  // Type of a part; 0 if there is none.
  Id part(std::uint32_t index) const {
    if (kind != Kind::structure) return element;
    return index < members.size() ? members[index] : 0;
  }
};

class Types {
 public:
  const Type& get(Id id) const;            // kind `none` if the id is not a type
  Id part(Id id, const Path& path) const;  // type of a part; 0 if there is none
  // GLSL name: "vec3", "uint", "mat4x3", "float[3]"; the name of a structure, or "struct" if it has none.
  std::string nameOf(Id id) const;
  // As nameOf, but a structure with its members: "struct Hit { vec3 color; bool hit; }".
  std::string describe(Id id) const;
  // Equal for two types that differenceOf() cannot tell apart, whatever type they are compared with. Empty if the type is too
  // large, or nested too deeply.
  std::string signature(Id id) const;
  // "member 2 'color'" for a structure, "value" for any other type.
  std::string memberName(Id id, std::uint32_t member) const;

  void add(Id id, Type type);  // after its parts; the size of a missing part counts as unknown
  void setName(Id id, std::string name);
  void setMemberName(Id id, std::uint32_t member, std::string name);

 private:
  void addSignature(Id id, int depth, std::string& text) const;

  std::unordered_map<Id, Type> types_;
};

// Describes how two types differ: "member 2 'color': vec3 vs vec4", "4 members vs 3", "vec3 vs vec4", "same members
// in a different order: member 0 is 'a' vs 'b'". Returns nullopt if they agree. Names only matter for the order of
// members.
std::optional<std::string> differenceOf(const Types& aTypes, Id a, const Types& bTypes, Id b);

}  // namespace quintet::spirv
#endif
