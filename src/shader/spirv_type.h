// Types of a SPIR-V module: sizes, names as in GLSL, and a comparison across modules, member by member.
#ifndef QUINTET_SHADER_SPIRV_TYPE_H
#define QUINTET_SHADER_SPIRV_TYPE_H

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace quintet::shader {

using SpirvId = std::uint32_t;

struct SpirvType {
  enum class Kind {
    none,
    nothing,
    boolean,
    integer,
    real,
    vector,
    matrix,
    array,
    runtimeArray,
    structure,
    pointer,
    accelerationStructure,
    other
  };
  Kind kind = Kind::none;   // none: the id is no type
  std::uint32_t width = 0;  // bits of a number
  bool isSigned = false;
  std::uint32_t count = 0;    // components, columns, elements
  SpirvId element = 0;        // of vector, matrix (column type), array, pointer
  std::uint32_t storage = 0;  // of a pointer
  std::string name;           // of a structure
  std::vector<SpirvId> members;
  std::vector<std::string> memberNames;
  std::uint64_t bytes = 0;  // scalar layout (each scalar at its own size, bool 4); 0: unknown
};

class SpirvTypes {
 public:
  const SpirvType& get(SpirvId id) const;  // kind `none` for any other id
  // "vec3", "uint", "mat4x3", "float[3]"; a structure by its name, "Hit". An unnamed one: "struct".
  std::string nameOf(SpirvId id) const;
  // The same with a structure's members: "struct Hit { vec3 color; bool hit; }".
  std::string describe(SpirvId id) const;
  // "member 2 'color'" of a structure; "value" of any other type.
  std::string memberName(SpirvId id, std::uint32_t member) const;

  void add(SpirvId id, SpirvType type);  // its parts must be there (else their sizes count as unknown)
  void setName(SpirvId id, std::string name);
  void setMemberName(SpirvId id, std::uint32_t member, std::string name);

 private:
  std::unordered_map<SpirvId, SpirvType> types_;
};

// What makes two types differ, in words: "member 2 'color': vec3 against vec4", "4 members against 3",
// "vec3 against vec4", "the same members in another order: member 0 is 'a' against 'b'". Empty: they agree (names
// do not count, except for that last case). The first type is `a`.
std::optional<std::string> differenceOf(const SpirvTypes& aTypes, SpirvId a, const SpirvTypes& bTypes, SpirvId b);

}  // namespace quintet::shader
#endif
