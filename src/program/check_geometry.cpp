// Q601 ... Q604: hit groups and the geometry that they serve.
#include <fmt/format.h>

#include <algorithm>

#include "program/check_parts.h"

namespace quintet::program {
namespace {

bool binds(const HitGroup& group, std::string_view what) {
  return std::ranges::find(group.geometry, what) != group.geometry.end();
}

bool bindsBoxes(const HitGroup& group) {
  return binds(group, "solids") || binds(group, "csg") || binds(group, "custom") || binds(group, "procedural");
}

bool bindsOnly(const HitGroup& group, std::string_view what) {
  return group.geometry.size() == 1 && group.geometry[0] == what && group.material.empty() && group.primitives.empty();
}

// The record that a trace uses for a geometry of an instance.
struct Meeting {
  const TraceSite* site = nullptr;
  const InstanceFacts* instance = nullptr;
  const GeometryFacts* geometry = nullptr;
  HitRow row;
  bool opaque = false;     // for certain: no any-hit shader runs
  bool notOpaque = false;  // for certain
};

class Geometry {
 public:
  Geometry(const CheckInput& input, Report& report) : input_(input), model_(input.model), report_(report) {}

  void check() {
    for (std::size_t group = 0; group < model_.program.hitGroups.size(); ++group) checkBinding(group);
    if (input_.scene) {
      collectMeetings();
      for (const Meeting& meeting : meetings_) checkMeeting(meeting);
    } else {
      assumeMeetings();
    }
    checkAlphaTests();
    checkAnyHits();
  }

 private:
  const HitGroup& groupOf(HitRow row) const { return model_.program.hitGroups[row.group]; }

  bool isTraced(std::size_t ray, std::uint32_t skipFlag) const {
    return std::ranges::any_of(model_.traces, [&](const TraceSite& site) {
      return !site.trace->flags.must(skipFlag) &&
             std::ranges::any_of(site.hits, [&](HitRow row) { return row.ray == ray; });
    });
  }

  shader::Place at(HitRow row) const {
    const HitShaders& shaders = model_.shaders(row);
    return model_.at(shaders.line > 0 ? shaders.line : groupOf(row).line);
  }

  // What the group alone says.
  void checkBinding(std::size_t index) {
    const HitGroup& group = model_.program.hitGroups[index];
    const bool procedural = model_.hasIntersection(index);
    if (procedural && binds(group, "triangles"))
      report_.add("Q602", model_.at(group.line),
                  fmt::format("hit group '{}' is bound to triangles, but has an intersection shader", group.name));
    for (std::size_t ray = 0; ray < model_.rayCount(); ++ray) {
      const HitRow row{index, ray};
      if ((!procedural && !bindsBoxes(group)) || !model_.shaders(row).intersection.empty() ||
          !isTraced(ray, kFlagSkipBoxes))
        continue;
      report_.add("Q601", at(row),
                  fmt::format("{} has no intersection shader, but {}", model_.describe(row),
                              procedural ? "the group has one for another ray type, and such rays are traced"
                                         : "the group is bound to boxes"));
    }
  }

  void collectMeetings() {
    const SceneFacts& scene = *input_.scene;
    for (const TraceSite& site : model_.traces)
      for (const InstanceFacts& instance : scene.instances)
        for (std::uint32_t k = 0; k < instance.geometryCount && instance.firstGeometry + k < scene.geometries.size();
             ++k)
          if (site.trace->mask.may(instance.mask & 0xFFu)) meet(site, instance, k);
  }

  void meet(const TraceSite& site, const InstanceFacts& instance, std::uint32_t k) {
    const shader::TraceFacts& trace = *site.trace;
    const SceneFacts& scene = *input_.scene;
    const GeometryFacts& geometry = scene.geometries[instance.firstGeometry + k];
    if (model_.program.hitGroups.empty() ||
        trace.flags.must(geometry.procedural() ? kFlagSkipBoxes : kFlagSkipTriangles))
      return;
    Meeting meeting{&site, &instance, &geometry, {}, false, false};
    const bool built = (geometry.opaque() && !instance.forceNoOpaque) || instance.forceOpaque;
    meeting.opaque = (built && !trace.flags.may(kFlagNoOpaque)) || trace.flags.must(kFlagOpaque);
    meeting.notOpaque = (!built && !trace.flags.may(kFlagOpaque)) || trace.flags.must(kFlagNoOpaque);
    if ((meeting.opaque && trace.flags.must(kFlagCullOpaque)) ||
        (meeting.notOpaque && trace.flags.must(kFlagCullNoOpaque)))
      return;
    // With a stride of 0 every geometry of the instance has the records of the first one.
    const bool own = !trace.stride.exact() || trace.stride.values[0] != 0;
    const std::size_t owner = instance.firstGeometry + (own ? k : 0);
    for (const std::size_t ray : model_.rayTypes(trace)) {
      meeting.row = {hitGroupFor(model_.program, scene.geometries[owner]), ray};
      meetings_.push_back(meeting);
    }
  }

  // Without a scene: what each group is bound to.
  void assumeMeetings() {
    static const InstanceFacts kInstance;
    static const GeometryFacts kOpaque, kAlpha{GeometryKind::triangles, true, {}, {}};
    for (const TraceSite& site : model_.traces) {
      for (const HitRow row : site.hits) {
        const bool alpha = model_.program.anyHitForAll || !bindsOnly(groupOf(row), "opaque");
        const shader::ArgumentValues& flags = site.trace->flags;
        Meeting meeting{&site, &kInstance, alpha ? &kAlpha : &kOpaque, row, false, false};
        meeting.opaque = flags.must(kFlagOpaque) || (!alpha && !flags.may(kFlagNoOpaque));
        meeting.notOpaque = !meeting.opaque;
        meetings_.push_back(meeting);
      }
    }
  }

  std::string what(const Meeting& meeting) const {
    const std::string& name = meeting.geometry->name.empty() ? meeting.instance->name : meeting.geometry->name;
    return fmt::format("{} '{}' of {}", meeting.geometry->procedural() ? "the boxes of" : "the triangles of", name,
                       input_.scene->name);
  }

  void checkMeeting(const Meeting& meeting) {
    const bool hasShader = !model_.shaders(meeting.row).intersection.empty();
    const bool known = meeting.site->trace->offset.known;
    if (meeting.geometry->procedural() && !hasShader && known)
      report_.add("Q601", at(meeting.row),
                  fmt::format("{} are served by {}, which has no intersection shader", what(meeting),
                              model_.describe(meeting.row)));
    if (!meeting.geometry->procedural() && hasShader)
      report_.add("Q602", at(meeting.row),
                  fmt::format("{} are served by {}, whose intersection shader is for boxes", what(meeting),
                              model_.describe(meeting.row)));
  }

  bool hasAnyHits() const {
    return std::ranges::any_of(model_.program.hitGroups, [](const HitGroup& group) {
      return std::ranges::any_of(group.shaders, [](const auto& entry) { return !entry.second.anyHit.empty(); });
    });
  }

  // Surfaces with alpha that a trace takes for solid. A program without any any-hit shader does so on purpose, unless
  // a group is bound to class alpha.
  void checkAlphaTests() {
    for (const Meeting& meeting : meetings_) {
      const HitGroup& group = groupOf(meeting.row);
      const bool bound = binds(group, "alpha");
      const bool alpha = input_.scene ? meeting.geometry->alpha : bound;
      if (!alpha || (!bound && !hasAnyHits())) continue;
      const bool shader = !model_.shaders(meeting.row).anyHit.empty();
      if (shader && !meeting.opaque) continue;
      const std::string surface =
          input_.scene ? fmt::format("material '{}' of {}", meeting.geometry->material, input_.scene->name)
                       : "a material with alpha";
      if (!shader) {
        if (!meeting.site->trace->offset.known) continue;
        report_.add("Q604", at(meeting.row),
                    fmt::format("{} looks solid to this ray type: {} has no any-hit shader", surface,
                                model_.describe(meeting.row)));
      } else if (meeting.instance->forceOpaque && !meeting.site->trace->flags.must(kFlagOpaque)) {
        report_.add(
            "Q604", at(meeting.row),
            fmt::format("{} looks solid on instance '{}', which is forced opaque: any-hit shader '{}' does not run",
                        surface, meeting.instance->name, model_.shaders(meeting.row).anyHit));
      } else {
        report_.add(
            "Q604", model_.at(model_.stages[meeting.site->stage], meeting.site->trace->place),
            fmt::format(
                "{} looks solid to this trace: with gl_RayFlagsOpaqueEXT the any-hit shader '{}' of {} does not run",
                surface, model_.shaders(meeting.row).anyHit, model_.describe(meeting.row)));
      }
    }
  }

  // Any-hit shaders that some meeting could run, were it not for opacity.
  void checkAnyHits() {
    for (std::size_t group = 0; group < model_.program.hitGroups.size(); ++group) {
      for (std::size_t ray = 0; ray < model_.rayCount(); ++ray) {
        const HitRow row{group, ray};
        const std::string& file = model_.shaders(row).anyHit;
        if (file.empty()) continue;
        const auto here = [&](const Meeting& m) { return m.row.group == group && m.row.ray == ray; };
        if (std::ranges::none_of(meetings_, here) ||
            std::ranges::any_of(meetings_, [&](const Meeting& m) { return here(m) && !m.opaque; }))
          continue;
        const bool byFlags = std::ranges::all_of(
            meetings_, [&](const Meeting& m) { return !here(m) || m.site->trace->flags.must(kFlagOpaque); });
        // The library's serve every scene, with or without alpha.
        if (input_.scene && !byFlags && isLibraryStage(file)) continue;
        report_.add(
            "Q603", at(row),
            fmt::format("any-hit shader '{}' of {} never runs: {}", file, model_.describe(row),
                        byFlags        ? "every trace of that ray type has gl_RayFlagsOpaqueEXT"
                        : input_.scene ? fmt::format("all that the group serves in {} is opaque", input_.scene->name)
                                       : "the group is for opaque geometry"));
      }
    }
  }

  const CheckInput& input_;
  const LinkModel& model_;
  Report& report_;
  std::vector<Meeting> meetings_;
};

}  // namespace

void checkGeometry(const CheckInput& input, Report& report) { Geometry(input, report).check(); }

}  // namespace quintet::program
