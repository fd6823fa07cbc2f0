// SPDX-License-Identifier: Apache-2.0
// Space tags across stages: payloads, hit attributes and callable data have in the reading stage the tags that the
// writing stages store. Also answers what a value is used for, in its stage and in stages that receive it.
#ifndef QUINTET_CHECK_FLOW_PIPELINE_SPACES_H
#define QUINTET_CHECK_FLOW_PIPELINE_SPACES_H

#include <memory>
#include <set>

#include "check/flow/space_tags.h"
#include "check/pipeline_graph.h"

namespace quintet::check {

// What a value is used for.
struct ValueUses {
  bool normalized = false;
  bool measured = false;  // its length
  bool dot = false;       // in a dot product with another value
  bool asNormal = false;  // surface normal of reflect, refract, faceforward, or of a cosine: max(dot(n, l), 0)
  bool traceDirection = false;
  bool traceOrigin = false;
  bool difference = false;  // operand of a difference that is used as a direction
  bool relative = false;    // operand of a difference of points that were transformed without translation
  bool crossed = false;     // operand of a cross product
  bool moves = false;       // added to a point
  bool shown = false;       // 0.5 + 0.5 * v
  bool pattern = false;     // coordinates of a pattern: fract(v), floor(v), mod(v, size), sin(v)
  bool translated = false;  // the translation of a matrix is added
  bool stored = false;      // somewhere where it cannot be followed
  bool normalizedDirectly = false;
  bool truncated = false;  // not all uses are known
};

class PipelineSpaces {
 public:
  explicit PipelineSpaces(const PipelineGraph& graph);
  explicit PipelineSpaces(const spirv::Module& module);  // one stage alone

  // Null if the stage cannot be analyzed.
  const SpaceTags* stage(std::size_t index) const { return stages_[index].get(); }
  // True if a stage transforms a value from object to world space or back, so the program distinguishes them.
  bool transforms() const;
  ValueUses uses(std::size_t stage, spirv::Id value) const;
  using Shared = std::pair<std::size_t, spirv::Id>;  // stage and variable
  // The variable and those of other stages that have its value: payloads, hit attributes, callable data.
  std::vector<Shared> linked(const Shared& shared) const;

 private:
  struct Open {
    std::size_t stage;
    spirv::Id id;
    spirv::Path inner;  // where the value is in `id`, if that is a structure
    bool scaled = false;
    bool direct = true;  // the value itself, up to scale
    int depth = 0;
  };
  struct Search;

  void link(const Shared& a, const Shared& b);
  void propagate();
  std::size_t find(std::size_t set);
  std::size_t setOf(const Shared& shared);
  void addBarycentrics(const PipelineGraph& graph, const program::HitShaders& shaders);
  void visit(const Open& open, std::size_t user, Search& search) const;
  void visitStore(const Open& open, const spirv::Instruction& store, Search& search) const;
  void visitExtended(const Open& open, const spirv::Instruction& i, Search& search) const;
  void visitDot(const Open& open, const spirv::Instruction& dot, Search& search) const;

  std::vector<std::unique_ptr<SpaceTags>> stages_;
  std::map<Shared, std::size_t> index_;  // into parent_
  std::vector<std::size_t> parent_;      // union-find of linked variables
  std::vector<Shared> shared_;
  std::vector<std::size_t> roots_;            // of shared_, once all are linked
  std::vector<std::vector<Shared>> members_;  // by root
};

}  // namespace quintet::check
#endif
