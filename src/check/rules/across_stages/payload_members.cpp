// SPDX-License-Identifier: Apache-2.0
// Q104: a part of a payload is read after a trace, but some shader that the trace can run does not write it. Q105: a
// nested trace with the incoming payload overwrites a part that is read afterwards. Parts are leaves (spirv/leaves.h).
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "check/rules/across_stages/payload_receivers.h"
#include "check/rules/across_stages/shared_data.h"
#include "check/rules/across_stages/unwritten_paths.h"
#include "check/rules/rules.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

using spv::StorageClass;
using LeafList = std::vector<std::uint32_t>;

class MemberRule {
 public:
  MemberRule(const CheckInput& input, const PayloadReceivers& receivers, Report& report)
      : input_(input), graph_(input.graph), receivers_(receivers), report_(report) {}

  void check(const TraceSite& site) {
    const spirv::StageFacts& tracer = graph_.facts(site);
    const spirv::SharedVariable* payload = tracer.variable(site.trace->payload);
    if (!payload || hasWrongQualifier(site)) return;
    site_ = &site;
    tracer_ = &tracer;
    payload_ = payload;
    sameType_ = &receivers_.sameTypes(site);
    if (site.isSearch()) return checkSearch();
    LeafList read;
    std::vector<LeafGroup> unwritten, overwritten, stale;
    for (std::uint32_t leaf = 0; leaf < tracer.leaves(payload->id).count(); ++leaf) {
      const std::vector<std::size_t> all = tracer.readsAfter(site.trace->instruction, payload->id, leaf);
      if (all.empty()) continue;
      read.push_back(leaf);
      if (!writtenBefore(leaf))
        findUnwritten(leaf, unwritten);
      else
        findStale(leaf, stale);
      if (payload->storage == StorageClass::IncomingRayPayloadKHR) findOverwritten(leaf, all, overwritten);
    }
    reportHitsWithoutResult(read);
    reportGroups("Q104", unwritten);
    reportGroups("Q104", stale);
    reportGroups("Q105", overwritten);
    reportConstants(read);
  }

 private:
  // Q103 reports these stages: they do not access the payload at all.
  bool hasWrongQualifier(const TraceSite& site) const {
    return std::ranges::any_of(receivers_.edges(site), [&](const Edge* edge) {
      return edge->role != Role::intersection && receivers_.of(edge->stage).wrongQualifier;
    });
  }

  std::size_t instruction() const { return site_->trace->instruction; }

  // Written by the tracing stage, or, for an incoming payload, by the stage that traced the incoming ray.
  bool writtenBefore(std::uint32_t leaf) const {
    if (tracer_->writtenBefore(payload_->id, leaf, instruction())) return true;
    if (payload_->storage != StorageClass::IncomingRayPayloadKHR) return false;
    return receivers_.anyTraceTo(site_->stage, [&](const TraceSite& other) {
      return std::ranges::any_of(graph_.facts(other).accesses(), [&](const auto& a) {
        return a.writes && a.variable == other.trace->payload && a.leaves.covers(leaf);
      });
    });
  }

  // The payload that a stage of the trace receives; null if it uses none or one of a different type.
  const spirv::SharedVariable* received(const Edge& edge) const {
    const spirv::SharedVariable* payload = graph_.facts(edge).incoming(StorageClass::IncomingRayPayloadKHR);
    return hasSameType(edge) ? payload : nullptr;
  }
  bool hasSameType(const Edge& edge) const { return (*sameType_)[receivers_.classOf(edge.stage)]; }

  bool writes(const Edge& edge, std::uint32_t leaf, bool always) const { return writes(edge.stage, leaf, always); }
  bool writes(std::size_t stage, std::uint32_t leaf, bool always) const {
    if (!(*sameType_)[receivers_.classOf(stage)]) return true;  // Q101
    const PayloadReceiver& receiver = receivers_.of(stage);
    if (!receiver.payload || leaf >= receiver.writes.size()) return false;
    // Which path runs can depend on a specialization constant with which the other stages agree.
    const bool each = always && !receiver.facts->hasUnknownConstants();
    return each ? receiver.writesAlways[leaf] : receiver.writes[leaf];
  }

  bool readsInput(const Edge& edge, std::uint32_t leaf) const {
    const PayloadReceiver& receiver = receivers_.of(edge.stage);
    return hasSameType(edge) && leaf < receiver.readsIn.size() && receiver.readsIn[leaf];
  }

  // Also in the search, before the execution of a hit object.
  bool anyHitWrites(HitGroupRay hit, std::uint32_t leaf) const {
    if (site_->isExecution()) {
      const PipelineStage* anyHit = graph_.stage(graph_.shaders(hit).anyHit);
      return anyHit && anyHit->facts && writes(static_cast<std::size_t>(anyHit - graph_.stages.data()), leaf, false);
    }
    return std::ranges::any_of(edgesOf(site_->edges, hit), [&](const Edge& edge) {
      return edge.role == Role::anyHit && writes(edge, leaf, false);
    });
  }

  // True if a shader of the role, or an any-hit shader before it, can write the leaf.
  bool canWrite(std::uint32_t leaf, Role role) const {
    if (site_->isExecution() && role == Role::closestHit &&
        std::ranges::any_of(receivers_.hits(*site_), [&](HitGroupRay hit) { return anyHitWrites(hit, leaf); }))
      return true;
    return std::ranges::any_of(receivers_.edges(*site_), [&](const Edge* edge) {
      const bool counts = edge->role == role || (role == Role::closestHit && edge->role == Role::anyHit);
      return counts && writes(*edge, leaf, false);
    });
  }

  // Calls `use` for each way in which the trace can end: with whether it is a miss, whether the leaf is written then
  // (0 never, 1 on some path, 2 always), and the shader or null. Stops if `use` returns false.
  // If it is unknown which hit group or miss shader runs, and one of them can write the leaf, these ends are skipped.
  // `edges` and `hits`: those of the trace, or the first of equal ones.
  template <class Edges, class Hits, class Use>
  void forEachEnd(std::uint32_t leaf, const Edges& edges, const Hits& hits, const Use& use) const {
    const bool skipHits = site_->assumesHits && canWrite(leaf, Role::closestHit);
    const bool skipMisses = site_->assumesMisses && canWrite(leaf, Role::miss);
    if (site_->mayRunNothing && (skipHits || skipMisses)) return;  // it can be that only these ends are executed
    for (const auto& entry : edges) {
      const Edge& edge = edgeOf(entry);
      if (edge.role != Role::miss && edge.role != Role::closestHit) continue;
      if (edge.role == Role::miss ? skipMisses : skipHits) continue;
      const bool byAnyHit = edge.role == Role::closestHit && anyHitWrites(edge.hit, leaf);
      const int written = writes(edge, leaf, true) || byAnyHit ? 2 : writes(edge, leaf, false) ? 1 : 0;
      if (!use(edge.role == Role::miss, written, &edge, edge.hit)) return;
    }
    if (skipHits) return;
    for (const HitGroupRay hit : hits) {
      const bool without = site_->skipsClosestHit() || graph_.shaders(hit).closestHit.empty();
      if (without && !use(false, anyHitWrites(hit, leaf) ? 2 : 0, nullptr, hit)) return;
    }
  }
  static const Edge& edgeOf(const Edge& edge) { return edge; }
  static const Edge& edgeOf(const Edge* edge) { return *edge; }

  // The same for the first of equal ends.
  template <class Use>
  void forEachKindOfEnd(std::uint32_t leaf, const Use& use) const {
    forEachEnd(leaf, receivers_.edges(*site_), receivers_.hits(*site_), use);
  }

  bool hitsNoGroup() const {
    return site_->trace->mayHit && !site_->mayRunNothing && graph_.groups.hitGroups.empty() &&
           graph_.groups.groupsKnown;
  }

  bool hasNonWriter(std::uint32_t leaf) const {
    bool found = hitsNoGroup();
    forEachKindOfEnd(leaf, [&](bool, int written, const Edge*, HitGroupRay) {
      found = found || written != 2;
      return !found;
    });
    return found;
  }

  // Descriptions of shaders and hits that can end the trace without writing the leaf, up to 3.
  std::vector<std::string> nonWriters(std::uint32_t leaf) const {
    std::vector<std::string> result;
    if (!hasNonWriter(leaf)) return result;
    constexpr std::size_t kMaxNamed = 3;
    bool skipped = false;
    forEachEnd(leaf, site_->edges, site_->hits, [&](bool, int written, const Edge* edge, HitGroupRay hit) {
      if (written == 2) return true;
      if (edge)
        result.push_back(fmt::format("the {}{}", graph_.describe(*edge), written == 1 ? ", on some path," : ""));
      else if (!site_->skipsClosestHit())
        result.push_back(fmt::format("a hit without a closest-hit shader ({})", graph_.describe(hit)));
      else if (!skipped)
        result.push_back("a hit (closest-hit shaders are skipped)"), skipped = true;
      return result.size() < kMaxNamed;
    });
    if (hitsNoGroup()) result.push_back(fmt::format("a hit (the {} has no hit groups)", graph_.groups.noun));
    if (result.size() > kMaxNamed) result.resize(kMaxNamed);
    return result;
  }

  // ---- Q104

  // Reports closest-hit shaders that write nothing that is read afterwards and have no other effect.
  void reportHitsWithoutResult(const LeafList& read) {
    if (read.empty() || input_.featureDefines) return;
    const auto hasNoResult = [&](const Edge* edge) {
      const auto written = [&](std::uint32_t leaf) {
        return writes(*edge, leaf, false) || anyHitWrites(edge->hit, leaf);
      };
      return edge->role == Role::closestHit && edge->exact && std::ranges::none_of(read, written) &&
             !receivers_.of(edge->stage).hasEffects;
    };
    if (std::ranges::none_of(receivers_.edges(*site_), hasNoResult)) return;
    for (const Edge& edge : site_->edges) {
      if (!hasNoResult(&edge)) continue;
      report_.add("Q104", graph_.location(*site_),
                  fmt::format("the payload is read after this {}, but the {} writes none of the members that are "
                              "read, so its hits have no effect",
                              site_->noun(), graph_.describe(edge)));
    }
  }

  void findUnwritten(std::uint32_t leaf, std::vector<LeafGroup>& groups) const {
    const std::vector<std::size_t> reads = exactReads(tracer_->unguardedReads(instruction(), payload_->id, leaf));
    if (reads.empty()) return findUnwrittenBehindConditions(leaf, groups);
    const std::vector<std::string> missing = nonWriters(leaf);
    if (missing.empty()) return;
    addTo(groups,
          {"", readAfter(),
           fmt::format(", but {} {} not write it, and it is not set before the {}", fmt::join(missing, " and "),
                       missing.size() == 1 ? "does" : "do", site_->noun())},
          leaf, reads.front());
  }

  // The same for reads behind conditions on the payload that hold although a shader does not write the leaf.
  void findUnwrittenBehindConditions(std::uint32_t leaf, std::vector<LeafGroup>& groups) const {
    if (tracer_->readsAfter(instruction(), payload_->id, leaf).empty()) return;
    for (const Edge& edge : site_->edges) {
      const PayloadReceiver& receiver = receivers_.of(edge.stage);
      if (leaf < receiver.writesAlways.size() && receiver.writesAlways[leaf]) continue;
      const bool ends = edge.role == Role::miss || (edge.role == Role::closestHit && !anyHitWrites(edge.hit, leaf));
      if (!ends || !edge.exact || !received(edge)) continue;
      const std::vector<std::size_t> reads = exactReads(
          readsOfUnwritten({*tracer_, payload_->id}, instruction(), {graph_.facts(edge), received(edge)->id}, leaf));
      if (reads.empty()) continue;
      addTo(groups,
            {"", readAfter(),
             fmt::format(", but the {}{} does not write it, and it is not set before the {}", graph_.describe(edge),
                         writes(edge, leaf, false) ? ", on some path," : "", site_->noun())},
            leaf, reads.front());
    }
  }

  // Drops reads with a dynamic index if some element is written: which one is read is unknown.
  std::vector<std::size_t> exactReads(std::vector<std::size_t> reads) const {
    std::erase_if(reads, [&](std::size_t i) {
      const spirv::LeafRange& range = tracer_->accesses()[i].leaves;
      if (range.exact) return false;
      for (std::uint32_t leaf = range.first; leaf < range.last; ++leaf)
        if (writtenBefore(leaf) || !hasNonWriter(leaf)) return true;
      return false;
    });
    return reads;
  }

  // The value of the previous ray: the trace runs again, or an equal trace follows, and nothing sets the leaf in
  // between. Only hits write it, or only misses do, without reading it; all else can be a state on purpose.
  void findStale(std::uint32_t leaf, std::vector<LeafGroup>& groups) const {
    std::vector<std::size_t> reads = tracer_->unguardedReads(instruction(), payload_->id, leaf);
    std::erase_if(reads, [&](std::size_t i) { return !tracer_->accesses()[i].leaves.exact; });
    if (reads.empty() || !hasOneKindOfWriter(leaf)) return;
    const std::span<const TraceSite> traces = graph_.tracesOf(site_->stage);
    const auto earlier = std::ranges::find_if(traces, [&](const TraceSite& other) {
      return other.trace->payload == payload_->id && isSameRay(other) && isOtherRay(other) &&
             canBeStale(*other.trace, leaf);
    });
    if (earlier == traces.end()) return;
    if (earlier->trace == site_->trace) {
      std::erase_if(reads, [&](std::size_t i) {
        return !spirv::canRunAfter(tracer_->module(), instruction(), tracer_->accesses()[i].instruction);
      });
      if (reads.empty()) return;
    }
    const std::vector<std::string> missing = nonWriters(leaf);
    addTo(groups,
          {"", readAfter(),
           fmt::format(", but {} {} not write it: it then has the value of the previous ray, because it is not set "
                       "before {} {}",
                       fmt::join(missing, " and "), missing.size() == 1 ? "does" : "do",
                       earlier->trace == site_->trace ? "each" : "this", site_->noun())},
          leaf, reads.front());
  }

  std::string readAfter() const { return fmt::format(" is read after this {}", site_->noun()); }

  // Of a search, whose reads come before an execution of the hit object: only any-hit shaders can have written.
  void checkSearch() {
    std::vector<LeafGroup> unwritten;
    for (std::uint32_t leaf = 0; leaf < tracer_->leaves(payload_->id).count() && !site_->hits.empty(); ++leaf) {
      std::vector<std::size_t> reads = tracer_->unguardedReads(instruction(), payload_->id, leaf);
      std::erase_if(reads, [&](std::size_t i) { return !tracer_->accesses()[i].leaves.exact; });
      if (reads.empty() || writtenBefore(leaf)) continue;
      if (std::ranges::any_of(receivers_.edges(*site_), [&](const Edge* edge) {
            return edge->role == Role::anyHit && writes(*edge, leaf, false);
          }))
        continue;
      addTo(unwritten,
            {"", readAfter(),
             ", but no any-hit shader writes it, and closest-hit and miss shaders run only when the hit object is "
             "executed"},
            leaf, reads.front());
    }
    reportGroups("Q104", unwritten);
  }

  // True if the other trace, or the trace in an earlier iteration, fills the hit object again, so that its content differs.
  bool isOtherRay(const TraceSite& other) const {
    if (other.isSearch()) return false;  // its shaders at the end run later
    if (!site_->isExecution()) return true;
    const std::size_t ray = site_->trace->ray;
    if (ray == spirv::Module::kNone) return false;
    if (other.trace != site_->trace) return other.trace->ray != ray;
    return spirv::canRunAfter(tracer_->module(), ray, instruction());
  }

  bool isSameRay(const TraceSite& other) const {
    const auto same = [](const spirv::ArgumentValues& a, const spirv::ArgumentValues& b) {
      return a.exact() && b.exact() && a.values == b.values;
    };
    const spirv::TraceFacts &a = *site_->trace, &b = *other.trace;
    return &a == &b || (same(a.flags, b.flags) && same(a.offset, b.offset) && same(a.miss, b.miss));
  }

  bool hasOneKindOfWriter(std::uint32_t leaf) const {
    if (std::ranges::any_of(receivers_.edges(*site_), [&](const Edge* edge) {
          return edge->role != Role::intersection && (!edge->exact || !hasSameType(*edge) || readsInput(*edge, leaf) ||
                                                      (edge->role == Role::anyHit && writes(*edge, leaf, false)));
        }))
      return false;
    if (site_->isExecution() &&
        std::ranges::any_of(receivers_.hits(*site_), [&](HitGroupRay hit) { return anyHitWrites(hit, leaf); }))
      return false;
    int ofMiss = -1, ofHit = -1;
    bool clear = true;
    forEachKindOfEnd(leaf, [&](bool miss, int written, const Edge*, HitGroupRay) {
      int& kind = miss ? ofMiss : ofHit;
      clear = clear && written != 1 && (kind == -1 || kind == written);
      kind = written;
      return clear;
    });
    return clear && ofMiss + ofHit == 2 && ofMiss != ofHit;  // one always, the other one never
  }

  // True if the leaf can have a value of the ray of `earlier` when the trace starts.
  bool canBeStale(const spirv::TraceFacts& earlier, std::uint32_t leaf) const {
    const spirv::PathsAfter& paths = tracer_->pathsAfter(earlier.instruction);
    std::vector<std::size_t> kills = tracer_->writers(payload_->id, leaf);
    std::erase(kills, instruction());
    std::erase(kills, earlier.instruction);
    for (const TraceSite& other : graph_.tracesOf(site_->stage))
      if (other.isSearch()) std::erase(kills, other.trace->instruction);
    if (!paths.reaches(instruction(), kills)) return false;
    const auto position = tracer_->module().position(instruction());
    const spirv::ControlFlow& flow = tracer_->flow(position->function);
    const auto loads = [&](const spirv::Instruction& i) {
      return i.op == spv::Op::OpLoad && tracer_->module().access(i.at(0)).variable == payload_->id;
    };
    bool ofLeaf = false, ofPayload = false, excludesInitial = false;
    for (const std::size_t guard : paths.guards(instruction())) {
      const spirv::Id condition = flow.condition(guard);
      if (!spirv::dependsOnDataOrControl(tracer_->module(), flow, condition, loads, false)) continue;
      if (!tracer_->dependsOnLeaf(condition, payload_->id, leaf)) {
        ofPayload = true;
        continue;
      }
      ofLeaf = true;
      excludesInitial = excludesInitial || endsWithInitialValue(paths, guard, leaf);
    }
    // A condition on the leaf ends the loop, unless it has the value of before the loop.
    if (ofLeaf) return excludesInitial;
    bool missWrites = false;
    forEachKindOfEnd(leaf, [&](bool miss, int written, const Edge*, HitGroupRay) {
      missWrites = missWrites || (miss && written == 2);
      return true;
    });
    return !ofPayload || !missWrites;
  }

  // True if the branch does not lead to the trace while the leaf has the constant that was set before.
  bool endsWithInitialValue(const spirv::PathsAfter& paths, std::size_t guard, std::uint32_t leaf) const {
    const spirv::Module& module = tracer_->module();
    std::optional<double> initial;
    for (const spirv::AccessFacts& a : tracer_->accesses()) {
      if (!a.writes || a.variable != payload_->id || !a.leaves.covers(leaf)) continue;
      const spirv::ValuePart value = tracer_->storedValue(a, leaf);
      const auto constant = constantNumber(module, value);
      if (!constant || (initial && *initial != *constant)) return false;
      initial = constant;
    }
    if (!initial) return false;
    const auto position = module.position(instruction());
    const spirv::Block& block = tracer_->flow(position->function).function().blocks[guard];
    const spirv::Instruction& branch = module.instructions()[block.end - 1];
    const auto outcome = evaluate(module, branch.at(0), [&](spirv::Id id) -> std::optional<double> {
      const auto reads = [&](const spirv::AccessFacts& a) {
        return a.reads && a.value == id && a.variable == payload_->id && a.leaves == spirv::LeafRange{leaf, leaf + 1};
      };
      return std::ranges::any_of(tracer_->accesses(), reads) ? initial : std::nullopt;
    });
    if (!outcome || branch.op != spv::Op::OpBranchConditional) return false;
    const spirv::Id target = branch.at(*outcome != 0.0 ? 1 : 2);
    const auto& blocks = tracer_->flow(position->function).function().blocks;
    const auto next = std::ranges::find(blocks, target, &spirv::Block::label);
    if (next == blocks.end()) return false;
    return !paths.leadsTo(static_cast<std::size_t>(next - blocks.begin()), instruction());
  }

  // Reports outermost members that have the same constant after the trace on all paths.
  void reportConstants(const LeafList& read) {
    if (graph_.hasVariants) return;
    const spirv::Leaves& leaves = tracer_->leaves(payload_->id);
    std::uint32_t done = 0;
    for (const std::uint32_t leaf : read) {
      if (leaf < done) continue;
      const spirv::LeafRange member = leaves.member(leaf);
      done = member.last;
      std::set<bool> written;
      LeafList all;
      for (std::uint32_t i = member.first; i < member.last; ++i) {
        const std::optional<bool> constant = writtenBefore(i) ? isConstant(i) : std::nullopt;
        if (!constant) break;
        written.insert(*constant);
        all.push_back(i);
      }
      if (all.size() != member.count()) continue;
      const std::vector<std::size_t> reads = tracer_->readsAfter(instruction(), payload_->id, leaf);
      report_.add("Q104", graph_.location(*site_),
                  fmt::format("{}{}{}, but {}", nameOf(*payload_, leaves.names(all).front()), readAfter(),
                              lineText(reads.front()),
                              !written.contains(true)
                                  ? "no shader that the trace can run writes it, so it keeps its constant value"
                                  : "all shaders that the trace can run write the same constant that it had "
                                    "before, so its value does not depend on the trace"));
    }
  }

  // Nullopt if the leaf can have different values; else whether a shader that the trace can run writes it.
  std::optional<bool> isConstant(std::uint32_t leaf) const {
    if (payload_->storage != StorageClass::RayPayloadKHR || canHaveResultOfOther(leaf)) return {};
    if (canRunMore(leaf)) return {};
    std::set<std::string> constants;
    bool known = addConstants(*tracer_, payload_->id, leaf, constants);
    std::size_t callees = 0, writers = 0;
    for (const Edge& edge : site_->edges) {
      if (edge.role == Role::intersection) continue;
      const bool writesLeaf = writes(edge, leaf, false);
      known = known && edge.exact && hasSameType(edge) &&
              (!writesLeaf || addConstants(graph_.facts(edge), received(edge)->id, leaf, constants));
      if (!known || constants.size() > 1) return {};
      ++callees;
      writers += writesLeaf ? 1 : 0;
    }
    if (!known || callees == 0 || constants.size() != 1) return {};
    return writers > 0;
  }

  // True if a different mistake keeps a writer of the leaf from running: a record beyond the table (Q515), or flags that exclude
  // the any-hit shader in all traces (Q610).
  bool canRunMore(std::uint32_t leaf) const {
    if (graph_.groups.hitRecords != HitRecords::byRecord) return false;
    const std::set<std::size_t> records = graph_.recordsOf(*site_->trace);
    if (graph_.groups.tablesKnown && !records.empty() && *records.rbegin() >= graph_.groups.hitGroups.size())
      return true;
    const auto excludes = [](const TraceSite& site) {
      return site.trace->flags.mustHave(kFlagOpaque) || site.trace->flags.mustHave(kFlagCullNoOpaque);
    };
    return receivers_.allTraces(excludes) && std::ranges::any_of(site_->hits, [&](HitGroupRay hit) {
             const PipelineStage* anyHit = graph_.stage(graph_.shaders(hit).anyHit);
             const spirv::SharedVariable* payload =
                 anyHit && anyHit->facts ? anyHit->facts->incoming(StorageClass::IncomingRayPayloadKHR) : nullptr;
             if (!payload) return false;
             const bool sameLeaves =
                 anyHit->facts->leaves(payload->id).count() == tracer_->leaves(payload_->id).count();
             return !sameLeaves || anyHit->facts->writes(payload->id, leaf);
           });
  }

  // True if the leaf can have a value from a different trace with the payload when the trace starts.
  bool canHaveResultOfOther(std::uint32_t leaf) const {
    std::vector<std::size_t> stores;
    for (const spirv::AccessFacts& a : tracer_->accesses())
      if (a.writes && a.variable == payload_->id && a.leaves.exact && a.leaves.covers(leaf))
        stores.push_back(a.instruction);
    return std::ranges::any_of(graph_.tracesOf(site_->stage), [&](const TraceSite& other) {
      return &other != site_ && other.trace->payload == payload_->id &&
             tracer_->pathsAfter(other.trace->instruction).reaches(instruction(), stores) &&
             std::ranges::any_of(receivers_.edges(other), [&](const Edge* edge) {
               const PayloadReceiver& receiver = receivers_.of(edge->stage);
               return edge->role != Role::intersection && leaf < receiver.writes.size() && receiver.writes[leaf];
             });
    });
  }

  // Adds the values that the stage writes to the leaf. Returns false if one of them is not constant.
  static bool addConstants(const spirv::StageFacts& facts, spirv::Id payload, std::uint32_t leaf,
                           std::set<std::string>& constants) {
    for (const spirv::AccessFacts& a : facts.accesses()) {
      if (!a.writes || a.variable != payload || !a.leaves.covers(leaf)) continue;
      const spirv::ValuePart value = facts.storedValue(a, leaf);
      if (!facts.module().isConstant(value.id)) return false;
      constants.insert(constantText(facts.module(), value.id));
    }
    return true;
  }

  // A text that is equal for equal constants of all modules.
  static std::string constantText(const spirv::Module& module, spirv::Id id, int depth = 0) {
    const spirv::Instruction* value = module.definition(id);
    if (!value || depth > 8) return "?";
    if (value->op == spv::Op::OpConstantComposite) {
      std::string text = "(";
      for (const spirv::Id element : value->operands) text += constantText(module, element, depth + 1) + " ";
      return text + ")";
    }
    return fmt::format("{} {}", static_cast<int>(value->op), fmt::join(value->operands, " "));
  }

  // ---- Q105

  void findOverwritten(std::uint32_t leaf, const std::vector<std::size_t>& reads,
                       std::vector<LeafGroup>& groups) const {
    const Edge* writer = nullptr;
    for (const Edge* edge : receivers_.edges(*site_)) {
      if (edge->role == Role::intersection || !received(*edge)) continue;
      if (readsInput(*edge, leaf)) return;  // input of the inner ray
      const bool assumed = edge->role == Role::miss ? site_->assumesMisses : site_->assumesHits;
      if (!assumed && !writer && writes(*edge, leaf, false)) writer = edge;
    }
    // A value that a shader at the end of the trace keeps is a default, unless a condition on another member decides
    // whether it is read.
    if (!writer || (hasNonWriter(leaf) && !isTestedByOtherMember(leaf))) return;
    const spirv::Module& module = tracer_->module();
    const std::vector<std::size_t> kills = tracer_->writers(payload_->id, leaf);
    for (const spirv::AccessFacts& a : tracer_->accesses()) {
      const bool overwritten = a.writes && a.variable == payload_->id && a.leaves.covers(leaf) &&
                               !module.isConstant(tracer_->storedValue(a, leaf).id) &&
                               spirv::canRunAfter(module, instruction(), a.instruction);
      // A value that is also read if the trace does not run is a default, too.
      const auto keeps = [&](std::size_t read) {
        return tracer_->pathsAfter(a.instruction).reaches(tracer_->accesses()[read].instruction, kills);
      };
      if (!overwritten || std::ranges::any_of(reads, keeps)) continue;
      const SourceLocation written = module.location(module.instructions()[a.instruction]);
      addTo(groups,
            {fmt::format("this {} uses the incoming payload: ", site_->noun()),
             fmt::format(", written in line {}, is overwritten by the {} before it is read", written.line,
                         graph_.describe(*writer)),
             ""},
            leaf, reads.front());
      return;
    }
  }

  // True if closest-hit shaders are skipped, and a condition depends on another member that the miss shader writes with
  // this one.
  bool isTestedByOtherMember(std::uint32_t leaf) const {
    const auto miss = std::ranges::find(site_->edges, Role::miss, &Edge::role);
    if (!site_->skipsClosestHit() || miss == site_->edges.end() || !writes(*miss, leaf, true)) return false;
    const spirv::Module& module = tracer_->module();
    const spirv::Leaves& leaves = tracer_->leaves(payload_->id);
    for (std::uint32_t other = 0; other < leaves.count(); ++other) {
      if (leaves.member(leaf).covers(other) || !writes(*miss, other, true)) continue;
      if (tracer_->readsAfter(instruction(), payload_->id, other).empty()) continue;
      const auto tests = [&](const spirv::Instruction& i) {
        const bool chooses = i.op == spv::Op::OpBranchConditional || i.op == spv::Op::OpSelect;
        return chooses && tracer_->dependsOnLeaf(i.at(0), payload_->id, other);
      };
      if (std::ranges::any_of(module.instructions(), tests)) return true;
    }
    return false;
  }

  // ---- Messages

  void reportGroups(std::string_view id, const std::vector<LeafGroup>& groups) {
    for (const LeafGroup& group : groups)
      for (const std::string& part : tracer_->leaves(payload_->id).names(group.leaves))
        report_.add(
            id, graph_.location(*site_),
            group.text.before + nameOf(*payload_, part) + group.text.after + lineText(group.read) + group.text.end,
            relatedOf(group));
  }

  // Where the leaves are read, and the shaders that end the trace without writing them.
  std::vector<RelatedLocation> relatedOf(const LeafGroup& group) const {
    const SourceLocation read = locationOf(*tracer_, tracer_->accesses()[group.read]);
    std::vector<RelatedLocation> result{relatedTo(graph_.location(graph_.stages[site_->stage], read), "read here")};
    constexpr std::size_t kMaxShaders = 4;
    for (const Edge& edge : site_->edges) {
      const bool ends = edge.role == Role::miss || edge.role == Role::closestHit;
      const spirv::SharedVariable* payload = received(edge);
      if (ends && payload && result.size() < kMaxShaders && !writes(edge, group.leaves.front(), true))
        result.push_back(relatedTo(graph_.declarationOf(graph_.stages[edge.stage], *payload),
                                   fmt::format("not written by the {}", graph_.describe(edge))));
    }
    return result;
  }

  std::string lineText(std::size_t access) const { return readLine(*tracer_, access, site_->trace->location.file); }

  const CheckInput& input_;
  const PipelineGraph& graph_;
  const PayloadReceivers& receivers_;
  Report& report_;
  const TraceSite* site_ = nullptr;  // the trace that is checked
  const spirv::StageFacts* tracer_ = nullptr;
  const spirv::SharedVariable* payload_ = nullptr;
  const std::vector<bool>* sameType_ = nullptr;  // by class of receivers
};

}  // namespace

void checkPayloadMembers(const CheckInput& input, const PayloadReceivers& receivers, Report& report) {
  MemberRule rule(input, receivers, report);
  for (const TraceSite& site : input.graph.traces) rule.check(site);
}

}  // namespace quintet::check
