// Joins the rules of check_shader.h to the linked program: each stage with its situation, hit positions that travel in
// a payload (Q705), and intersection shaders that several hit groups share (Q903).
#include <fmt/format.h>

#include <algorithm>

#include "base/parallel.h"
#include "program/check_parts.h"
#include "program/check_shader_rules.h"

namespace quintet::program {
namespace {

bool hasAnyHit(const LinkModel& model, const std::string& intersection) {
  return std::ranges::any_of(model.program.hitGroups, [&](const HitGroup& group) {
    return std::ranges::any_of(group.shaders, [&](const auto& entry) {
      return entry.second.intersection == intersection && !entry.second.anyHit.empty();
    });
  });
}

// The lecture form compiles a closest-hit source twice, and in the variant for triangles `hit` is zero: an origin that
// is moved along hit.normal then seems not to be moved at all. Q705 counts there only if the variant for boxes has it.
void dropZeroAttributes(const LinkModel& model, std::vector<std::vector<shader::Diagnostic>>& found) {
  constexpr std::string_view kTriangles = ".triangles.rchit", kBoxes = ".boxes.rchit";
  for (std::size_t i = 0; i < found.size(); ++i) {
    std::string file = model.stages[i].file;
    if (!file.ends_with(kTriangles)) continue;
    file.replace(file.size() - kTriangles.size(), kTriangles.size(), kBoxes);
    const auto boxes = std::ranges::find(model.stages, file, &LinkStage::file);
    if (boxes == model.stages.end() || !boxes->facts) continue;
    const auto& twin = found[static_cast<std::size_t>(boxes - model.stages.begin())];
    std::erase_if(found[i], [&](const shader::Diagnostic& d) {
      return d.id == "Q705" &&
             std::ranges::none_of(twin, [&](const shader::Diagnostic& t) { return t.id == d.id && t.line == d.line; });
    });
  }
}

void checkEachStage(const CheckInput& input, Report& report) {
  const LinkModel& model = input.model;
  std::vector<std::vector<shader::Diagnostic>> found(model.stages.size());
  parallelFor(model.stages.size(), [&](std::size_t i) {
    const LinkStage& stage = model.stages[i];
    if (!stage.facts) return;
    const ShaderSituation situation{model.program.keepsInstanceOrder, hasAnyHit(model, stage.file),
                                    input.limits.quirks};
    found[i] = checkShader(stage.facts->module(), situation);
  });
  dropZeroAttributes(model, found);
  for (std::size_t i = 0; i < found.size(); ++i)
    for (shader::Diagnostic& d : found[i])
      report.add(d.id, model.at(model.stages[i], {d.file, d.line, d.column}), std::move(d.text));
}

// The next ray starts at a member of the payload of the last one, and a closest-hit shader writes the hit position
// there as it is.
void checkPayloadOrigins(const CheckInput& input, Report& report) {
  const LinkModel& model = input.model;
  for (std::size_t s = 0; s < model.stages.size(); ++s) {
    if (!model.stages[s].facts) continue;
    const shader::SpirvModule& module = model.stages[s].facts->module();
    for (const PayloadOrigin& origin : payloadOrigins(module)) {
      for (const TraceSite& site : model.traces) {
        if (site.stage != s || site.trace->payload != origin.payload) continue;
        for (const Edge& edge : site.edges) {
          if (edge.role != Role::closestHit) continue;
          const shader::SpirvModule& hit = model.stages[edge.stage].facts->module();
          if (!storesHitPosition(hit, origin.member)) continue;
          report.add("Q705",
                     model.at(model.stages[s], module.place(module.instructions()[origin.trace], "traceRayEXT")),
                     fmt::format("the ray starts with tmin 0 at the hit position that the {} puts into the payload: by "
                                 "rounding it can hit the surface that it leaves",
                                 model.describe(edge)));
        }
      }
    }
  }
}

void checkSharedIntersections(const CheckInput& input, Report& report) {
  struct Use {
    const HitGroup* group;
    const HitShaders* shaders;
  };
  std::map<std::string, Use> first;
  const LinkModel& model = input.model;
  for (const HitGroup& group : model.program.hitGroups) {
    for (const auto& [ray, shaders] : group.shaders) {
      if (shaders.intersection.empty() || shaders.anyHit.empty() || isLibraryStage(shaders.intersection)) continue;
      const auto [known, isNew] = first.try_emplace(shaders.intersection, Use{&group, &shaders});
      if (isNew || known->second.shaders->anyHit == shaders.anyHit) continue;
      report.add(
          "Q903", model.at(shaders.line > 0 ? shaders.line : group.line),
          fmt::format("'{}' runs with any-hit shader '{}' here and with '{}' in hit group '{}': on this device "
                      "each gets a copy of the stage",
                      shaders.intersection, shaders.anyHit, known->second.shaders->anyHit, known->second.group->name));
    }
  }
}

}  // namespace

void checkStages(const CheckInput& input, Report& report) {
  checkEachStage(input, report);
  checkPayloadOrigins(input, report);
  if (input.limits.quirks.sharesAnyHit) checkSharedIntersections(input, report);
}

}  // namespace quintet::program
