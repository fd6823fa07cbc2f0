// SPDX-License-Identifier: Apache-2.0
// Control flow of one function: dominators, the conditions that decide a phi, and the paths that start at an
// instruction such as a trace.
#ifndef QUINTET_SPIRV_CONTROL_FLOW_H
#define QUINTET_SPIRV_CONTROL_FLOW_H

#include "spirv/value_flow.h"

namespace quintet::spirv {

class ControlFlow {
 public:
  ControlFlow(const Module& module, std::size_t function);

  const Function& function() const { return module_->functions()[function_]; }
  std::size_t functionIndex() const { return function_; }
  bool reachable(std::size_t block) const;
  std::size_t dominator(std::size_t block) const;  // immediate; Module::kNone for the entry and unreachable blocks
  bool dominates(std::size_t above, std::size_t block) const;  // a block dominates itself
  bool inLoop(std::size_t block) const;

  // Conditions of the branches between a phi's block and its dominator. They decide which value the phi takes.
  std::vector<Id> phiConditions(std::size_t block) const;
  // Blocks whose branches decide whether the block runs, directly or by deciding whether such a branch runs.
  std::vector<std::size_t> controllers(std::size_t block) const;
  // Condition or selector of a block's branch; 0 if it has none.
  Id condition(std::size_t block) const;

 private:
  const Module* module_;
  std::size_t function_;
  std::vector<std::size_t> order_;  // position in reverse post-order; kNone if unreachable
  std::vector<std::size_t> dominator_;
};

// As dependsOn (value_flow.h), including control dependence: a phi of this function also depends on the conditions that
// choose between its values. In `t = -1; if (hit) t = x;` t depends on `hit`. Without `throughLoops`, the phis at the start
// of a loop do not depend on the conditions in the loop, such as that of a break.
bool dependsOnDataOrControl(const Module& module, const ControlFlow& flow, Id value, const InstructionTest& test,
                            bool throughLoops = true);

// The paths that start after an instruction, such as a trace, and end before it runs again, or in a block with one of the
// instructions `ends`.
class PathsAfter {
 public:
  PathsAfter(const Module& module, const ControlFlow& flow, std::size_t instruction,
             const std::vector<std::size_t>& ends = {});

  // True if instruction `i` can run after the start on a path with none of the instructions `kills` before it.
  bool reaches(std::size_t i, const std::vector<std::size_t>& kills) const;
  // True if a path can lead from the start of the block to the instruction.
  bool leadsTo(std::size_t block, std::size_t instruction) const;
  // Blocks whose branch is on every path from the start to the instruction and can also lead elsewhere.
  const std::vector<std::size_t>& guards(std::size_t instruction) const;

 private:
  std::size_t nodeOf(
      std::size_t instruction) const;  // block index; blockCount_ is the part of the start block after the start
  const std::vector<std::size_t>& successors(std::size_t node) const;
  std::vector<std::size_t> findGuards(std::size_t goal) const;
  // What paths reach before one of a set of instructions, by node.
  struct Unkilled {
    std::vector<bool> entered;
    std::vector<std::size_t> firstKill;
  };
  Unkilled findUnkilled(const std::vector<std::size_t>& kills) const;
  std::vector<bool> from(std::size_t node, std::size_t without) const;
  std::size_t blockOf(std::size_t node) const { return node == blockCount_ ? block_ : node; }

  const Module* module_;
  const ControlFlow* flow_;
  std::size_t instruction_, block_ = 0, function_ = 0, blockCount_ = 0;  // of the start
  std::vector<bool> ends_;                                               // nodes with an end
  std::vector<bool> after_;                                              // nodes that can run after the start
  mutable std::map<std::size_t, std::vector<std::size_t>> guards_;       // cache, by node
  mutable std::map<std::vector<std::size_t>, Unkilled> unkilled_;        // cache, by instructions
  mutable std::map<std::size_t, std::vector<bool>> around_;              // cache, by node: nodes reached without it
};

}  // namespace quintet::spirv
#endif
