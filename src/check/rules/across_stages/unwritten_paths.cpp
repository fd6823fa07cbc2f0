// SPDX-License-Identifier: Apache-2.0
#include "check/rules/across_stages/unwritten_paths.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "spirv/trace_instruction.h"

namespace quintet::check {
namespace {

using spirv::Id;
using spv::Op;
using Blocks = std::set<std::size_t>;

constexpr spirv::Id kMemory = 0;         // stands for all buffers and images among the sources of a value
constexpr std::size_t kMaxSamples = 64;  // combinations of values with which a condition is evaluated

// The last store to a leaf on a path through the shader.
struct StoredValue {
  std::size_t instruction = 0;
  spirv::ValuePart value;
};

// The paths through a shader that do not write the leaf.
struct UnwrittenPath {
  std::map<std::uint32_t, StoredValue> stores;  // to other leaves, as far as known
  Blocks branches;                              // that decide whether the shader takes it
};

class UnwrittenPaths {
 public:
  UnwrittenPaths(const PayloadEnd& tracer, std::size_t trace, const PayloadEnd& shader, std::uint32_t leaf)
      : tracer_(tracer.facts),
        sent_(tracer.variable),
        trace_(trace),
        shader_(shader.facts),
        received_(shader.variable),
        leaf_(leaf) {}

  std::vector<std::size_t> reads() {
    const spirv::Function* entry = shader_.module().entry();
    if (!entry || entry->blocks.empty() || shader_.writesAlways(received_, leaf_)) return {};
    start_ = entry->blocks[0].first;
    function_ = shader_.module().position(start_)->function;
    writers_ = shader_.writers(received_, leaf_);
    UnwrittenPath path;
    if (!addControllers(writers_, path.branches) || !independent(path.branches)) return {};
    findStores();
    for (const auto& [leaf, stores] : stores_)
      if (stores.size() == 1 && shader_.writers(received_, leaf).size() == 1 && runsAlways(stores[0].instruction))
        path.stores[leaf] = stores[0];
    std::vector<std::size_t> found = readsOn(path);
    for (const auto& [leaf, stores] : stores_)
      for (const StoredValue& store : stores)
        if (found.empty() && !path.stores.contains(leaf))
          if (const auto other = through(path, leaf, store)) found = readsOn(*other);
    return found;
  }

 private:
  const spirv::ControlFlow& flow() const { return shader_.flow(function_); }

  // Adds the branches that decide whether the instructions run. Returns false if one is in another function.
  bool addControllers(const std::vector<std::size_t>& instructions, Blocks& branches) const {
    for (const std::size_t i : instructions) {
      const auto position = shader_.module().position(i);
      if (!position || position->function != function_) return false;
      const std::vector<std::size_t> all = flow().controllers(position->block);
      branches.insert(all.begin(), all.end());
    }
    return true;
  }

  bool runsAlways(std::size_t instruction) const {
    Blocks branches;
    return addControllers({instruction}, branches) && branches.empty();
  }

  void findStores() {
    for (const spirv::AccessFacts& access : shader_.accesses()) {
      if (!access.writes || access.variable != received_) continue;
      for (std::uint32_t leaf = access.leaves.first; leaf < access.leaves.last; ++leaf)
        if (const spirv::ValuePart value = shader_.storedValue(access, leaf); leaf != leaf_ && value.id != 0)
          stores_[leaf].push_back({access.instruction, value});
    }
  }

  // Returns the paths among `path` on which the store is the last one to its leaf; nullopt if there may be none.
  std::optional<UnwrittenPath> through(const UnwrittenPath& path, std::uint32_t leaf, const StoredValue& store) const {
    std::vector<std::size_t> others = shader_.writers(received_, leaf);
    std::erase(others, store.instruction);
    std::vector<std::size_t> kills = others;
    kills.insert(kills.end(), writers_.begin(), writers_.end());
    const spirv::Module& module = shader_.module();
    const auto endsAt = [&](const spirv::Block& block) {
      return module.instructions()[block.end - 1].op == Op::OpReturn &&
             shader_.pathsAfter(store.instruction).reaches(block.end - 1, kills);
    };
    if (!shader_.pathsAfter(start_).reaches(store.instruction, writers_) ||
        std::ranges::none_of(flow().function().blocks, endsAt))
      return {};
    UnwrittenPath result = path;
    result.stores[leaf] = store;
    others.push_back(store.instruction);
    if (!addControllers(others, result.branches) || !independent(result.branches)) return {};
    return result;
  }

  // What the value is computed from: shared variables, and kMemory.
  std::set<Id> sourcesOf(Id value) const {
    const spirv::Module& module = shader_.module();
    std::set<Id> sources;
    (void)spirv::dependsOnDataOrControl(module, flow(), value, [&](const spirv::Instruction& i) {
      if (i.op == Op::OpFunctionCall || i.op == Op::OpImageRead) sources.insert(kMemory);
      if (i.op != Op::OpLoad) return false;
      const Id base = module.access(i.at(0)).variable;
      const spirv::Variable* variable = module.variable(base);
      if (variable && (variable->builtIn || shader_.variable(base)))
        sources.insert(base);
      else if (!spirv::isLocal(module, base))
        sources.insert(kMemory);
      return false;
    });
    return sources;
  }

  // True if the branches do not depend on the same sources, so that each can go either way whatever the others do.
  bool independent(const Blocks& branches) const {
    std::set<Id> all;
    for (const std::size_t block : branches)
      for (const Id source : sourcesOf(flow().condition(block)))
        if (!all.insert(source).second) return false;
    return true;
  }

  std::vector<std::size_t> readsOn(const UnwrittenPath& path) const {
    return tracer_.unguardedReads(trace_, sent_, leaf_,
                                  [&](const spirv::Guard& guard) { return !holdsOn(path, guard); });
  }

  // True if the condition holds on some of the paths.
  bool holdsOn(const UnwrittenPath& path, const spirv::Guard& guard) const {
    if (!guard.holds) return false;
    const auto [known, isNew] = leavesOf_.try_emplace(guard.condition);
    if (isNew) known->second = leavesOf(guard.condition);
    const std::optional<std::set<std::uint32_t>>& leaves = known->second;
    if (!leaves || (leaves->empty() && !asksForHit(guard.condition))) return false;
    std::vector<std::pair<std::uint32_t, std::vector<double>>> samples;
    std::size_t count = 1;
    for (const std::uint32_t leaf : *leaves) {
      const auto store = path.stores.find(leaf);
      if (store == path.stores.end()) return false;
      samples.emplace_back(leaf, samplesOf(store->second));
      count *= samples.back().second.size();
    }
    bool holds = false, fails = false, unknown = count > kMaxSamples;
    for (std::size_t k = 0; k < count && !unknown; ++k) {
      std::map<std::uint32_t, double> values;
      std::size_t rest = k;
      for (const auto& [leaf, all] : samples) values[leaf] = all[rest % all.size()], rest /= all.size();
      const std::optional<double> outcome = evaluated(guard.condition, values);
      unknown = !outcome;
      if (outcome) ((*outcome != 0.0) == *guard.holds ? holds : fails) = true;
    }
    if (!unknown && holds != fails) return holds;
    // It can hold if what decides it is not what decides that the leaf is not written.
    return !writers_.empty() && canVary(path, *leaves);
  }

  // True if the stored values are not all constant, and do not depend on what the branches depend on.
  bool canVary(const UnwrittenPath& path, const std::set<std::uint32_t>& leaves) const {
    std::set<Id> ofBranches;
    for (const std::size_t block : path.branches) ofBranches.merge(sourcesOf(flow().condition(block)));
    bool constant = true;
    for (const std::uint32_t leaf : leaves) {
      const Id value = path.stores.at(leaf).value.id;
      constant = constant && shader_.module().isConstant(value);
      for (const Id source : sourcesOf(value))
        if (ofBranches.contains(source)) return false;
    }
    return !constant;
  }

  // The result of a query of the hit object that is executed, if the shader runs; nullopt for any other instruction.
  std::optional<double> answer(const spirv::Instruction& query) const {
    const spirv::Module& module = tracer_.module();
    const spirv::Instruction& execution = module.instructions()[trace_];
    if (execution.op != Op::OpHitObjectExecuteShaderNV) return {};
    const bool isMiss = shader_.module().stage() == spv::ExecutionModel::MissKHR;
    double result = 0.0;
    switch (query.op) {
      case Op::OpHitObjectIsHitNV: result = isMiss ? 0.0 : 1.0; break;
      case Op::OpHitObjectIsMissNV: result = isMiss ? 1.0 : 0.0; break;
      case Op::OpHitObjectIsEmptyNV: break;
      default: return {};
    }
    // The object must have the same content in both.
    const Id object = execution.at(0);
    const spirv::Instruction* variable = module.definition(object);
    if (!variable || variable->op != Op::OpVariable || query.at(0) != object) return {};
    std::vector<std::size_t> fillings;
    for (const std::size_t user : module.users(object)) {
      const spirv::Instruction& use = module.instructions()[user];
      if (!spirv::queriesHitObject(module, use) && use.op != Op::OpHitObjectExecuteShaderNV &&
          use.op != Op::OpReorderThreadWithHitObjectNV && use.op != Op::OpHitObjectGetAttributesNV)
        fillings.push_back(user);
    }
    const std::size_t index = module.definitionIndex(query.result);
    if (!tracer_.pathsAfter(trace_).reaches(index, fillings)) return {};
    const auto refilled = [&](std::size_t filling) {
      return tracer_.pathsAfter(trace_).reaches(filling, {}) && tracer_.pathsAfter(filling).reaches(index, {trace_});
    };
    return std::ranges::any_of(fillings, refilled) ? std::nullopt : std::optional(result);
  }

  bool asksForHit(Id condition) const {
    return spirv::dependsOn(tracer_.module(), condition,
                            [&](const spirv::Instruction& i) { return answer(i).has_value(); });
  }

  // The leaves that the condition reads after the trace; nullopt if it reads the payload in another way.
  std::optional<std::set<std::uint32_t>> leavesOf(Id condition) const {
    const spirv::Module& module = tracer_.module();
    const auto position = module.position(module.definitionIndex(condition));
    if (!position) return {};
    std::set<std::size_t> loads;
    const bool ofHitObject =
        spirv::dependsOnDataOrControl(module, tracer_.flow(position->function), condition, [&](const auto& i) {
          if (i.op == Op::OpLoad && module.access(i.at(0)).variable == sent_)
            loads.insert(module.definitionIndex(i.result));
          return spirv::queriesHitObject(module, i) && !answer(i);
        });
    if (ofHitObject) return {};  // it says more about the hit
    std::set<std::uint32_t> leaves;
    const auto& accesses = tracer_.accesses();
    for (std::size_t a = 0; a < accesses.size(); ++a) {
      if (!accesses[a].reads || accesses[a].variable != sent_ || !loads.contains(accesses[a].instruction)) continue;
      if (!accesses[a].leaves.exact) return {};
      for (std::uint32_t leaf = accesses[a].leaves.first; leaf < accesses[a].leaves.last; ++leaf) {
        const std::vector<std::size_t> after = tracer_.readsAfter(trace_, sent_, leaf);
        if (std::ranges::find(after, a) == after.end()) return {};
        leaves.insert(leaf);
      }
    }
    return leaves;
  }

  // The condition in the tracing stage for values of the leaves; nullopt if it depends on anything else.
  std::optional<double> evaluated(Id condition, const std::map<std::uint32_t, double>& values) const {
    return spirv::evaluate(tracer_.module(), condition, [&](Id id) -> std::optional<double> {
      if (const spirv::Instruction* i = tracer_.module().definition(id))
        if (const auto known = answer(*i)) return known;
      for (const spirv::AccessFacts& a : tracer_.accesses())
        if (a.reads && a.value == id && a.variable == sent_ && a.leaves.count() == 1)
          if (const auto value = values.find(a.leaves.first); value != values.end()) return value->second;
      return {};
    });
  }

  // Values that a store writes: all of them, or the least and the largest one.
  std::vector<double> samplesOf(const StoredValue& store) const {
    const spirv::Instruction* value = shader_.module().definition(store.value.id);
    if (value && shader_.module().stage() == spv::ExecutionModel::ClosestHitKHR &&
        spirv::loadsBuiltIn(shader_.module(), *value, spv::BuiltIn::RayTmaxKHR))
      return hitDistances();
    const spirv::ValueRange range = shader_.ranges().rangeAt(store.instruction, store.value.id, store.value.path);
    return range.values.empty() ? std::vector{range.min, range.max} : range.values;
  }

  // Values of gl_HitTEXT: the ends of the interval of the trace, which hits practically never have exactly.
  std::vector<double> hitDistances() const {
    constexpr float kMost = std::numeric_limits<float>::max();
    const auto trace = std::ranges::find(tracer_.traces(), trace_, &spirv::TraceFacts::instruction);
    if (trace == tracer_.traces().end() || trace->ray == spirv::Module::kNone) return {0.0, double{kMost}};
    const spirv::RayOperands ray = *spirv::rayOperands(tracer_.module().instructions()[trace->ray]);
    const spirv::ValueRange tmin = tracer_.ranges().rangeAt(trace->ray, ray.tmin);
    const spirv::ValueRange tmax = tracer_.ranges().rangeAt(trace->ray, ray.tmax);
    const float low = static_cast<float>(std::clamp(tmin.min, 0.0, double{kMost}));
    const float high = static_cast<float>(std::clamp(tmax.max, 0.0, double{kMost}));
    return {std::nextafter(low, kMost), std::nextafter(high, 0.0f)};
  }

  const spirv::StageFacts& tracer_;
  const Id sent_;
  const std::size_t trace_;
  const spirv::StageFacts& shader_;
  const Id received_;
  const std::uint32_t leaf_;
  std::size_t start_ = 0, function_ = 0;                                   // of the shader's entry function
  std::vector<std::size_t> writers_;                                       // of the leaf in the shader
  std::map<std::uint32_t, std::vector<StoredValue>> stores_;               // to other leaves
  mutable std::map<Id, std::optional<std::set<std::uint32_t>>> leavesOf_;  // cache, by condition
};

}  // namespace

std::vector<std::size_t> readsOfUnwritten(const PayloadEnd& tracer, std::size_t trace, const PayloadEnd& shader,
                                          std::uint32_t leaf) {
  return UnwrittenPaths(tracer, trace, shader, leaf).reads();
}

}  // namespace quintet::check
