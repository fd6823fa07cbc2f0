// SPDX-License-Identifier: Apache-2.0
#include "spirv/control_flow.h"

#include <algorithm>
#include <unordered_set>

namespace quintet::spirv {
namespace {

constexpr std::size_t kNone = Module::kNone;

// Returns the reachable blocks in reverse post-order. Iterative, since control flow can be deeply nested.
std::vector<std::size_t> reversePostOrder(const std::vector<Block>& blocks) {
  std::vector<std::size_t> order;
  if (blocks.empty()) return order;
  std::vector<std::size_t> next(blocks.size(), 0), open{0};
  std::vector<bool> seen(blocks.size(), false);
  seen[0] = true;
  while (!open.empty()) {
    const std::size_t block = open.back();
    if (next[block] < blocks[block].successors.size()) {
      const std::size_t successor = blocks[block].successors[next[block]++];
      if (!seen[successor]) open.push_back(successor), seen[successor] = true;
    } else {
      order.push_back(block);
      open.pop_back();
    }
  }
  std::ranges::reverse(order);
  return order;
}

}  // namespace

// Computes dominators after Cooper, Harvey and Kennedy, "A Simple, Fast Dominance Algorithm" (2001), figure 3.
ControlFlow::ControlFlow(const Module& module, std::size_t function) : module_(&module), function_(function) {
  const auto& blocks = module.functions()[function].blocks;
  const std::vector<std::size_t> order = reversePostOrder(blocks);
  order_.assign(blocks.size(), kNone);
  dominator_.assign(blocks.size(), kNone);
  for (std::size_t i = 0; i < order.size(); ++i) order_[order[i]] = i;
  if (order.empty()) return;
  dominator_[order[0]] = order[0];
  const auto common = [&](std::size_t a, std::size_t b) {
    while (a != b) {
      while (order_[a] > order_[b]) a = dominator_[a];
      while (order_[b] > order_[a]) b = dominator_[b];
    }
    return a;
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 1; i < order.size(); ++i) {
      std::size_t found = kNone;
      for (const std::size_t p : blocks[order[i]].predecessors)
        if (dominator_[p] != kNone) found = found == kNone ? p : common(found, p);
      if (found != dominator_[order[i]]) dominator_[order[i]] = found, changed = true;
    }
  }
  dominator_[order[0]] = kNone;
}

bool ControlFlow::reachable(std::size_t block) const { return block < order_.size() && order_[block] != kNone; }

std::size_t ControlFlow::dominator(std::size_t block) const {
  return block < dominator_.size() ? dominator_[block] : kNone;
}

bool ControlFlow::dominates(std::size_t above, std::size_t block) const {
  for (; block != kNone; block = dominator(block))
    if (block == above) return true;
  return false;
}

bool ControlFlow::inLoop(std::size_t block) const {
  const auto& blocks = function().blocks;
  std::vector<bool> seen(blocks.size(), false);
  std::vector<std::size_t> open = blocks[block].successors;
  while (!open.empty()) {
    const std::size_t next = open.back();
    open.pop_back();
    if (next == block) return true;
    if (seen[next]) continue;
    seen[next] = true;
    open.insert(open.end(), blocks[next].successors.begin(), blocks[next].successors.end());
  }
  return false;
}

Id ControlFlow::condition(std::size_t block) const {
  const Instruction& end = module_->instructions()[function().blocks[block].end - 1];
  return end.op == spv::Op::OpBranchConditional || end.op == spv::Op::OpSwitch ? end.at(0) : 0;
}

std::vector<Id> ControlFlow::phiConditions(std::size_t block) const {
  const auto& blocks = function().blocks;
  const std::size_t top = dominator(block);
  std::vector<Id> conditions;
  std::vector<bool> seen(blocks.size(), false);
  std::vector<std::size_t> open = blocks[block].predecessors;
  while (!open.empty()) {
    const std::size_t next = open.back();
    open.pop_back();
    if (seen[next] || !reachable(next)) continue;
    seen[next] = true;
    if (const Id value = condition(next)) conditions.push_back(value);
    if (next == top || next == block) continue;
    open.insert(open.end(), blocks[next].predecessors.begin(), blocks[next].predecessors.end());
  }
  return conditions;
}

std::vector<std::size_t> ControlFlow::controllers(std::size_t block) const {
  const auto& blocks = function().blocks;
  std::vector<std::size_t> result, open{block};
  while (!open.empty()) {
    const std::size_t next = open.back();
    open.pop_back();
    // Blocks from which the function can end without `next`.
    std::vector<bool> avoids(blocks.size(), false);
    std::vector<std::size_t> ends;
    for (std::size_t b = 0; b < blocks.size(); ++b)
      if (blocks[b].successors.empty()) ends.push_back(b);
    while (!ends.empty()) {
      const std::size_t b = ends.back();
      ends.pop_back();
      if (b == next || avoids[b]) continue;
      avoids[b] = true;
      ends.insert(ends.end(), blocks[b].predecessors.begin(), blocks[b].predecessors.end());
    }
    const auto isAvoided = [&](std::size_t successor) { return avoids[successor]; };
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const auto& successors = blocks[b].successors;
      if (b == next || !reachable(b) || std::ranges::find(result, b) != result.end()) continue;
      if (std::ranges::all_of(successors, isAvoided) || std::ranges::none_of(successors, isAvoided)) continue;
      result.push_back(b);
      open.push_back(b);
    }
  }
  return result;
}

bool dependsOnDataOrControl(const Module& module, const ControlFlow& flow, Id value, const InstructionTest& test,
                            bool throughLoops) {
  std::vector<Id> open{value}, phis;
  std::unordered_set<Id> seen{value};
  Slices slices(module);
  const auto visit = [&](const Instruction& i) {
    if (i.op == spv::Op::OpPhi) phis.push_back(i.result);
    return test(i);
  };
  while (!open.empty()) {
    const Id next = open.back();
    open.pop_back();
    if (slices.find(next, visit)) return true;
    for (const Id phi : phis) {
      const auto position = module.position(module.definitionIndex(phi));
      if (!position || position->function != flow.functionIndex()) continue;
      const auto repeats = [&](std::size_t predecessor) { return flow.dominates(position->block, predecessor); };
      if (!throughLoops && std::ranges::any_of(flow.function().blocks[position->block].predecessors, repeats)) continue;
      for (const Id condition : flow.phiConditions(position->block))
        if (seen.insert(condition).second) open.push_back(condition);
    }
    phis.clear();
  }
  return false;
}

PathsAfter::PathsAfter(const Module& module, const ControlFlow& flow, std::size_t instruction,
                       const std::vector<std::size_t>& ends)
    : module_(&module), flow_(&flow), instruction_(instruction) {
  const auto position = module.position(instruction).value_or(Module::Position{});
  block_ = position.block;
  function_ = position.function;
  blockCount_ = flow.function().blocks.size();
  ends_.assign(blockCount_ + 1, false);
  for (const std::size_t end : ends)
    if (const std::size_t node = nodeOf(end); node != kNone) ends_[node] = true;
  after_ = from(blockCount_, kNone);
}

std::size_t PathsAfter::nodeOf(std::size_t instruction) const {
  const auto position = module_->position(instruction);
  if (!position || position->function != function_) return kNone;
  return position->block == block_ && instruction > instruction_ ? blockCount_ : position->block;
}

const std::vector<std::size_t>& PathsAfter::successors(std::size_t node) const {
  static const std::vector<std::size_t> kNoSuccessors;
  if (node == block_ || ends_[node]) return kNoSuccessors;  // the start runs again: end of the path
  return flow_->function().blocks[blockOf(node)].successors;
}

std::vector<bool> PathsAfter::from(std::size_t start, std::size_t without) const {
  std::vector<bool> seen(blockCount_ + 1, false);
  std::vector<std::size_t> open{start};
  while (!open.empty()) {
    const std::size_t node = open.back();
    open.pop_back();
    if (node == without || seen[node]) continue;
    seen[node] = true;
    for (const std::size_t next : successors(node)) open.push_back(next);
  }
  return seen;
}

bool PathsAfter::reaches(std::size_t i, const std::vector<std::size_t>& kills) const {
  const std::size_t goal = nodeOf(i);
  if (goal == kNone || !after_[goal]) return false;
  const auto [found, isNew] = unkilled_.try_emplace(kills);
  if (isNew) found->second = findUnkilled(kills);
  const Unkilled& nodes = found->second;
  return nodes.entered[goal] && i <= nodes.firstKill[goal];
}

PathsAfter::Unkilled PathsAfter::findUnkilled(const std::vector<std::size_t>& kills) const {
  Unkilled result{std::vector<bool>(blockCount_ + 1, false), std::vector<std::size_t>(blockCount_ + 1, kNone)};
  for (const std::size_t kill : kills)
    if (const std::size_t node = nodeOf(kill); node != kNone)
      result.firstKill[node] = std::min(result.firstKill[node], kill);
  std::vector<std::size_t> open{blockCount_};
  while (!open.empty()) {
    const std::size_t node = open.back();
    open.pop_back();
    if (result.entered[node]) continue;
    result.entered[node] = true;
    if (result.firstKill[node] != kNone) continue;
    for (const std::size_t next : successors(node)) open.push_back(next);
  }
  return result;
}

bool PathsAfter::leadsTo(std::size_t block, std::size_t instruction) const {
  const std::size_t goal = nodeOf(instruction);
  return goal != kNone && block < blockCount_ && from(block, kNone)[goal];
}

const std::vector<std::size_t>& PathsAfter::guards(std::size_t instruction) const {
  const std::size_t goal = nodeOf(instruction);
  const auto [found, isNew] = guards_.try_emplace(goal);
  if (isNew && goal != kNone) found->second = findGuards(goal);
  return found->second;
}

std::vector<std::size_t> PathsAfter::findGuards(std::size_t goal) const {
  std::vector<std::size_t> result;
  for (std::size_t node = 0; node <= blockCount_; ++node) {
    if (!after_[node] || node == goal || successors(node).size() < 2) continue;
    if (node != blockCount_) {
      const auto [around, isNew] = around_.try_emplace(node);
      if (isNew) around->second = from(blockCount_, node);
      if (around->second[goal]) continue;
    }
    const auto leads = [&](std::size_t next) { return next != node && from(next, node)[goal]; };
    if (!std::ranges::all_of(successors(node), leads)) result.push_back(blockOf(node));
  }
  return result;
}

}  // namespace quintet::spirv
