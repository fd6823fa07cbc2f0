// SPDX-License-Identifier: Apache-2.0
#include "viewer/explanation_tree.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/text.h"
#include "output/explanation_text.h"

namespace quintet::viewer {
namespace {

using job::ExplainedEvent;
using job::PixelExplanation;

constexpr int kDigits = 3;  // of numbers in summaries

std::string shortText(const ExplainedEvent& event, std::string_view name) {
  return output::fieldText(event, name, kDigits);
}

std::string quoted(const std::string& name) { return "\"" + printable(name) + "\""; }

bool isData(const ExplainedEvent& event) { return event.type == "payload" || event.type == "data"; }

bool isHit(const ExplainedEvent& event) { return event.type == "closest-hit" || event.type == "hit"; }

// "hits \"floor\", 2.5 m", "misses"
std::string resultOf(const ExplainedEvent& ray) {
  if (ray.text("result") == "not traced") return "not traced: too deep";
  for (const ExplainedEvent& child : ray.children)
    if (isHit(child)) return fmt::format("hits {}, {} m", quoted(child.text("instanceName")), shortText(child, "t"));
  return ray.text("result") == "hit" ? "hits" : "misses";
}

std::string raySummary(const ExplainedEvent& ray) {
  const std::string type = ray.text("rayType");
  std::string text = (type.empty() ? ray.text("records") : printable(type)) + ": " + resultOf(ray);
  if (ray.find("transmittance") && ray.vector("transmittance") != vec3(1.0f))
    text += ", transmittance " + shortText(ray, "transmittance");
  return text;
}

std::string hitSummary(const ExplainedEvent& e) {
  std::string text = quoted(e.text("instanceName"));
  if (!e.text("material").empty()) text += ", material " + quoted(e.text("material"));
  text += fmt::format(", {} {}", e.find("barycentrics") ? "triangle" : "primitive", e.integer("primitive"));
  text += e.find("t") ? fmt::format(", {} m", shortText(e, "t"))
                      : fmt::format(", t {} to {}", shortText(e, "tmin"), shortText(e, "tmax"));
  if (!e.text("result").empty()) text += ": " + e.text("result");
  return text;
}

std::string lightSummary(const ExplainedEvent& e) {
  if (!e.find("lightType")) return "no light can contribute";
  const std::string light = fmt::format("{} {}", e.text("lightType"), quoted(e.text("light")));
  if (!e.find("pdf")) return light + ": cannot contribute";
  if (e.find("survival") && !e.flag("survived")) return light + ": not traced, by Russian roulette";
  return fmt::format("{}, pdf {}, MIS weight {}", light, shortText(e, "pdf"), shortText(e, "misWeight"));
}

std::string bsdfSummary(const ExplainedEvent& e) {
  std::string text = e.flag("straight")       ? "straight through"
                     : e.text("lobe").empty() ? ""
                     : e.flag("transmitted")  ? e.text("lobe") + " lobe, transmitted"
                                              : e.text("lobe") + " lobe";
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (!e.flag("useful")) {
    add("contributes nothing");
    return text;
  }
  add(e.flag("delta") ? "delta" : "pdf " + shortText(e, "pdf"));
  add("weight " + shortText(e, "weight"));
  return text;
}

std::string storeSummary(const ExplainedEvent& e) {
  std::string text = fmt::format("{} {} {}", printable(e.text("output")), e.text("mode") == "add" ? "+=" : "=",
                                 e.find("id") ? "id " + shortText(e, "id") : shortText(e, "value"));
  if (e.find("pixel")) text += " in pixel " + shortText(e, "pixel");
  return text;
}

struct Style {
  std::string_view type;
  std::string_view name;  // of the row
  std::string (*summary)(const ExplainedEvent&);
};
const Style kStyles[] = {
    {"closest-hit", "hit", hitSummary},
    {"hit", "hit, no shader", hitSummary},
    {"any-hit", "any-hit", hitSummary},
    {"intersection", "intersection", hitSummary},
    {"report", "report",
     [](const ExplainedEvent& e) {
       return fmt::format("t {}: {}", shortText(e, "t"), e.flag("accepted") ? "accepted" : "not accepted");
     }},
    {"miss", "miss", [](const ExplainedEvent& e) { return printable(e.text("stage")); }},
    {"callable", "callable", [](const ExplainedEvent& e) { return printable(e.text("stage")); }},
    {"call", "call",
     [](const ExplainedEvent& e) {
       return fmt::format("callable {} {}", e.integer("index"), printable(e.text("callable")));
     }},
    {"store", "store", storeSummary},
    {"camera", "camera", [](const ExplainedEvent& e) { return "film position " + output::fieldText(e, "film"); }},
    {"surface", "surface",
     [](const ExplainedEvent& e) { return fmt::format("{} side at {}", e.text("side"), shortText(e, "position")); }},
    {"shading", "material",
     [](const ExplainedEvent& e) {
       return fmt::format("base color {}, roughness {}", shortText(e, "baseColor"), shortText(e, "roughness"));
     }},
    {"light", "light sample", lightSummary},
    {"bsdf", "BSDF sample", bsdfSummary},
    {"roulette", "roulette",
     [](const ExplainedEvent& e) {
       return fmt::format("{}, survival {}", e.flag("survived") ? "survives" : "ends the path",
                          shortText(e, "survival"));
     }},
    {"emission", "emission",
     [](const ExplainedEvent& e) {
       return fmt::format("{} radiance {}, MIS weight {}", e.text("source"), shortText(e, "radiance"),
                          shortText(e, "misWeight"));
     }},
    {"end", "path ends", [](const ExplainedEvent& e) { return e.text("reason"); }},
    {"contribution", "contribution",
     [](const ExplainedEvent& e) { return e.text("source") + " " + shortText(e, "value"); }},
};

// Whether the program states its contributions. For others, what it stores in the first output is the contribution.
bool statesContributions(const PixelExplanation& explanation) {
  bool found = false;
  job::forEachEvent(explanation.events,
                    [&](const ExplainedEvent& event, int) { found = found || event.type == "contribution"; });
  return found;
}

class Builder {
 public:
  Builder(const PixelExplanation& explanation, std::vector<ExplanationRow>& rows, std::vector<std::size_t>& rowOfEvent)
      : rows_(rows),
        rowOfEvent_(rowOfEvent),
        stated_(statesContributions(explanation)),
        firstOutput_(explanation.outputs.empty() ? "" : explanation.outputs.front().name) {}

  // What follows a ray describes what the program did with it, so it is below the ray.
  void list(const std::vector<ExplainedEvent>& events, int depth, std::size_t caller = 0) {
    std::size_t openRay = kNone;
    for (const ExplainedEvent& event : events) {
      if (event.type == "ray") {
        close(openRay);
        openRay = rows_.size();
        add(event, depth, caller);
      } else {
        add(event, depth + (openRay == kNone ? 0 : 1), caller);
      }
    }
    close(openRay);
  }

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  // `caller`: the row of the event that has this one in it.
  void add(const ExplainedEvent& event, int depth, std::size_t caller) {
    const std::size_t number = rowOfEvent_.size();
    const std::size_t index = rows_.size();
    rowOfEvent_.push_back(isData(event) ? caller : index);
    if (isData(event)) return;  // details of the call
    ExplanationRow row;
    row.event = &event;
    row.number = number;
    row.depth = depth;
    if (event.type == "ray") {
      ray_ = rays_++;
      row.name = fmt::format("Ray {}", rays_);
      row.summary = raySummary(event);
    } else {
      const auto style = std::ranges::find(kStyles, event.type, &Style::type);
      const bool known = style != std::end(kStyles);
      row.name = known ? style->name : printable(event.type);
      if (known) row.summary = style->summary(event);
    }
    row.ray = ray_;
    const bool stored =
        !stated_ && event.type == "store" && event.text("output") == firstOutput_ && !event.find("pixel");
    if (event.type == "contribution" || stored) row.contribution = event.vector("value");
    rows_.push_back(std::move(row));
    const std::optional<std::size_t> ray = ray_;
    list(event.children, depth + 1, index);
    ray_ = ray;                              // also of the events that follow
    if (event.type != "ray") finish(index);  // close() ends those of rays
  }

  void close(std::size_t ray) {
    if (ray != kNone) finish(ray);
  }
  void finish(std::size_t index) {
    rows_[index].end = rows_.size();
    std::optional<vec3>& sum = rows_[index].contribution;
    for (std::size_t i = index + 1; i < rows_.size(); i = rows_[i].end)
      if (rows_[i].contribution) sum = sum.value_or(vec3(0.0f)) + *rows_[i].contribution;
  }

  std::vector<ExplanationRow>& rows_;
  std::vector<std::size_t>& rowOfEvent_;
  const bool stated_;
  const std::string firstOutput_;
  std::size_t rays_ = 0;
  std::optional<std::size_t> ray_;  // to which the next event belongs
};

// "shadingNormal" → "shading normal"
std::string spaced(const std::string& name) {
  std::string text;
  for (const char c : name) {
    if (std::isupper(static_cast<unsigned char>(c)) != 0) text += ' ';
    text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return text;
}

void addData(const ExplainedEvent& caller, std::vector<ExplanationField>& fields) {
  const ExplainedEvent* before = nullptr;
  const ExplainedEvent* after = nullptr;
  for (const ExplainedEvent& child : caller.children)
    if (isData(child)) (child.text("when") == "after" ? after : before) = &child;
  const ExplainedEvent* shown = after ? after : before;
  if (!shown) return;
  for (const auto& [name, value] : shown->fields) {
    if (name == "when" || name == "variable" || name == "dataType" || name == "complete") continue;
    // A variable without members.
    const std::string shownName = name == "value" ? shown->text("variable") : name;
    ExplanationField field{shownName, output::fieldText(*shown, name), {}};
    if (after && before) {
      const std::string old = output::fieldText(*before, name);
      if (old != field.value) field.before = old;
    }
    fields.push_back(std::move(field));
  }
  if (shown->find("complete")) fields.push_back({"...", "the log has no further members", {}});
}

}  // namespace

ExplanationTree::ExplanationTree(std::shared_ptr<const PixelExplanation> explanation)
    : explanation_(std::move(explanation)),
      contributionSum_(job::sumContributions(*explanation_)),
      sumDiffers_(output::sumDiffers(*explanation_)) {
  Builder(*explanation_, rows_, rowOfEvent_).list(explanation_->events, 0);
}

std::size_t ExplanationTree::rowOfRay(std::size_t ray) const {
  const auto found = std::ranges::find_if(
      rows_, [&](const ExplanationRow& row) { return row.ray == ray && row.event->type == "ray"; });
  return static_cast<std::size_t>(found - rows_.begin());
}

ExplanationComparison compareExplanations(const PixelExplanation& a, const ExplanationTree& b) {
  ExplanationComparison result;
  result.diff = job::diffExplanations(a, *b.explanation());
  result.differs.resize(b.rows().size());
  const job::DifferentEvents different = job::differentEvents(a, *b.explanation());
  for (const std::size_t number : different.b) result.differs[b.rowOfEvent(number)] = true;
  if (different.firstInB) result.first = b.rowOfEvent(*different.firstInB);
  return result;
}

std::vector<ExplanationField> fieldsOf(const ExplainedEvent& event) {
  std::vector<ExplanationField> fields;
  for (const auto& [name, value] : event.fields) {
    if (name == "stage" || name == "file" || name == "line") continue;
    if (const std::string text = output::fieldText(event, name); !text.empty() && text != "\"\"")
      fields.push_back({spaced(name), printable(text), {}});
  }
  addData(event, fields);
  const std::string stage = event.text("stage"), file = event.text("file");
  if (!stage.empty()) fields.push_back({"shader", printable(stage), {}});
  if (event.find("line"))
    fields.push_back(
        {"source", fmt::format("{}:{}", printable(file.empty() ? stage : file), event.integer("line")), {}});
  return fields;
}

}  // namespace quintet::viewer
