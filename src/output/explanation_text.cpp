// SPDX-License-Identifier: Apache-2.0
#include "output/explanation_text.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/plural.h"
#include "base/text.h"
#include "base/wrap.h"
#include "job/float_json.h"
#include "output/float_text.h"
#include "output/json_line.h"

namespace quintet::output {
namespace {

using Json = nlohmann::ordered_json;

using job::EventValue;
using job::ExplainedEvent;
using job::PixelExplanation;

constexpr std::size_t kLabelColumns = 15;

// "12 bounces", joined by ", ".
class Parts {
 public:
  Parts& add(const std::string& part) {
    if (!part.empty()) text_ += (text_.empty() ? "" : ", ") + part;
    return *this;
  }
  // "label value" if the event has the field.
  Parts& add(const char* label, const ExplainedEvent& event, std::string_view name) {
    const std::string value = fieldText(event, name);
    return value.empty() ? *this : add(std::string(label) + (*label ? " " : "") + value);
  }
  std::string text() const { return text_; }

 private:
  std::string text_;
};

std::string inQuotes(const std::string& name) { return "\"" + printable(name) + "\""; }

class TreeText {
 public:
  TreeText(std::size_t width, bool payloads) : width_(width), payloads_(payloads) {}

  void list(const std::vector<ExplainedEvent>& events, std::size_t indent) {
    bool inRay = false;  // what follows a ray describes what the program did with it
    for (std::size_t i = 0; i < events.size(); ++i) {
      if (events[i].type == "ray") {
        inRay = true;
        ray(events[i], indent);
      } else {
        event(events[i], indent + (inRay ? 2 : 0));
      }
    }
  }
  std::string take() { return std::move(text_); }

 private:
  void line(std::size_t indent, const std::string& label, const std::string& text) {
    if (text.empty()) return;
    text_ += twoColumns(std::string(indent, ' ') + label, text, indent + kLabelColumns, width_);
  }

  static std::string location(const ExplainedEvent& event) {
    std::string file = event.text("file").empty() ? event.text("stage") : event.text("file");
    // "<programs/lessons/05_shadow>/shadow.rt.glsl" → "shadow.rt.glsl"
    if (const std::size_t folder = file.find(">/"); file.starts_with('<') && folder != file.npos)
      file = file.substr(folder + 2);
    return fmt::format("{}:{}", file, event.integer("line"));
  }

  void ray(const ExplainedEvent& ray, std::size_t indent) {
    if (!text_.empty() && indent == 0) text_ += '\n';
    const std::string type = ray.text("rayType");
    text_ +=
        fmt::format("{}Ray {}: {}, {}\n", std::string(indent, ' '), ++rays_,
                    type.empty() ? "records with " + ray.text("records") : printable(type), printable(location(ray)));
    const std::size_t inner = indent + 2;
    line(inner, "origin", fieldText(ray, "origin"));
    line(inner, "direction", fieldText(ray, "direction"));
    Parts interval;
    interval.add(fmt::format("{} to {}", fieldText(ray, "tmin"), fieldText(ray, "tmax")));
    if (ray.integer("cullMask") != 0xFF) interval.add(fmt::format("cull mask 0x{:02x}", ray.integer("cullMask")));
    if (!ray.text("flags").empty()) interval.add("flags " + ray.text("flags"));
    if (ray.integer("missIndex") != 0) interval.add(fmt::format("miss index {}", ray.integer("missIndex")));
    line(inner, "t", interval.text());
    data(ray, inner);
    for (const ExplainedEvent& child : ray.children)
      if (child.type != "payload") event(child, inner);
    if (ray.text("result") == "not traced")
      line(inner, "not traced", "the trace exceeds the recursion depth of the pipeline");
    line(inner, "transmittance", fieldText(ray, "transmittance"));
  }

  // The payload of a ray or the data of a call: the values before, and those that changed.
  void data(const ExplainedEvent& caller, std::size_t indent) {
    if (!payloads_) return;
    const char* type = caller.type == "ray" ? "payload" : "data";
    const ExplainedEvent* before = nullptr;
    const ExplainedEvent* after = nullptr;
    for (const ExplainedEvent& child : caller.children)
      if (child.type == type) (child.text("when") == "after" ? after : before) = &child;
    if (!before) return;
    Parts parts;
    for (const auto& [name, value] : before->fields) {
      if (name == "when" || name == "variable" || name == "dataType" || name == "complete") continue;
      const EventValue* changed = after ? after->find(name) : nullptr;
      const bool differs = changed && fieldText(*after, name) != fieldText(*before, name);
      parts.add(fmt::format("{} {}{}", memberName(name, before->text("variable")), fieldText(*before, name),
                            differs ? " -> " + fieldText(*after, name) : ""));
    }
    if (before->find("complete")) parts.add("…");
    line(indent, type, parts.text());
  }

  // "payload.color" → "color"; "value" → the variable
  static std::string memberName(const std::string& name, const std::string& variable) {
    if (name == "value") return variable;
    const bool isMember = name.starts_with(variable + ".");
    return isMember ? name.substr(variable.size() + 1) : name;
  }

  void event(const ExplainedEvent& e, std::size_t indent) {
    if (e.type == "ray") return ray(e, indent);
    const std::string& type = e.type;
    if (type == "closest-hit" || type == "hit" || type == "any-hit" || type == "intersection") return hit(e, indent);
    if (type == "miss")
      line(indent, "miss", printable(e.text("stage")));
    else if (type == "report")
      report(e, indent);
    else if (type == "callable")
      line(indent, "callable", printable(e.text("stage")));
    else if (type == "call")
      return call(e, indent);
    else if (type == "store")
      store(e, indent);
    else if (type == "camera")
      line(indent, "camera", "film position " + fieldText(e, "film") + ", lens " + fieldText(e, "lens"));
    else if (type == "surface")
      surface(e, indent);
    else if (type == "shading")
      shading(e, indent);
    else if (type == "light")
      light(e, indent);
    else if (type == "bsdf")
      bsdf(e, indent);
    else if (type == "roulette")
      roulette(e, indent);
    else if (type == "emission")
      emission(e, indent);
    else if (type == "contribution")
      contribution(e, indent);
    else if (type == "end")
      line(indent, "path ends", e.text("reason"));
    list(e.children, indent + 2);
  }

  void hit(const ExplainedEvent& e, std::size_t indent) {
    const bool box = e.type == "intersection";
    Parts parts;
    const bool triangle = e.find("barycentrics") != nullptr;
    parts.add(fmt::format("{} (instance {})", inQuotes(e.text("instanceName")), e.integer("instance")));
    parts.add("geometry", e, "geometry").add(triangle ? "triangle" : "box", e, "primitive");
    if (box)
      parts.add(fmt::format("t {} to {}", fieldText(e, "tmin"), fieldText(e, "tmax")));
    else
      parts.add("t", e, "t");
    parts.add("", e, "result");
    const std::string label = e.type == "closest-hit" ? "hit" : e.type;
    line(indent, label, parts.text());
    if (payloads_) {
      if (!e.text("stage").empty()) line(indent, "", "runs " + printable(e.text("stage")));
      Parts details;
      if (!e.text("material").empty()) details.add("material " + inQuotes(e.text("material")));
      details.add("kind", e, "hitKind").add("barycentrics", e, "barycentrics").add("uv", e, "uv");
      line(indent, "", details.text());
      Parts normals;
      normals.add("normal", e, "geometricNormal");
      if (fieldText(e, "geometricNormal") != fieldText(e, "shadingNormal"))
        normals.add("shading normal", e, "shadingNormal");
      line(indent, "", normals.text());
    }
    list(e.children, indent + 2);
  }

  void report(const ExplainedEvent& e, std::size_t indent) {
    line(indent, "report",
         fmt::format("t {}, kind {}: {}", fieldText(e, "t"), e.integer("hitKind"),
                     e.flag("accepted") ? "accepted" : "not accepted"));
  }

  void call(const ExplainedEvent& e, std::size_t indent) {
    const std::string name = e.text("callable");
    line(indent, "call",
         fmt::format("callable {}{}, {}", e.integer("index"), name.empty() ? "" : " " + inQuotes(name),
                     printable(location(e))));
    data(e, indent + 2);
    for (const ExplainedEvent& child : e.children)
      if (child.type != "data") event(child, indent + 2);
  }

  void store(const ExplainedEvent& e, std::size_t indent) {
    const bool adds = e.text("mode") == "add";
    const std::string value = e.find("id") ? "id " + fieldText(e, "id") : fieldText(e, "value");
    std::string text = fmt::format("{} {} {}", printable(e.text("output")), adds ? "+=" : "=", value);
    if (e.find("pixel")) text += " in pixel " + fieldText(e, "pixel");
    line(indent, "store", text);
  }

  void surface(const ExplainedEvent& e, std::size_t indent) {
    line(indent, "surface",
         Parts().add("position", e, "position").add("uv", e, "uv").add(e.text("side") + " side").text());
    Parts normals;
    normals.add("", e, "geometricNormal");
    if (fieldText(e, "geometricNormal") != fieldText(e, "shadingNormal"))
      normals.add("interpolated", e, "shadingNormal");
    line(indent, "normal", normals.text());
    material_ = e.text("material");
  }

  void shading(const ExplainedEvent& e, std::size_t indent) {
    Parts parts;
    parts.add(inQuotes(material_)).add("base color", e, "baseColor").add("metallic", e, "metallic");
    parts.add("roughness", e, "roughness");
    if (e.number("transmission") > 0.0f) parts.add("transmission", e, "transmission").add("IOR", e, "ior");
    if (e.number("clearcoat") > 0.0f) parts.add("clearcoat", e, "clearcoat");
    if (e.vector("sheenColor") != vec3(0.0f))
      parts.add("sheen color", e, "sheenColor").add("sheen roughness", e, "sheenRoughness");
    if (e.number("diffuseTransmission") > 0.0f) parts.add("diffuse transmission", e, "diffuseTransmission");
    if (e.number("anisotropy") > 0.0f) parts.add("anisotropy", e, "anisotropy");
    if (e.number("iridescence") > 0.0f)
      parts.add("iridescence", e, "iridescence").add("film thickness in nm", e, "iridescenceThickness");
    if (e.number("dispersion") > 0.0f) parts.add("dispersion", e, "dispersion");
    if (e.vector("emission") != vec3(0.0f)) parts.add("emission", e, "emission");
    if (e.flag("unlit")) parts.add("unlit");
    line(indent, "material", parts.text());
    line(indent, "", "shading normal " + fieldText(e, "normal"));
  }

  void light(const ExplainedEvent& e, std::size_t indent) {
    if (!e.find("lightType")) return line(indent, "light sample", "no light can contribute");
    Parts choice;
    const bool ofInstance = e.find("instance") != nullptr;
    choice.add(fmt::format("{} {}", e.text("lightType"), inQuotes(e.text("light"))));
    if (ofInstance) choice.add(fmt::format("number {} of instance {}", e.integer("primitive"), e.integer("instance")));
    choice.add("chosen with probability", e, "probability");
    if (!e.find("pdf")) choice.add("cannot contribute");
    line(indent, "light sample", choice.text());
    if (!e.find("pdf")) return;
    line(indent, "", Parts().add("direction", e, "direction").add("distance", e, "distance").text());
    line(indent, "",
         Parts().add("radiance", e, "radiance").add(e.flag("delta") ? "delta, probability" : "pdf", e, "pdf").text());
    line(indent, "",
         Parts().add("BSDF", e, "bsdf").add("BSDF pdf", e, "bsdfPdf").add("MIS weight", e, "misWeight").text());
    line(indent, "", "throughput " + fieldText(e, "throughput"));
    if (!e.find("survival")) return;
    const bool survived = e.flag("survived");
    line(indent, "",
         fmt::format("roulette: {}: {} {} {}", survived ? "traced" : "not traced", fieldText(e, "u"),
                     survived ? "<" : ">=", fieldText(e, "survival")));
  }

  void bsdf(const ExplainedEvent& e, std::size_t indent) {
    Parts choice;
    if (!e.text("lobe").empty()) choice.add(e.text("lobe") + " lobe").add("chosen with probability", e, "probability");
    if (e.flag("straight"))
      choice.add("straight through");
    else if (e.flag("transmitted"))
      choice.add("transmitted");
    if (!e.flag("useful")) choice.add("contributes nothing");
    line(indent, "BSDF sample", choice.text());
    if (!e.flag("useful")) return;
    line(indent, "", "direction " + fieldText(e, "direction"));
    line(indent, "",
         Parts().add(e.flag("delta") ? "delta" : "pdf " + fieldText(e, "pdf")).add("weight", e, "weight").text());
  }

  void roulette(const ExplainedEvent& e, std::size_t indent) {
    const bool survived = e.flag("survived");
    line(indent, "roulette",
         fmt::format("{}: {} {} {}{}", survived ? "the path survives" : "the path ends", fieldText(e, "u"),
                     survived ? "<" : ">=", fieldText(e, "survival"),
                     survived ? "; throughput " + fieldText(e, "throughput") : ""));
  }

  void emission(const ExplainedEvent& e, std::size_t indent) {
    line(indent, "emission",
         Parts()
             .add(e.text("source") + " radiance " + fieldText(e, "radiance"))
             .add("throughput", e, "throughput")
             .text());
    Parts weights;
    if (e.number("lightPdf") > 0.0f) weights.add("BSDF pdf", e, "bsdfPdf").add("light pdf", e, "lightPdf");
    weights.add("MIS weight", e, "misWeight");
    line(indent, "", weights.text());
  }

  void contribution(const ExplainedEvent& e, std::size_t indent) {
    Parts parts;
    parts.add(fieldText(e, "value"));
    if (e.find("unclamped")) parts.add("clamped from " + fieldText(e, "unclamped"));
    line(indent, "contribution", parts.text());
  }

  const std::size_t width_;
  const bool payloads_;  // show payloads and details of hits
  std::size_t rays_ = 0;
  std::string material_;  // of the latest surface
  std::string text_;
};

std::string heading(const PixelExplanation& e) {
  std::string text = fmt::format("{}: pixel {},{} of {}x{}, {} {}", printable(e.scene), e.pixel.x, e.pixel.y, e.size.x,
                                 e.size.y, e.frames ? "frame" : "sample", e.sample);
  if (e.plannedSamples > 0) text += fmt::format(" of {}", e.plannedSamples);
  return text + fmt::format(", seed {}", e.seed);
}

std::string contributionName(const job::Contribution& contribution) {
  std::string text =
      contribution.ray > 0 ? fmt::format("ray {}: {}", contribution.ray, contribution.source) : contribution.source;
  if (contribution.scatterings >= 0) text += ", " + counted(contribution.scatterings, "scattering event");
  return text;
}

std::string values(const PixelExplanation& e, std::size_t width) {
  std::string text;
  const auto add = [&](const std::string& label, const std::string& value) {
    text += twoColumns(label, value, 2 + kLabelColumns, width);
  };
  for (const job::ExplainedOutput& output : e.outputs) {
    add(printable(output.name), fmt::format("{}, alpha {}", vectorText(output.value), floatText(output.value.a)));
    if (!isRounding(output.value, output.recorded))
      add("", fmt::format("The instrumented program computed {}, which differs by more than rounding.",
                          vectorText(output.recorded)));
  }
  if (e.discarded)
    text += wrapped("The program discarded the sample, because its value is not finite.", width, 0) + "\n";
  if (e.origin)
    text += wrapped(fmt::format("The first value that is not finite: {}, {}.",
                                printable(locationText(e.origin->location.file, e.origin->location.line, 0)),
                                job::originText(*e.origin)),
                    width, 0) +
            "\n";
  if (e.lostRecords > 0)
    text += wrapped(fmt::format("{} did not fit into the log; the end of the tree is missing.",
                                counted(e.lostRecords, "record")),
                    width, 0) +
            "\n";
  return text;
}

std::string contributions(const PixelExplanation& e) {
  const std::vector<job::Contribution> parts = job::contributionsOf(e);
  if (parts.empty()) return {};
  const auto row = [](const std::string& name, const vec3& value) {
    return fmt::format("  {:<38} {:>11} {:>11} {:>11}\n", name, floatText(value.x), floatText(value.y),
                       floatText(value.z));
  };
  std::string text = "\nContributions\n";
  for (const job::Contribution& part : parts) text += row(contributionName(part), part.value);
  text += row("sum", job::sumContributions(e));
  if (sumDiffers(e)) text += fmt::format("  The sum is not the value of '{}'.\n", printable(e.outputs.front().name));
  return text;
}

}  // namespace

bool isRounding(const vec3& a, const vec3& b) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (std::isnan(a[i]) && std::isnan(b[i])) continue;
    if (!(std::abs(a[i] - b[i]) <= 1e-6f + 1e-4f * std::max(std::abs(a[i]), std::abs(b[i])))) return false;
  }
  return true;
}

bool sumDiffers(const PixelExplanation& e) {
  return !e.discarded && !e.outputs.empty() && !isRounding(job::sumContributions(e), e.outputs.front().value);
}

std::string fieldText(const ExplainedEvent& event, std::string_view name, int digits) {
  const EventValue* value = event.find(name);
  if (!value) return {};
  if (const auto* number = std::get_if<float>(value)) return floatText(*number, digits);
  if (const auto* numbers = std::get_if<std::vector<float>>(value)) return floatsText(*numbers, digits);
  std::string text = job::valueText(*value);
  if (std::holds_alternative<std::vector<std::int64_t>>(*value)) {
    text = text.substr(1, text.size() - 2);
    std::erase(text, ',');
  }
  return text;
}

std::string explanationText(const PixelExplanation& e, std::size_t width, bool payloads) {
  bool stated = false;  // a black sample has no contributions, but samples of lights or lobes
  job::forEachEvent(e.events, [&](const ExplainedEvent& event, int) {
    stated = stated || event.type == "contribution" || event.type == "light" || event.type == "bsdf";
  });
  std::string text = wrapped(heading(e), width, 2, 0) + "\n";
  std::string program = fmt::format("program {} on {}", printable(e.program), printable(e.device));
  if (!e.parameters.empty()) program += "; " + printable(e.parameters);
  text += wrapped(program, width, 2, 0) + "\n\n";
  text += values(e, width);
  text += contributions(e);
  TreeText tree(width, payloads || !stated);
  tree.list(e.events, 0);
  return text + "\n" + tree.take();
}

std::string explanationDiffText(const job::ExplanationDiff& diff, const std::string& a, const std::string& b,
                                std::size_t width) {
  std::string text = wrapped(fmt::format("A: {}", printable(a)), width, 3, 0) + "\n" +
                     wrapped(fmt::format("B: {}", printable(b)), width, 3, 0) + "\n\n";
  const auto add = [&](const job::ExplanationDifference& d) {
    text += wrapped(printable(d.location), width, 2, 0) + "\n";
    text += twoColumns("  A", printable(d.a), 5, width);
    text += twoColumns("  B", printable(d.b), 5, width);
    if (d.error) text += fmt::format("  difference {:.3g}\n", *d.error);
  };
  for (const job::ExplanationDifference& fact : diff.facts) add(fact);
  if (!diff.facts.empty()) text += "\n";
  if (diff.first) {
    text += fmt::format("The first difference, after {}:\n", counted(diff.equalEvents, "equal event"));
    add(*diff.first);
  } else {
    text += fmt::format("All {} are equal.\n", counted(diff.equalEvents, "event"));
  }
  if (diff.outputs.empty()) return text + "The values of the outputs are equal.\n";
  text += "\nOutputs that differ:\n";
  for (const job::ExplanationDifference& output : diff.outputs) add(output);
  return text;
}

std::string explanationDiffJson(const job::ExplanationDiff& diff, const std::string& a, const std::string& b) {
  const auto entry = [](const job::ExplanationDifference& d) {
    Json json{{"location", d.location}, {"a", d.a}, {"b", d.b}};
    if (d.error) json["difference"] = job::floatJson(*d.error);
    return json;
  };
  Json json{{"a", a}, {"b", b}, {"equal", diff.equal()}, {"equalEvents", diff.equalEvents}};
  json["facts"] = Json::array();
  for (const job::ExplanationDifference& fact : diff.facts) json["facts"].push_back(entry(fact));
  json["first"] = diff.first ? entry(*diff.first) : Json();
  json["outputs"] = Json::array();
  for (const job::ExplanationDifference& output : diff.outputs) json["outputs"].push_back(entry(output));
  return jsonLine(json);
}

}  // namespace quintet::output
