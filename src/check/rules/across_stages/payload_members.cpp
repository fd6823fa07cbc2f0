// SPDX-License-Identifier: Apache-2.0
// Q104: a payload member is read after a trace, but some shader that the trace can run does not write it. Q105: a
// nested trace with the incoming payload overwrites a member that is read afterwards.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "check/rules/rules.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

using spv::StorageClass;

class MemberRule {
 public:
  MemberRule(const CheckInput& input, Report& report) : input_(input), graph_(input.graph), report_(report) {}

  void check(const TraceSite& site) {
    const spirv::StageFacts& tracer = graph_.facts(site);
    const spirv::SharedVariable* payload = tracer.variable(site.trace->payload);
    if (!payload || hasWrongQualifier(site)) return;
    reportHitsWithoutResult(site, *payload);
    for (std::uint32_t member = 0; member < tracer.memberCount(payload->id); ++member) {
      const std::string name = memberText(tracer, *payload, member);
      const std::vector<std::size_t> all = tracer.readsAfter(*site.trace, member);
      if (all.empty()) continue;
      if (!writtenBefore(site, *payload, member))
        reportUnwritten(site, member, name);
      else
        reportConstant(site, *payload, member, name, all);
      if (payload->storage == StorageClass::IncomingRayPayloadKHR) reportOverwritten(site, *payload, member, name, all);
    }
  }

 private:
  static std::string memberText(const spirv::StageFacts& tracer, const spirv::SharedVariable& payload,
                                std::uint32_t member) {
    const spirv::Type& type = tracer.module().types().get(payload.type);
    if (type.kind != spirv::Type::Kind::structure) return fmt::format("'{}'", payload.name);
    return fmt::format("'{}.{}'", payload.name,
                       type.memberNames[member].empty() ? fmt::format("member {}", member) : type.memberNames[member]);
  }

  // Q103 reports these stages: they do not access the payload at all.
  bool hasWrongQualifier(const TraceSite& site) const {
    return std::ranges::any_of(site.edges, [&](const Edge& edge) {
      const spirv::StageFacts& facts = graph_.facts(edge);
      return edge.role != Role::intersection && !facts.incoming(StorageClass::IncomingRayPayloadKHR) &&
             std::ranges::any_of(facts.variables(), [&](const auto& v) {
               return v.storage == StorageClass::RayPayloadKHR && v.used &&
                      std::ranges::none_of(facts.traces(), [&](const auto& t) { return t.payload == v.id; });
             });
    });
  }

  // Written by the tracing stage, or, for an incoming payload, by the stage that traced the incoming ray.
  bool writtenBefore(const TraceSite& site, const spirv::SharedVariable& payload, std::uint32_t member) const {
    if (graph_.facts(site).writtenBefore(payload.id, member, site.trace->instruction)) return true;
    if (payload.storage != StorageClass::IncomingRayPayloadKHR) return false;
    return std::ranges::any_of(graph_.traces, [&](const TraceSite& other) {
      const bool reaches = std::ranges::any_of(
          other.edges, [&](const Edge& e) { return e.stage == site.stage && e.role != Role::intersection; });
      const auto& accesses = graph_.facts(other).accesses();
      return reaches && std::ranges::any_of(accesses, [&](const auto& a) {
               return a.writes && a.variable == other.trace->payload &&
                      (a.member == member || a.member == spirv::kWholeValue);
             });
    });
  }

  bool writes(const Edge& edge, std::uint32_t member, bool always) const {
    const spirv::StageFacts& facts = graph_.facts(edge);
    const spirv::SharedVariable* payload = facts.incoming(StorageClass::IncomingRayPayloadKHR);
    return payload && (always ? facts.writesAlways(payload->id, member) : facts.writes(payload->id, member));
  }

  bool anyHitWrites(const TraceSite& site, HitGroupRay hit, std::uint32_t member) const {
    return std::ranges::any_of(site.edges, [&](const Edge& edge) {
      return edge.role == Role::anyHit && edge.hit.group == hit.group && edge.hit.ray == hit.ray &&
             writes(edge, member, false);
    });
  }

  // Descriptions of shaders and hits that can end the trace without writing the member, up to 3.
  std::vector<std::string> nonWriters(const TraceSite& site, std::uint32_t member) const {
    std::vector<std::string> result;
    for (const Edge& edge : site.edges) {
      if (edge.role != Role::miss && edge.role != Role::closestHit) continue;
      if (writes(edge, member, true) || (edge.role == Role::closestHit && anyHitWrites(site, edge.hit, member)))
        continue;
      result.push_back(
          fmt::format("the {}{}", graph_.describe(edge), writes(edge, member, false) ? ", on some path," : ""));
    }
    for (const HitGroupRay hit : site.hits) {
      if (anyHitWrites(site, hit, member)) continue;
      if (site.skipsClosestHit()) {
        result.push_back("a hit (closest-hit shaders are skipped)");
        break;
      }
      if (graph_.shaders(hit).closestHit.empty())
        result.push_back(fmt::format("a hit without a closest-hit shader ({})", graph_.describe(hit)));
    }
    if (graph_.program.hitGroups.empty()) result.push_back("a hit (the program has no hit groups)");
    constexpr std::size_t kMaxNamed = 3;
    if (result.size() > kMaxNamed) result.resize(kMaxNamed);
    return result;
  }

  // Reports closest-hit shaders that write none of the members that are read afterwards and have no other effect.
  void reportHitsWithoutResult(const TraceSite& site, const spirv::SharedVariable& payload) {
    const spirv::StageFacts& tracer = graph_.facts(site);
    std::vector<std::uint32_t> read;
    for (std::uint32_t member = 0; member < tracer.memberCount(payload.id); ++member)
      if (!tracer.readsAfter(*site.trace, member).empty()) read.push_back(member);
    if (read.empty() || input_.featureDefines) return;
    for (const Edge& edge : site.edges) {
      const auto written = [&](std::uint32_t member) {
        return writes(edge, member, false) || anyHitWrites(site, edge.hit, member);
      };
      if (edge.role != Role::closestHit || !edge.exact || std::ranges::any_of(read, written) ||
          hasEffects(graph_.facts(edge)))
        continue;
      report_.add("Q104", graph_.location(site),
                  fmt::format("the payload is read after this trace, but the {} writes none of the members that are "
                              "read, so its hits have no effect",
                              graph_.describe(edge)));
    }
  }

  // Writes memory or images, traces or calls.
  static bool hasEffects(const spirv::StageFacts& facts) {
    if (!facts.traces().empty() || !facts.calls().empty()) return true;
    const spirv::Module& module = facts.module();
    return std::ranges::any_of(module.instructions(), [&](const spirv::Instruction& i) {
      if (i.op >= spv::Op::OpAtomicStore && i.op <= spv::Op::OpAtomicXor) return true;
      if (i.op == spv::Op::OpImageWrite || i.op == spv::Op::OpFunctionCall) return true;
      if (i.op != spv::Op::OpStore) return false;
      const spirv::Id variable = module.access(i.at(0)).variable;
      const spirv::Instruction* definition = module.definition(variable);
      const auto storage = definition && definition->op == spv::Op::OpVariable
                               ? static_cast<spv::StorageClass>(definition->at(0))
                               : spv::StorageClass::Max;
      return storage != spv::StorageClass::Function && storage != spv::StorageClass::Private &&
             !facts.variable(variable);
    });
  }

  // Where the member is read, and the shaders that end the trace without writing it.
  std::vector<RelatedLocation> relatedOf(const TraceSite& site, std::uint32_t member, std::size_t access) const {
    const spirv::StageFacts& tracer = graph_.facts(site);
    const spirv::Module& module = tracer.module();
    const SourceLocation read = module.location(module.instructions()[tracer.accesses()[access].instruction]);
    std::vector<RelatedLocation> result{relatedTo(graph_.location(graph_.stages[site.stage], read), "read here")};
    for (const Edge& edge : site.edges) {
      const bool ends = edge.role == Role::miss || edge.role == Role::closestHit;
      const spirv::SharedVariable* received = graph_.facts(edge).incoming(StorageClass::IncomingRayPayloadKHR);
      if (ends && received && result.size() < 4 && !writes(edge, member, true))
        result.push_back(relatedTo(graph_.declarationOf(graph_.stages[edge.stage], *received),
                                   fmt::format("not written by the {}", graph_.describe(edge))));
    }
    return result;
  }

  void reportUnwritten(const TraceSite& site, std::uint32_t member, const std::string& name) {
    const spirv::StageFacts& tracer = graph_.facts(site);
    const std::vector<std::size_t> reads = tracer.unguardedReads(*site.trace, member);
    if (reads.empty()) return;
    const std::vector<std::string> missing = nonWriters(site, member);
    if (missing.empty()) return;
    report_.add("Q104", graph_.location(site),
                fmt::format("{} is read after this trace{}, but {} {} not write it, and it is not set before the trace",
                            name, lineText(tracer, reads.front(), site), fmt::join(missing, " and "),
                            missing.size() == 1 ? "does" : "do"),
                relatedOf(site, member, reads.front()));
  }

  // Reports a member that has the same constant after the trace on all paths.
  void reportConstant(const TraceSite& site, const spirv::SharedVariable& payload, std::uint32_t member,
                      const std::string& name, const std::vector<std::size_t>& reads) {
    const spirv::StageFacts& tracer = graph_.facts(site);
    if (payload.storage != StorageClass::RayPayloadKHR) return;
    std::set<std::string> constants;
    bool known = addConstants(tracer, payload.id, member, constants);
    std::size_t callees = 0, writers = 0;
    for (const Edge& edge : site.edges) {
      if (edge.role == Role::intersection) continue;
      const spirv::SharedVariable* received = graph_.facts(edge).incoming(StorageClass::IncomingRayPayloadKHR);
      known = known && edge.exact && (!received || addConstants(graph_.facts(edge), received->id, member, constants));
      ++callees;
      writers += writes(edge, member, false) ? 1 : 0;
    }
    if (!known || callees == 0 || constants.size() != 1) return;
    report_.add("Q104", graph_.location(site),
                fmt::format("{} is read after this trace{}, but {}", name, lineText(tracer, reads.front(), site),
                            writers == 0 ? "no shader that the trace can run writes it, so it keeps its constant value"
                                         : "all shaders that the trace can run write the same constant that it had "
                                           "before, so its value does not depend on the trace"));
  }

  // Adds the values that the stage writes to the member. Returns false if one of them is not constant.
  static bool addConstants(const spirv::StageFacts& facts, spirv::Id payload, std::uint32_t member,
                           std::set<std::string>& constants) {
    for (const spirv::AccessFacts& a : facts.accesses()) {
      if (!a.writes || a.variable != payload || (a.member != member && a.member != spirv::kWholeValue)) continue;
      const spirv::Id value = storedValue(facts, a);
      if (!facts.module().isConstant(value)) return false;
      constants.insert(
          constantText(facts.module(), value, a.member == spirv::kWholeValue ? member : spirv::kWholeValue));
    }
    return true;
  }

  // The value that a store writes to the member, or to the whole payload; 0 if unknown.
  static spirv::Id storedValue(const spirv::StageFacts& facts, const spirv::AccessFacts& access) {
    const spirv::Instruction& store = facts.module().instructions()[access.instruction];
    if (store.op != spv::Op::OpStore) return 0;
    const spirv::Instruction* value = facts.module().definition(store.at(1));
    const bool made = value && value->op == spv::Op::OpCompositeConstruct && access.member < value->operands.size();
    return made && facts.module().access(store.at(0)).indices.empty() ? value->at(access.member) : store.at(1);
  }

  // A text that is equal for equal constants of all modules. `part` selects a part of a composite.
  static std::string constantText(const spirv::Module& module, spirv::Id id, std::uint32_t part, int depth = 0) {
    const spirv::Instruction* value = module.definition(id);
    if (!value || depth > 8) return "?";
    if (value->op == spv::Op::OpConstantComposite) {
      if (part < value->operands.size()) return constantText(module, value->at(part), spirv::kWholeValue, depth + 1);
      std::string text = "(";
      for (const spirv::Id element : value->operands)
        text += constantText(module, element, spirv::kWholeValue, depth + 1) + " ";
      return text + ")";
    }
    return fmt::format("{} {}", static_cast<int>(value->op), fmt::join(value->operands, " "));
  }

  void reportOverwritten(const TraceSite& site, const spirv::SharedVariable& payload, std::uint32_t member,
                         const std::string& name, const std::vector<std::size_t>& reads) {
    const spirv::StageFacts& tracer = graph_.facts(site);
    const Edge* writer = nullptr;
    for (const Edge& edge : site.edges) {
      const spirv::SharedVariable* received = graph_.facts(edge).incoming(StorageClass::IncomingRayPayloadKHR);
      if (edge.role == Role::intersection || !received) continue;
      if (graph_.facts(edge).readsBeforeWriting(received->id, member)) return;  // input of the inner ray
      if (!writer && graph_.facts(edge).writes(received->id, member)) writer = &edge;
    }
    if (!writer) return;
    for (const spirv::AccessFacts& a : tracer.accesses()) {
      const bool overwritten = a.writes && a.variable == payload.id &&
                               (a.member == member || a.member == spirv::kWholeValue) &&
                               !tracer.module().isConstant(storedValue(tracer, a)) &&
                               spirv::canRunAfter(tracer.module(), site.trace->instruction, a.instruction);
      if (!overwritten) continue;
      const SourceLocation written = tracer.module().location(tracer.module().instructions()[a.instruction]);
      report_.add("Q105", graph_.location(site),
                  fmt::format("this trace uses the incoming payload: {}, written in line {}, is overwritten by the {} "
                              "before it is read{}",
                              name, written.line, graph_.describe(*writer), lineText(tracer, reads.front(), site)),
                  {relatedTo(written, "written here"), relatedOf(site, member, reads.front()).front()});
      return;
    }
  }

  // " (line 12)", or " (file:12)" if the access is in a different file than the trace.
  std::string lineText(const spirv::StageFacts& tracer, std::size_t access, const TraceSite& site) const {
    const SourceLocation location =
        tracer.module().location(tracer.module().instructions()[tracer.accesses()[access].instruction]);
    if (location.line == 0) return {};
    return location.file == site.trace->location.file ? fmt::format(" (line {})", location.line)
                                                      : fmt::format(" ({}:{})", location.file, location.line);
  }

  const CheckInput& input_;
  const PipelineGraph& graph_;
  Report& report_;
};

}  // namespace

void checkPayloadMembers(const CheckInput& input, Report& report) {
  MemberRule rule(input, report);
  for (const TraceSite& site : input.graph.traces) rule.check(site);
}

}  // namespace quintet::check
