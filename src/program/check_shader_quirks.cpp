// What the specification allows, and drivers or the optimizer get wrong (docs/design/quirks.md): Q901, Q902, Q904,
// Q905.
#include <algorithm>
#include <set>

#include "program/check_shader_rules.h"
#include "shader/control_flow.h"
#include "shader/mend_builtins.h"

namespace quintet::program {

using shader::SpirvFunction;
using shader::SpirvId;
using shader::SpirvInstruction;
using shader::SpirvModule;
using spv::Op;

namespace {

// The lecture form writes it within its own reportIntersectionEXT, which takes care of such devices.
constexpr std::string_view kLectureAttribute = "gsnHitAttribute_";

std::vector<std::size_t> all(const SpirvModule& module, Op op) {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < module.instructions().size(); ++i)
    if (module.instructions()[i].op == op) result.push_back(i);
  return result;
}

bool runsAfterAny(const SpirvModule& module, std::size_t i, const std::vector<std::size_t>& earlier) {
  return std::ranges::any_of(earlier, [&](std::size_t e) { return mayRunAfter(module, i, e); });
}

// Can control reach `target` from the function's start without the edge from `branch` to `successor`?
bool reachableWithout(const SpirvFunction& function, std::size_t target, std::size_t branch, std::size_t successor) {
  std::vector<bool> seen(function.blocks.size(), false);
  std::vector<std::size_t> open{0};
  seen[0] = true;
  while (!open.empty()) {
    const std::size_t block = open.back();
    open.pop_back();
    if (block == target) return true;
    for (const std::size_t next : function.blocks[block].successors) {
      if (seen[next] || (block == branch && next == successor)) continue;
      seen[next] = true;
      open.push_back(next);
    }
  }
  return false;
}

// Does a comparison with gl_RayTmaxEXT decide whether the instruction runs?
bool guardedByTmax(const SpirvModule& module, std::size_t instruction) {
  const auto at = module.position(instruction);
  if (!at) return false;
  const SpirvFunction& function = module.functions()[at->function];
  const shader::ControlFlow flow(module, at->function);
  for (std::size_t b = 0; b < function.blocks.size(); ++b) {
    const SpirvInstruction& branch = module.instructions()[function.blocks[b].end - 1];
    if (branch.op != Op::OpBranchConditional) continue;
    // Also through choices: `t = never; if (candidate < gl_RayTmaxEXT) t = candidate;` before `if (t == never) return`.
    const bool tmax = dependsWithChoices(module, flow, branch.at(0), [&](const SpirvInstruction& i) {
      return loadsBuiltIn(module, i, spv::BuiltIn::RayTmaxKHR);
    });
    if (!tmax) continue;
    for (const std::size_t successor : function.blocks[b].successors)
      if (!reachableWithout(function, at->block, b, successor)) return true;
  }
  return false;
}

// Is it a part of a local array, chosen by an index that is computed?
bool indexesLocalArray(const SpirvModule& module, const SpirvInstruction& chain) {
  if (chain.op != Op::OpAccessChain && chain.op != Op::OpInBoundsAccessChain) return false;
  const shader::SpirvAccess access = module.access(chain.result);
  const SpirvInstruction* variable = module.definition(access.variable);
  if (!variable || variable->op != Op::OpVariable) return false;
  const auto storage = static_cast<spv::StorageClass>(variable->at(0));
  if (storage != spv::StorageClass::Function && storage != spv::StorageClass::Private) return false;
  return std::ranges::any_of(access.indices, [](const auto& index) { return !index.has_value(); });
}

}  // namespace

void checkNestedBuiltIns(const SpirvModule& module, Findings& findings) {
  const std::vector<std::size_t> traces = all(module, Op::OpTraceRayKHR);
  for (const std::size_t load : all(module, Op::OpLoad)) {
    const SpirvInstruction& instruction = module.instructions()[load];
    const auto builtIn = loadedBuiltIn(module, instruction);
    if (!builtIn || !shader::changesInNestedTrace(*builtIn) || !runsAfterAny(module, load, traces)) continue;
    if (shader::canMendLoad(module, load)) continue;
    const std::string name(glslName(*builtIn));
    findings.add("Q901", instruction,
                 name + " is read after a nested trace: on this device it then belongs to the inner hit", name);
  }
}

void checkAttributeWrites(const SpirvModule& module, Findings& findings) {
  const std::vector<std::size_t> reports = all(module, Op::OpReportIntersectionKHR);
  for (const std::size_t store : all(module, Op::OpStore)) {
    const SpirvInstruction& instruction = module.instructions()[store];
    const shader::SpirvVariable* variable = module.variable(module.access(instruction.at(0)).variable);
    if (!variable || variable->storage != spv::StorageClass::HitAttributeKHR) continue;
    if (variable->name == kLectureAttribute) continue;
    const bool reported = std::ranges::any_of(reports, [&](std::size_t r) { return mayRunAfter(module, r, store); });
    if (!reported || guardedByTmax(module, store)) continue;
    findings.add(
        "Q902", instruction,
        "hit attribute '" + variable->name +
            "' is written before t is compared with gl_RayTmaxEXT: on this device a rejected report overwrites "
            "the attributes of the accepted hit",
        variable->name);
  }
}

// On every device: spirv-opt merges loads of gl_RayTmaxEXT across reports (although the variable is Volatile), so a
// read after a report sees the old value. It is the use that counts: an instruction that uses a loaded value, in a line that
// names the built-in. A value that was kept in a local on purpose is used in lines that do not.
void checkRayTmaxReads(const SpirvModule& module, Findings& findings) {
  const std::vector<std::size_t> reports = all(module, Op::OpReportIntersectionKHR);
  for (const std::size_t load : all(module, Op::OpLoad)) {
    if (!loadsBuiltIn(module, module.instructions()[load], spv::BuiltIn::RayTmaxKHR)) continue;
    std::vector<std::size_t> reads = module.users(module.instructions()[load].result);
    reads.push_back(load);
    for (const std::size_t read : reads) {
      const SpirvInstruction& use = module.instructions()[read];
      const shader::Place place = module.place(use);
      const bool named = lineOf(module.source(place.file), place.line).find("gl_RayTmaxEXT") != std::string_view::npos;
      if (!named || !runsAfterAny(module, read, reports)) continue;
      findings.add("Q904", use,
                   "gl_RayTmaxEXT is read after a report of the same invocation, where it may still have the value "
                   "from before it",
                   "gl_RayTmaxEXT");
    }
  }
}

// One message for a stage: the mend is the same for all arrays.
void checkLocalArrays(const SpirvModule& module, Findings& findings) {
  const SpirvInstruction* found = nullptr;
  for (const SpirvInstruction& chain : module.instructions()) {
    if (!indexesLocalArray(module, chain)) continue;
    // The optimizer leaves some chains without a line.
    if (!found || (found->line == 0 && chain.line > 0)) found = &chain;
  }
  if (!found) return;
  const std::string name = module.name(module.access(found->result).variable);
  findings.add("Q905", *found,
               (name.empty() ? std::string("a local array") : "the local array '" + name + "'") +
                   " is indexed by a variable, and an any-hit shader runs for this hit group: on this device they "
                   "share the storage",
               name);
}

}  // namespace quintet::program
