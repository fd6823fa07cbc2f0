// How a value changes when the direction of the ray is made s times as long: by which power of s. A position on the
// ray does not change (degree 0), the direction itself has degree 1, and a t that is measured in lengths of the
// direction has degree -1. So the degree tells a t from a distance.
#ifndef QUINTET_PROGRAM_RAY_DEGREE_H
#define QUINTET_PROGRAM_RAY_DEGREE_H

#include <functional>
#include <optional>
#include <unordered_map>
#include <vector>

#include "shader/spirv_module.h"

namespace quintet::program {

// The degrees that a value can have, one per path. Unknown: it is no power of s, or was not followed. Empty: a
// constant, which takes the degree of what it is added to.
struct RayDegree {
  bool unknown = false;
  std::vector<double> values;  // sorted

  bool constant() const { return !unknown && values.empty(); }
  bool is(double degree) const { return !unknown && values.size() == 1 && values.front() == degree; }
  bool may(double degree) const;  // known, and one of them
  bool operator==(const RayDegree&) const = default;
};

class RayDegrees {
 public:
  explicit RayDegrees(const shader::SpirvModule& module) : module_(module) {}
  RayDegree of(shader::SpirvId value);
  // The same if, of everything that one branch decides, only one side is taken: for a value that is computed in either
  // of two ways, whose degrees would otherwise mix. Calls `visit` for each side of each branch on the way; met() then
  // belongs to that side.
  void alternatives(shader::SpirvId value, const std::function<void(const RayDegree&)>& visit);
  // Of a value that the last of() has met on its way.
  RayDegree met(shader::SpirvId value) const { return get(value); }

 private:
  std::vector<std::size_t> slice(std::size_t start) const;
  RayDegree get(shader::SpirvId value) const;
  RayDegree evaluate(const shader::SpirvInstruction& instruction) const;
  RayDegree evaluateExtended(const shader::SpirvInstruction& instruction) const;
  RayDegree evaluateLoad(const shader::SpirvInstruction& instruction) const;
  std::vector<shader::SpirvId> sources(const shader::SpirvInstruction& instruction) const;

  // The operand of a phi or select that is taken for certain; empty: any.
  std::optional<shader::SpirvId> chosen(const shader::SpirvInstruction& instruction) const;

  const shader::SpirvModule& module_;
  // Of phis in this block (by its label), or of selects with this condition: the position of the operand.
  struct Choice {
    shader::SpirvId key = 0;
    std::size_t side = 0;
  } choice_;
  std::unordered_map<shader::SpirvId, RayDegree> degrees_;
};

}  // namespace quintet::program
#endif
