// Q104: a member is read after a trace, but not everything that the trace runs writes it. Q105: a nested trace with
// the incoming payload overwrites what is read afterwards.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "program/check_parts.h"
#include "shader/spirv_flow.h"

namespace quintet::program {
namespace {

using shader::StageFacts;
using spv::StorageClass;

class Members {
 public:
  Members(const CheckInput& input, Report& report) : input_(input), model_(input.model), report_(report) {}

  void check(const TraceSite& site) {
    const StageFacts& tracer = factsOf(site.stage);
    const shader::SharedVariable* payload = tracer.variable(site.trace->payload);
    if (!payload || hasWrongQualifier(site)) return;
    reportSilentHits(site, *payload);
    for (std::uint32_t member = 0; member < tracer.memberCount(payload->id); ++member) {
      const std::string name = memberText(tracer, *payload, member);
      const std::vector<std::size_t> all = tracer.readsAfter(*site.trace, member);
      if (all.empty()) continue;
      if (!writtenBefore(site, *payload, member))
        reportUnwritten(site, member, name);
      else
        reportStale(site, *payload, member, name, all);
      if (payload->storage == StorageClass::IncomingRayPayloadKHR) reportOverwritten(site, *payload, member, name, all);
    }
  }

 private:
  const StageFacts& factsOf(std::size_t stage) const { return *model_.stages[stage].facts; }

  static std::string memberText(const StageFacts& tracer, const shader::SharedVariable& payload, std::uint32_t member) {
    const shader::SpirvType& type = tracer.module().types().get(payload.type);
    if (type.kind != shader::SpirvType::Kind::structure) return fmt::format("'{}'", payload.name);
    return fmt::format("'{}.{}'", payload.name,
                       type.memberNames[member].empty() ? fmt::format("member {}", member) : type.memberNames[member]);
  }

  // Q103 says more: such a stage does not see the payload at all.
  bool hasWrongQualifier(const TraceSite& site) const {
    return std::ranges::any_of(site.edges, [&](const Edge& edge) {
      const StageFacts& facts = factsOf(edge.stage);
      return edge.role != Role::intersection && !facts.incoming(StorageClass::IncomingRayPayloadKHR) &&
             std::ranges::any_of(facts.variables(), [&](const auto& v) {
               return v.storage == StorageClass::RayPayloadKHR && v.used &&
                      std::ranges::none_of(facts.traces(), [&](const auto& t) { return t.payload == v.id; });
             });
    });
  }

  // By the tracer, or, for the payload that it got, by whoever traced before.
  bool writtenBefore(const TraceSite& site, const shader::SharedVariable& payload, std::uint32_t member) const {
    if (factsOf(site.stage).writtenBefore(payload.id, member, site.trace->instruction)) return true;
    if (payload.storage != StorageClass::IncomingRayPayloadKHR) return false;
    return std::ranges::any_of(model_.traces, [&](const TraceSite& other) {
      const bool reaches = std::ranges::any_of(
          other.edges, [&](const Edge& e) { return e.stage == site.stage && e.role != Role::intersection; });
      const auto& accesses = factsOf(other.stage).accesses();
      return reaches && std::ranges::any_of(accesses, [&](const auto& a) {
               return a.writes && a.variable == other.trace->payload &&
                      (a.member == member || a.member == shader::kWholeValue);
             });
    });
  }

  bool writes(const Edge& edge, std::uint32_t member, bool always) const {
    const StageFacts& facts = factsOf(edge.stage);
    const shader::SharedVariable* payload = facts.incoming(StorageClass::IncomingRayPayloadKHR);
    return payload && (always ? facts.writesAlways(payload->id, member) : facts.writes(payload->id, member));
  }

  bool anyHitWrites(const TraceSite& site, HitRow row, std::uint32_t member) const {
    return std::ranges::any_of(site.edges, [&](const Edge& edge) {
      return edge.role == Role::anyHit && edge.row.group == row.group && edge.row.ray == row.ray &&
             writes(edge, member, false);
    });
  }

  // What can end the trace without a write of the member, in words.
  std::vector<std::string> silent(const TraceSite& site, std::uint32_t member) const {
    std::vector<std::string> who;
    for (const Edge& edge : site.edges) {
      if (edge.role != Role::miss && edge.role != Role::closestHit) continue;
      if (writes(edge, member, true) || (edge.role == Role::closestHit && anyHitWrites(site, edge.row, member)))
        continue;
      who.push_back(
          fmt::format("the {}{}", model_.describe(edge), writes(edge, member, false) ? ", on some path," : ""));
    }
    for (const HitRow row : site.hits) {
      if (anyHitWrites(site, row, member)) continue;
      if (site.skipsClosestHit()) {
        who.push_back("a hit (closest-hit shaders are skipped)");
        break;
      }
      if (model_.shaders(row).closestHit.empty())
        who.push_back(fmt::format("a hit without closest-hit shader ({})", model_.describe(row)));
    }
    if (model_.program.hitGroups.empty()) who.push_back("a hit (the program has no hit groups)");
    constexpr std::size_t kMaxNamed = 3;
    if (who.size() > kMaxNamed) who.resize(kMaxNamed);
    return who;
  }

  // A closest-hit shader that writes nothing of what is read afterwards, and does nothing else that anybody could see.
  void reportSilentHits(const TraceSite& site, const shader::SharedVariable& payload) {
    const StageFacts& tracer = factsOf(site.stage);
    std::vector<std::uint32_t> read;
    for (std::uint32_t member = 0; member < tracer.memberCount(payload.id); ++member)
      if (!tracer.readsAfter(*site.trace, member).empty()) read.push_back(member);
    if (read.empty() || input_.featureDefines) return;
    for (const Edge& edge : site.edges) {
      const auto written = [&](std::uint32_t member) {
        return writes(edge, member, false) || anyHitWrites(site, edge.row, member);
      };
      if (edge.role != Role::closestHit || !edge.exact || std::ranges::any_of(read, written) ||
          hasEffects(factsOf(edge.stage)))
        continue;
      report_.add(
          "Q104", placeOf(site),
          fmt::format(
              "the payload is read after this trace, but the {} writes nothing that is read: its hits leave no trace",
              model_.describe(edge)));
    }
  }

  // Writes to memory or pictures, traces or calls.
  static bool hasEffects(const StageFacts& facts) {
    if (!facts.traces().empty() || !facts.calls().empty()) return true;
    const shader::SpirvModule& module = facts.module();
    return std::ranges::any_of(module.instructions(), [&](const shader::SpirvInstruction& i) {
      if (i.op >= spv::Op::OpAtomicStore && i.op <= spv::Op::OpAtomicXor) return true;
      if (i.op == spv::Op::OpImageWrite || i.op == spv::Op::OpFunctionCall) return true;
      if (i.op != spv::Op::OpStore) return false;
      const shader::SpirvId variable = module.access(i.at(0)).variable;
      const shader::SpirvInstruction* definition = module.definition(variable);
      const auto storage = definition && definition->op == spv::Op::OpVariable
                               ? static_cast<spv::StorageClass>(definition->at(0))
                               : spv::StorageClass::Max;
      return storage != spv::StorageClass::Function && storage != spv::StorageClass::Private &&
             !facts.variable(variable);
    });
  }

  void reportUnwritten(const TraceSite& site, std::uint32_t member, const std::string& name) {
    const StageFacts& tracer = factsOf(site.stage);
    const std::vector<std::size_t> reads = tracer.unguardedReads(*site.trace, member);
    if (reads.empty()) return;
    const std::vector<std::string> who = silent(site, member);
    if (who.empty()) return;
    report_.add(
        "Q104", placeOf(site),
        fmt::format("{} is read after this trace{}, but {} does not write it, and it was not set before the trace",
                    name, lineText(tracer, reads.front(), site), fmt::join(who, " and ")));
  }

  // Everything that anybody writes there is one constant: the trace tells nothing.
  void reportStale(const TraceSite& site, const shader::SharedVariable& payload, std::uint32_t member,
                   const std::string& name, const std::vector<std::size_t>& reads) {
    const StageFacts& tracer = factsOf(site.stage);
    if (payload.storage != StorageClass::RayPayloadKHR) return;
    std::set<std::string> constants;
    bool known = addConstants(tracer, payload.id, member, constants);
    std::size_t callees = 0, writers = 0;
    for (const Edge& edge : site.edges) {
      if (edge.role == Role::intersection) continue;
      const shader::SharedVariable* received = factsOf(edge.stage).incoming(StorageClass::IncomingRayPayloadKHR);
      known = known && edge.exact && (!received || addConstants(factsOf(edge.stage), received->id, member, constants));
      ++callees;
      writers += writes(edge, member, false) ? 1 : 0;
    }
    if (!known || callees == 0 || constants.size() != 1) return;
    report_.add(
        "Q104", placeOf(site),
        fmt::format("{} is read after this trace{}, but {}", name, lineText(tracer, reads.front(), site),
                    writers == 0
                        ? "no shader that the trace can run writes it: it still has the constant that was set before"
                        : "all that the trace can run writes the constant that was set before: it tells nothing"));
  }

  // Adds what the stage writes there; false if one of its writes is no constant.
  static bool addConstants(const StageFacts& facts, shader::SpirvId payload, std::uint32_t member,
                           std::set<std::string>& constants) {
    for (const shader::AccessFacts& a : facts.accesses()) {
      if (!a.writes || a.variable != payload || (a.member != member && a.member != shader::kWholeValue)) continue;
      const shader::SpirvId value = storedValue(facts, a);
      if (!facts.module().isConstant(value)) return false;
      constants.insert(
          constantText(facts.module(), value, a.member == shader::kWholeValue ? member : shader::kWholeValue));
    }
    return true;
  }

  // What a store puts into the member, or into all of them; 0: unknown.
  static shader::SpirvId storedValue(const StageFacts& facts, const shader::AccessFacts& access) {
    const shader::SpirvInstruction& store = facts.module().instructions()[access.instruction];
    if (store.op != spv::Op::OpStore) return 0;
    const shader::SpirvInstruction* value = facts.module().definition(store.at(1));
    const bool made = value && value->op == spv::Op::OpCompositeConstruct && access.member < value->operands.size();
    return made && facts.module().access(store.at(0)).indices.empty() ? value->at(access.member) : store.at(1);
  }

  // The words of a constant, the same for the same value in any module; of one of its parts, if `part` is given.
  static std::string constantText(const shader::SpirvModule& module, shader::SpirvId id, std::uint32_t part,
                                  int depth = 0) {
    const shader::SpirvInstruction* value = module.definition(id);
    if (!value || depth > 8) return "?";
    if (value->op == spv::Op::OpConstantComposite) {
      if (part < value->operands.size()) return constantText(module, value->at(part), shader::kWholeValue, depth + 1);
      std::string text = "(";
      for (const shader::SpirvId element : value->operands)
        text += constantText(module, element, shader::kWholeValue, depth + 1) + " ";
      return text + ")";
    }
    return fmt::format("{} {}", static_cast<int>(value->op), fmt::join(value->operands, " "));
  }

  void reportOverwritten(const TraceSite& site, const shader::SharedVariable& payload, std::uint32_t member,
                         const std::string& name, const std::vector<std::size_t>& reads) {
    const StageFacts& tracer = factsOf(site.stage);
    const Edge* writer = nullptr;
    for (const Edge& edge : site.edges) {
      const shader::SharedVariable* received = factsOf(edge.stage).incoming(StorageClass::IncomingRayPayloadKHR);
      if (edge.role == Role::intersection || !received) continue;
      if (factsOf(edge.stage).takes(received->id, member)) return;  // what was written is an input of the inner ray
      if (!writer && factsOf(edge.stage).writes(received->id, member)) writer = &edge;
    }
    if (!writer) return;
    for (const shader::AccessFacts& a : tracer.accesses()) {
      const bool lost = a.writes && a.variable == payload.id &&
                        (a.member == member || a.member == shader::kWholeValue) &&
                        !tracer.module().isConstant(storedValue(tracer, a)) &&
                        shader::mayRunAfter(tracer.module(), site.trace->instruction, a.instruction);
      if (!lost) continue;
      const shader::Place written = tracer.module().place(tracer.module().instructions()[a.instruction]);
      report_.add("Q105", placeOf(site),
                  fmt::format("this trace uses the incoming payload: {}, written at line {}, is overwritten by the {} "
                              "before it is read{}",
                              name, written.line, model_.describe(*writer), lineText(tracer, reads.front(), site)));
      return;
    }
  }

  shader::Place placeOf(const TraceSite& site) const { return model_.at(model_.stages[site.stage], site.trace->place); }

  // " (line 12)" of a read.
  std::string lineText(const StageFacts& tracer, std::size_t access, const TraceSite& site) const {
    const shader::Place place =
        tracer.module().place(tracer.module().instructions()[tracer.accesses()[access].instruction]);
    if (place.line == 0) return {};
    return place.file == site.trace->place.file ? fmt::format(" (line {})", place.line)
                                                : fmt::format(" ({}:{})", place.file, place.line);
  }

  const CheckInput& input_;
  const LinkModel& model_;
  Report& report_;
};

}  // namespace

void checkPayloadMembers(const CheckInput& input, Report& report) {
  Members members(input, report);
  for (const TraceSite& site : input.model.traces) members.check(site);
}

}  // namespace quintet::program
