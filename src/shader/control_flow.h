// Control flow of one function of a module: dominators, what decides a phi, and the paths that begin at an
// instruction (a trace).
#ifndef QUINTET_SHADER_CONTROL_FLOW_H
#define QUINTET_SHADER_CONTROL_FLOW_H

#include "shader/spirv_flow.h"

namespace quintet::shader {

class ControlFlow {
 public:
  ControlFlow(const SpirvModule& module, std::size_t function);

  const SpirvFunction& function() const { return module_->functions()[function_]; }
  std::size_t functionIndex() const { return function_; }
  bool reachable(std::size_t block) const;
  std::size_t dominator(std::size_t block) const;  // the immediate one; kNone for the entry and what is unreachable
  bool dominates(std::size_t above, std::size_t block) const;  // also itself
  bool inLoop(std::size_t block) const;

  // Conditions of the branches between a phi's block and its dominator: they decide which value the phi takes.
  std::vector<SpirvId> phiConditions(std::size_t block) const;
  // The condition or selector of a block's branch; 0: it has none.
  SpirvId condition(std::size_t block) const;

 private:
  const SpirvModule* module_;
  std::size_t function_;
  std::vector<std::size_t> order_;  // position in reverse post-order; kNone: unreachable
  std::vector<std::size_t> dominator_;
};

// dependsOn (spirv_flow.h), and also through the conditions that choose between the values of a phi of this function:
// in `t = -1; if (hit) t = x;` t depends on `hit`.
bool dependsWithChoices(const SpirvModule& module, const ControlFlow& flow, SpirvId value, const InstructionTest& test);

// The blocks that can run after an instruction (a trace) and before that instruction runs again.
class PathsAfter {
 public:
  PathsAfter(const SpirvModule& module, const ControlFlow& flow, std::size_t instruction);

  // Can instruction `i` run after the trace, on a path where no instruction with `kills` lies before it? The trace
  // itself ends every path.
  bool reaches(std::size_t i, const std::vector<std::size_t>& kills) const;
  // Branches that lie on every path from the trace to block `block` and can lead elsewhere.
  const std::vector<std::size_t>& guards(std::size_t instruction) const;

 private:
  std::size_t nodeOf(std::size_t instruction) const;  // block index; the part after the trace is node blockCount
  const std::vector<std::size_t>& successors(std::size_t node) const;
  std::vector<std::size_t> findGuards(std::size_t goal) const;
  std::vector<bool> from(std::size_t node, std::size_t without) const;
  std::size_t blockOf(std::size_t node) const { return node == blockCount_ ? block_ : node; }

  const SpirvModule* module_;
  const ControlFlow* flow_;
  std::size_t instruction_, block_ = 0, function_ = 0, blockCount_ = 0;
  std::vector<bool> after_;                                         // nodes that can run after the trace
  mutable std::map<std::size_t, std::vector<std::size_t>> guards_;  // by node, found on demand
  mutable std::map<std::size_t, std::vector<bool>> around_;         // what the trace reaches without a node
};

}  // namespace quintet::shader
#endif
