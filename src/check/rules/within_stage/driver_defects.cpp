// SPDX-License-Identifier: Apache-2.0
// Q901, Q902, Q904, Q905: valid code that drivers or the optimizer execute incorrectly (docs/design/quirks.md).
#include <algorithm>

#include "check/library_names.h"
#include "check/rules/rules.h"
#include "spirv/control_flow.h"
#include "spirv/copy_builtins.h"
#include "spirv/source_text.h"

namespace quintet::check {
namespace {

using spv::Op;

std::vector<std::size_t> all(const spirv::Module& module, Op op) {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < module.instructions().size(); ++i)
    if (module.instructions()[i].op == op) result.push_back(i);
  return result;
}

bool runsAfterAny(const spirv::Module& module, std::size_t i, const std::vector<std::size_t>& earlier) {
  return std::ranges::any_of(earlier, [&](std::size_t e) { return spirv::canRunAfter(module, i, e); });
}

// True if control can reach `target` from the start of the function without the edge from `branch` to `successor`.
bool reachableWithout(const spirv::Function& function, std::size_t target, std::size_t branch, std::size_t successor) {
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

// True if a comparison with gl_RayTmaxEXT decides whether the instruction runs.
bool guardedByTmax(const spirv::Module& module, std::size_t instruction) {
  const auto at = module.position(instruction);
  if (!at) return false;
  const spirv::Function& function = module.functions()[at->function];
  const spirv::ControlFlow flow(module, at->function);
  for (std::size_t b = 0; b < function.blocks.size(); ++b) {
    const spirv::Instruction& branch = module.instructions()[function.blocks[b].end - 1];
    if (branch.op != Op::OpBranchConditional) continue;
    // Includes control dependence: `if (candidate < gl_RayTmaxEXT) t = candidate;` before `if (t == never) return`.
    const bool tmax = spirv::dependsOnDataOrControl(module, flow, branch.at(0), [&](const spirv::Instruction& i) {
      return spirv::loadsBuiltIn(module, i, spv::BuiltIn::RayTmaxKHR);
    });
    if (!tmax) continue;
    for (const std::size_t successor : function.blocks[b].successors)
      if (!reachableWithout(function, at->block, b, successor)) return true;
  }
  return false;
}

// True for an access to a local array with a computed index.
bool indexesLocalArray(const spirv::Module& module, const spirv::Instruction& chain) {
  if (chain.op != Op::OpAccessChain && chain.op != Op::OpInBoundsAccessChain) return false;
  const spirv::Access access = module.access(chain.result);
  return spirv::isLocal(module, access.variable) &&
         std::ranges::any_of(access.indices, [](const auto& index) { return !index.has_value(); });
}

}  // namespace

void checkNestedBuiltIns(const spirv::Module& module, Report& report) {
  const std::vector<std::size_t> traces = all(module, Op::OpTraceRayKHR);
  for (const std::size_t load : all(module, Op::OpLoad)) {
    const spirv::Instruction& instruction = module.instructions()[load];
    const auto builtIn = spirv::loadedBuiltIn(module, instruction);
    if (!builtIn || !spirv::isOverwrittenByTrace(*builtIn) || !runsAfterAny(module, load, traces)) continue;
    if (spirv::canCopyBuiltIn(module, load)) continue;  // the linked program copies it
    const std::string name(spirv::glslName(*builtIn));
    report.addOncePerLine(
        "Q901", module.location(instruction, name),
        name + " is read after a nested trace; on this device it then has the value of the inner hit");
  }
}

void checkAttributeWrites(const spirv::Module& module, Report& report) {
  const std::vector<std::size_t> reports = all(module, Op::OpReportIntersectionKHR);
  for (const std::size_t store : all(module, Op::OpStore)) {
    const spirv::Instruction& instruction = module.instructions()[store];
    const spirv::Variable* variable = module.variable(module.access(instruction.at(0)).variable);
    if (!variable || variable->storage != spv::StorageClass::HitAttributeKHR) continue;
    if (variable->name == kLectureAttribute) continue;  // reportIntersectionEXT works around the defect
    const bool reported =
        std::ranges::any_of(reports, [&](std::size_t r) { return spirv::canRunAfter(module, r, store); });
    if (!reported || guardedByTmax(module, store)) continue;
    report.addOncePerLine("Q902", module.location(instruction, variable->name),
                          "hit attribute '" + variable->name +
                              "' is written before t is compared with gl_RayTmaxEXT; on this device a rejected report "
                              "overwrites the attributes of the accepted hit");
  }
}

// On all devices: spirv-opt merges loads of gl_RayTmaxEXT across reports, although the variable is Volatile, so a read
// after a report sees the old value. The rule looks at uses of a loaded value in lines that name the built-in. A value
// that was copied to a local variable on purpose is used in lines that do not.
void checkRayTmaxReads(const spirv::Module& module, Report& report) {
  const std::vector<std::size_t> reports = all(module, Op::OpReportIntersectionKHR);
  for (const std::size_t load : all(module, Op::OpLoad)) {
    if (!spirv::loadsBuiltIn(module, module.instructions()[load], spv::BuiltIn::RayTmaxKHR)) continue;
    std::vector<std::size_t> reads = module.users(module.instructions()[load].result);
    reads.push_back(load);
    for (const std::size_t read : reads) {
      const spirv::Instruction& use = module.instructions()[read];
      const SourceLocation location = module.location(use);
      const bool named =
          spirv::lineOf(module.source(location.file), location.line).find("gl_RayTmaxEXT") != std::string_view::npos;
      if (!named || !runsAfterAny(module, read, reports)) continue;
      report.addOncePerLine("Q904", module.location(use, "gl_RayTmaxEXT"),
                            "gl_RayTmaxEXT is read after a report of the same invocation, where it can still have its "
                            "value from before the report");
    }
  }
}

// One diagnostic per stage, since the fix is the same for all arrays.
void checkLocalArrays(const spirv::Module& module, Report& report) {
  const spirv::Instruction* found = nullptr;
  for (const spirv::Instruction& chain : module.instructions()) {
    if (!indexesLocalArray(module, chain)) continue;
    // The optimizer creates access chains without a line; those with one are preferred.
    if (!found || (found->line == 0 && chain.line > 0)) found = &chain;
  }
  if (!found) return;
  const std::string name = module.name(module.access(found->result).variable);
  report.addOncePerLine(
      "Q905", module.location(*found, name),
      (name.empty() ? std::string("a local array") : "local array '" + name + "'") +
          " has a dynamic index, and the hit group has an any-hit shader; on this device both shaders "
          "use the same memory");
}

}  // namespace quintet::check
