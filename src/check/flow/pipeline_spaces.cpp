// SPDX-License-Identifier: Apache-2.0
#include "check/flow/pipeline_spaces.h"

#include <spirv/unified1/GLSL.std.450.h>

#include <algorithm>
#include <optional>
#include <tuple>

#include "base/parallel.h"
#include "spirv/value_part.h"

namespace quintet::check {
namespace {

using spirv::Id;
using spv::Op;
using Kind = SpaceTag::Kind;

constexpr int kMaxRounds = 12;         // of propagate()
constexpr int kMaxUseDepth = 48;       // of uses()
constexpr std::size_t kMaxUses = 400;  // that uses() follows

bool isExtended(const spirv::Module& module, const spirv::Instruction& i, std::initializer_list<unsigned> numbers) {
  return std::ranges::any_of(numbers, [&](unsigned number) { return spirv::isExtended(module, i, number); });
}

// True for max(x, 0), clamp(x, 0, 1) and abs(x) of the value.
bool isClamped(const spirv::Module& module, Id value) {
  const auto isZero = [&](Id id) {
    const auto constant = module.constantFloat(id);
    return constant && *constant >= 0.0 && *constant < 0.1;
  };
  for (const std::size_t user : module.users(value)) {
    const spirv::Instruction& i = module.instructions()[user];
    if (isExtended(module, i, {GLSLstd450FMax, GLSLstd450NMax}) && (isZero(i.at(2)) || isZero(i.at(3)))) return true;
    if (isExtended(module, i, {GLSLstd450FClamp, GLSLstd450NClamp}) && i.at(2) == value && isZero(i.at(3))) return true;
    if (isExtended(module, i, {GLSLstd450FAbs})) return true;
  }
  return false;
}

bool usesOf(const spirv::Module& module, Id value, std::initializer_list<unsigned> extended) {
  return std::ranges::any_of(
      module.users(value), [&](std::size_t user) { return isExtended(module, module.instructions()[user], extended); });
}

}  // namespace

struct PipelineSpaces::Search {
  ValueUses uses;
  std::vector<Open> open;
  std::set<std::tuple<std::size_t, Id, spirv::Path>> seen;

  void push(Open next) {
    if (!seen.emplace(next.stage, next.id, next.inner).second) return;
    if (next.depth > kMaxUseDepth || seen.size() > kMaxUses)
      uses.truncated = true;
    else
      open.push_back(std::move(next));
  }
};

PipelineSpaces::PipelineSpaces(const spirv::Module& module) {
  stages_.push_back(std::make_unique<SpaceTags>(module, true));
  stages_[0]->run();
  stages_[0]->finish();
}

PipelineSpaces::PipelineSpaces(const PipelineGraph& graph) {
  using Storage = spv::StorageClass;
  stages_.resize(graph.stages.size());
  parallelFor(stages_.size(), [&](std::size_t i) {
    if (!graph.stages[i].facts) return;
    stages_[i] = std::make_unique<SpaceTags>(graph.stages[i].facts->module(), graph.usesLibrary);
    stages_[i]->run();
  });
  const auto linkIncoming = [&](const Shared& from, std::size_t stage, Storage storage) {
    if (const spirv::SharedVariable* variable = graph.stages[stage].facts->incoming(storage))
      link(from, {stage, variable->id});
  };
  // In raw modules it can be unknown whether a trace reaches a stage.
  const auto isKnown = [&](const Edge& edge) { return edge.exact || graph.usesLibrary; };
  // All shaders that a trace runs receive the same payload: a second trace with the same targets adds only its own.
  std::vector<std::optional<Shared>> linked(graph.targets.size());
  for (const TraceSite& site : graph.traces) {
    const Shared sent{site.stage, site.trace->payload};
    if (sent.second == 0) continue;
    if (linked[site.targets]) {
      link(*linked[site.targets], sent);
      continue;
    }
    for (const Edge& edge : site.edges) {
      if (!isKnown(edge)) continue;
      linkIncoming(sent, edge.stage, Storage::IncomingRayPayloadKHR);
      if (graph.facts(edge).incoming(Storage::IncomingRayPayloadKHR)) linked[site.targets] = sent;
    }
  }
  for (const CallSite& site : graph.calls)
    for (const Edge& edge : site.edges)
      if (isKnown(edge)) linkIncoming({site.stage, site.call->data}, edge.stage, Storage::IncomingCallableDataKHR);
  for (std::size_t group = 0; group < graph.groups.hitGroups.size(); ++group) {
    for (std::size_t ray = 0; ray < graph.rayCount(); ++ray) {
      const program::HitShaders& shaders = graph.shaders({group, ray});
      const PipelineStage* intersection = graph.stage(shaders.intersection);
      const spirv::SharedVariable* attribute =
          intersection && intersection->facts ? intersection->facts->incoming(Storage::HitAttributeKHR) : nullptr;
      if (!mayBeProcedural(graph.groups, graph.groups.hitGroups[group])) addBarycentrics(graph, shaders);
      if (!attribute) continue;
      const auto at = static_cast<std::size_t>(intersection - graph.stages.data());
      for (const std::string* file : {&shaders.closestHit, &shaders.anyHit})
        if (const PipelineStage* reader = graph.stage(*file); reader && reader->facts)
          linkIncoming({at, attribute->id}, static_cast<std::size_t>(reader - graph.stages.data()),
                       Storage::HitAttributeKHR);
    }
  }
  members_.resize(shared_.size());
  for (std::size_t i = 0; i < shared_.size(); ++i) {
    roots_.push_back(find(i));
    members_[roots_[i]].push_back(shared_[i]);
  }
  propagate();
  parallelFor(stages_.size(), [&](std::size_t i) {
    if (stages_[i]) stages_[i]->finish();
  });
  propagate();
}

// The hit attributes of a triangle.
void PipelineSpaces::addBarycentrics(const PipelineGraph& graph, const program::HitShaders& shaders) {
  SpaceTag weights;
  weights.kind = Kind::barycentric;
  for (const std::string* file : {&shaders.closestHit, &shaders.anyHit}) {
    const PipelineStage* reader = graph.stage(*file);
    if (!reader || !reader->facts) continue;
    const spirv::SharedVariable* attribute = reader->facts->incoming(spv::StorageClass::HitAttributeKHR);
    if (!attribute || reader->facts->module().types().nameOf(attribute->type) != "vec2") continue;
    const auto at = static_cast<std::size_t>(reader - graph.stages.data());
    setOf({at, attribute->id});
    stages_[at]->add(attribute->id, {weights});
    stages_[at]->run();
  }
}

std::size_t PipelineSpaces::find(std::size_t set) {
  while (parent_[set] != set) set = parent_[set] = parent_[parent_[set]];
  return set;
}

std::size_t PipelineSpaces::setOf(const Shared& shared) {
  const auto [at, isNew] = index_.emplace(shared, parent_.size());
  if (isNew) {
    parent_.push_back(parent_.size());
    shared_.push_back(shared);
  }
  return find(at->second);
}

void PipelineSpaces::link(const Shared& a, const Shared& b) {
  if (a.second == 0 || b.second == 0) return;
  const std::size_t left = setOf(a), right = setOf(b);
  parent_[right] = left;
}

// Exchanges the tags of linked variables until they do not change. Tags that change in later rounds become unknown.
void PipelineSpaces::propagate() {
  for (int round = 0;; ++round) {
    std::vector<SpaceLeaves> sets(shared_.size());
    for (std::size_t i = 0; i < shared_.size(); ++i) {
      const SpaceLeaves own = stages_[shared_[i].first]->contents(shared_[i].second);
      SpaceLeaves& all = sets[roots_[i]];
      if (all.empty()) {
        all = own;
      } else if (!own.empty()) {
        // Stages with another type are reported by other rules; their members are not comparable.
        const bool same = own.size() == all.size();
        for (std::size_t k = 0; k < all.size(); ++k) all[k] = same ? joined(all[k], own[k]) : unknownTag();
      }
    }
    std::vector<bool> changed(stages_.size(), false);
    for (std::size_t i = 0; i < shared_.size(); ++i) {
      const auto& [stage, variable] = shared_[i];
      const SpaceLeaves& tags = sets[roots_[i]];
      if (!stages_[stage]->add(variable, tags)) continue;
      if (round >= kMaxRounds) stages_[stage]->add(variable, SpaceLeaves(tags.size(), unknownTag()));
      changed[stage] = true;
    }
    if (std::ranges::none_of(changed, [](bool c) { return c; })) return;
    parallelFor(stages_.size(), [&](std::size_t i) {
      if (changed[i]) stages_[i]->run();
    });
  }
}

std::vector<PipelineSpaces::Shared> PipelineSpaces::linked(const Shared& shared) const {
  const auto found = index_.find(shared);
  if (found == index_.end()) return {shared};
  return members_[roots_[found->second]];
}

bool PipelineSpaces::transforms() const {
  return std::ranges::any_of(stages_, [](const std::unique_ptr<SpaceTags>& stage) {
    if (!stage) return false;
    return std::ranges::any_of(stage->module().instructions(), [&](const spirv::Instruction& i) {
      const auto product = stage->product(i);
      return product && (product->transform.map.from == Space::object || product->transform.map.to == Space::object);
    });
  });
}

ValueUses PipelineSpaces::uses(std::size_t stage, Id value) const {
  Search search;
  search.push({stage, value, {}});
  while (!search.open.empty() && !search.uses.truncated) {
    const Open next = search.open.back();
    search.open.pop_back();
    for (const std::size_t user : stages_[next.stage]->module().users(next.id)) visit(next, user, search);
  }
  return search.uses;
}

void PipelineSpaces::visitDot(const Open& open, const spirv::Instruction& dot, Search& search) const {
  const spirv::Module& module = stages_[open.stage]->module();
  if (dot.at(0) == dot.at(1)) {
    search.uses.measured = true;
    return;
  }
  search.uses.dot = true;
  if (isClamped(module, dot.result)) search.uses.asNormal = true;
}

void PipelineSpaces::visitStore(const Open& open, const spirv::Instruction& store, Search& search) const {
  const SpaceTags& tags = *stages_[open.stage];
  const spirv::Access target = tags.module().access(store.at(0));
  spirv::Path path;
  for (const auto& index : target.indices) path.push_back(index.value_or(kAnyIndex));
  path.insert(path.end(), open.inner.begin(), open.inner.end());
  bool followed = false;
  for (const Shared& other : linked({open.stage, target.base})) {
    const spirv::Module& module = stages_[other.first]->module();
    for (const std::size_t load : stages_[other.first]->loads(other.second)) {
      const spirv::Access from = module.access(module.instructions()[load].at(0));
      if (!overlaps(from, path)) continue;
      const std::size_t common = std::min(from.indices.size(), path.size());
      followed = true;
      spirv::Path inner(path.begin() + static_cast<std::ptrdiff_t>(common), path.end());
      search.push({other.first, module.instructions()[load].result, std::move(inner), open.scaled, open.direct,
                   open.depth + 1});
    }
  }
  search.uses.stored = search.uses.stored || !followed;
}

void PipelineSpaces::visitExtended(const Open& open, const spirv::Instruction& i, Search& search) const {
  const spirv::Module& module = stages_[open.stage]->module();
  const auto follow = [&](bool direct) {
    search.push({open.stage, i.result, open.inner, open.scaled, open.direct && direct, open.depth + 1});
  };
  switch (module.extendedSet(i.at(0)) == "GLSL.std.450" ? i.at(1) : 0u) {
    case GLSLstd450Normalize:
      search.uses.normalized = true;
      search.uses.normalizedDirectly = search.uses.normalizedDirectly || open.direct;
      return follow(true);
    case GLSLstd450Length: search.uses.measured = true; return;
    case GLSLstd450Cross: search.uses.crossed = true; return;
    case GLSLstd450Distance: search.uses.difference = true; return;
    case GLSLstd450Reflect:
    case GLSLstd450Refract:
      if (i.at(3) == open.id) search.uses.asNormal = true;
      return;
    case GLSLstd450FaceForward:
      if (i.at(2) == open.id || i.at(4) == open.id) search.uses.asNormal = true;
      if (i.at(2) == open.id) follow(true);
      return;
    case GLSLstd450FMix: return follow(false);
    case GLSLstd450Fma: return follow(false);
    case GLSLstd450Fract:
    case GLSLstd450Floor:
    case GLSLstd450Sin:
    case GLSLstd450Cos: search.uses.pattern = true; return;
    default: return;
  }
}

void PipelineSpaces::visit(const Open& open, std::size_t user, Search& search) const {
  const SpaceTags& tags = *stages_[open.stage];
  const spirv::Module& module = tags.module();
  const spirv::Instruction& i = module.instructions()[user];
  const auto follow = [&](bool scaled = false, bool direct = true) {
    search.push({open.stage, i.result, open.inner, open.scaled || scaled, open.direct && direct, open.depth + 1});
  };
  const Id other = i.at(0) == open.id ? i.at(1) : i.at(0);
  switch (i.op) {
    case Op::OpStore:
      if (i.at(1) == open.id) visitStore(open, i, search);
      return;
    case Op::OpPhi:
    case Op::OpCopyObject:
    case Op::OpCopyLogical: return follow();
    case Op::OpSelect:
      if (i.at(0) != open.id) follow();
      return;
    case Op::OpFNegate: return follow();
    case Op::OpCompositeConstruct: {
      spirv::Path inner = open.inner;
      const auto kind = module.types().get(i.type).kind;
      const auto at = static_cast<std::uint32_t>(std::ranges::find(i.operands, open.id) - i.operands.begin());
      if (kind == spirv::Type::Kind::structure || kind == spirv::Type::Kind::array) inner.insert(inner.begin(), at);
      if (kind == spirv::Type::Kind::matrix) return;
      search.push({open.stage, i.result, std::move(inner), open.scaled, open.direct, open.depth + 1});
      return;
    }
    case Op::OpCompositeExtract: {
      const auto path = i.operands.subspan(1);
      const std::size_t common = std::min(path.size(), open.inner.size());
      for (std::size_t k = 0; k < common; ++k)
        if (open.inner[k] != path[k] && open.inner[k] != kAnyIndex) return;
      spirv::Path inner(open.inner.begin() + static_cast<std::ptrdiff_t>(common), open.inner.end());
      search.push({open.stage, i.result, std::move(inner), open.scaled, open.direct, open.depth + 1});
      return;
    }
    case Op::OpCompositeInsert: {
      spirv::Path inner = open.inner;
      if (i.at(0) == open.id) inner.insert(inner.begin(), i.operands.begin() + 2, i.operands.end());
      const spirv::Type& type = module.types().get(i.type);
      if (type.kind == spirv::Type::Kind::vector || type.kind == spirv::Type::Kind::matrix) return;
      search.push({open.stage, i.result, std::move(inner), open.scaled, open.direct, open.depth + 1});
      return;
    }
    case Op::OpVectorShuffle: return follow();
    case Op::OpVectorTimesScalar: {
      if (i.at(0) != open.id) return;
      const spirv::Instruction* factor = module.definition(i.at(1));
      if (factor && isExtended(module, *factor, {GLSLstd450InverseSqrt})) search.uses.normalized = true;
      return follow(true);
    }
    case Op::OpFMul:
    case Op::OpFDiv: {
      if (!spirv::isSplat(module, other) || (i.op == Op::OpFDiv && i.at(1) == open.id)) return;
      const spirv::Instruction* length = module.definition(module.definition(other)->at(0));
      if (length && isExtended(module, *length, {GLSLstd450Length, GLSLstd450InverseSqrt, GLSLstd450Sqrt}))
        search.uses.normalized = true;
      return follow(true);
    }
    case Op::OpFAdd: {
      const SpaceTag tag = tags.of(other);
      if (tag.translation) {
        search.uses.translated = true;
        return;
      }
      if (open.scaled && spirv::splatConstant(module, other) == 0.5) search.uses.shown = true;
      if (tag.kind == Kind::point) search.uses.moves = true;
      return follow(false, false);
    }
    case Op::OpFSub: {
      if (tags.of(other).untranslated) {
        search.uses.relative = true;
        return;
      }
      const spirv::Instruction& difference = i;
      const bool directed =
          usesOf(module, difference.result, {GLSLstd450Normalize, GLSLstd450Length}) ||
          std::ranges::any_of(module.users(difference.result), [&](std::size_t k) {
            const spirv::Instruction& d = module.instructions()[k];
            const auto ray = spirv::rayOperands(d);
            return (d.op == Op::OpDot && d.at(0) == d.at(1)) || (ray && ray->direction == difference.result);
          });
      if (directed) search.uses.difference = true;
      if (spirv::splatConstant(module, other) == 1.0 && open.scaled) search.uses.shown = true;
      // A point minus a step along the value.
      if (i.at(1) == open.id && tags.of(i.at(0)).kind == Kind::point) {
        search.uses.moves = true;
        follow(false, false);
      }
      return;
    }
    case Op::OpFMod: search.uses.pattern = true; return;
    case Op::OpDot: return visitDot(open, i, search);
    case Op::OpTraceRayKHR:
    case Op::OpHitObjectTraceRayNV: {
      const spirv::RayOperands ray = *spirv::rayOperands(i);
      search.uses.traceOrigin = search.uses.traceOrigin || ray.origin == open.id;
      search.uses.traceDirection = search.uses.traceDirection || ray.direction == open.id;
      return;
    }
    case Op::OpFunctionCall:
    case Op::OpReturnValue:
    case Op::OpImageWrite: search.uses.stored = true; return;
    case Op::OpExtInst: return visitExtended(open, i, search);
    default: return;
  }
}

}  // namespace quintet::check
