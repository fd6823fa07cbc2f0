// SPDX-License-Identifier: Apache-2.0
#include "check/diagram/diagram.h"

#include <algorithm>
#include <compare>
#include <map>
#include <set>
#include <string_view>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/plural.h"
#include "check/sources.h"

namespace quintet::check {
namespace {

constexpr std::size_t kMaxNames = 6;  // geometries of a hit group

class DiagramBuilder {
 public:
  explicit DiagramBuilder(const PipelineModel& model) : model_(model) {}

  Diagram build() {
    addHead();
    for (std::size_t i = 0; i < model_.stages.size(); ++i)
      if (model_.stages[i].kind == shader::Stage::rayGeneration) addRayGeneration(i);
    traceNodes_ = addAll(model_.traces, [&](const PipelineModel::Trace& trace) { return traceNode(trace); });
    callNodes_ = addAll(model_.calls, [&](const PipelineModel::Call& call) { return callNode(call); });
    addHits();
    addRecords(model_.misses, NodeKind::miss, missNodes_);
    addRecords(model_.callables, NodeKind::callable, callableNodes_);
    connect(model_.traces, traceNodes_);
    connect(model_.calls, callNodes_);
    for (const Diagnostic& d : model_.diagnostics) diagram_.diagnostics.push_back(d.format());
    return std::move(diagram_);
  }

 private:
  void addHead() {
    diagram_.title = model_.program;
    diagram_.rays = model_.rays;
    std::string recursion = fmt::format("recursion depth {}", model_.recursionDepth);
    if (model_.declaredRecursion) recursion += fmt::format(" ({} declared)", *model_.declaredRecursion);
    diagram_.facts.push_back(fmt::format("{}, stack of at least {}", recursion, counted(model_.stackBytes, "byte")));
    diagram_.facts.push_back(model_.scene.empty() ? "any scene" : "scene " + model_.scene);
  }

  std::string idsOf(const Indices& diagnostics) const {
    std::vector<std::string> ids;
    for (const std::size_t i : diagnostics)
      if (const std::string& id = model_.diagnostics[i].id; std::ranges::find(ids, id) == ids.end()) ids.push_back(id);
    return fmt::format("{}", fmt::join(ids, ", "));
  }

  std::string diagnosticsOf(std::optional<std::size_t> stage, Indices others = {}) const {
    if (stage)
      others.insert(others.end(), model_.stages[*stage].diagnostics.begin(), model_.stages[*stage].diagnostics.end());
    return idsOf(others);
  }

  std::size_t add(DiagramNode node) {
    std::erase_if(node.rows, [](const DiagramNode::Row& row) { return row.text.empty(); });
    diagram_.nodes.push_back(std::move(node));
    return diagram_.nodes.size() - 1;
  }

  template <class Item>
  Indices addAll(const std::vector<Item>& items, const auto& toNode) {
    Indices nodes;
    for (const Item& item : items) nodes.push_back(add(toNode(item)));
    return nodes;
  }

  std::string fileOf(std::optional<std::size_t> stage) const {
    return stage ? withoutBrackets(model_.stages[*stage].file) : "";
  }

  static std::string lineText(const std::string& file, const SourceLocation& location) {
    const std::string path = withoutBrackets(location.file);
    const std::string name = path.substr(path.rfind('/') + 1);
    return location.line > 0 ? fmt::format("{}:{}", name, location.line) : file;
  }

  void addRayGeneration(std::size_t stage) {
    const std::size_t node =
        add({NodeKind::rayGeneration, "ray generation", {{"", fileOf(stage)}}, diagnosticsOf(stage)});
    stageNodes_[stage].push_back(node);
  }

  static std::string variableText(const std::string& name, const std::string& type, std::uint64_t bytes) {
    if (type.empty()) return name;
    return fmt::format("{} {} ({})", type, name, counted(bytes, "byte"));
  }

  std::string rayNames(const Indices& rays) const {
    std::vector<std::string> names;
    for (const std::size_t ray : rays) names.push_back(model_.rays[ray]);
    return fmt::format("{}", fmt::join(names, " or "));
  }

  static std::string withLoop(const std::string& rays, bool inLoop) {
    return !inLoop ? rays : rays.empty() ? "in a loop" : rays + ", in a loop";
  }

  DiagramNode traceNode(const PipelineModel::Trace& trace) const {
    const std::string where = lineText(fileOf(trace.stage), trace.location);
    return {NodeKind::trace,
            (trace.executes ? "execution " : "trace ") + where,
            {{"ray", withLoop(rayNames(trace.rays), trace.inLoop)},
             {"flags", trace.flags},
             {"mask", trace.mask},
             {"record", fmt::format("offset {}, stride {}", trace.offset, trace.stride)},
             {"miss", trace.miss},
             {"payload", variableText(trace.payload, trace.payloadType, trace.payloadBytes)}},
            idsOf(trace.diagnostics)};
  }

  DiagramNode callNode(const PipelineModel::Call& call) const {
    return {NodeKind::call,
            "call " + lineText(fileOf(call.stage), call.location),
            {{"index", call.index}, {"data", variableText(call.data, call.dataType, call.dataBytes)}},
            idsOf(call.diagnostics)};
  }

  // The shaders of a hit that a trace runs, or why it does not run one.
  struct HitUse {
    std::size_t hit = 0;
    std::string_view withoutClosestHit = {}, withoutAnyHit = {};
    auto operator<=>(const HitUse&) const = default;
  };

  HitUse useOf(const PipelineModel::Trace& trace, std::size_t hit) const {
    const PipelineModel::Hit& shaders = model_.hits[hit];
    HitUse use{hit};
    if (shaders.closestHit && trace.skipsClosestHit) use.withoutClosestHit = "skipped (SkipClosestHitShader)";
    if (shaders.closestHit && trace.searches) use.withoutClosestHit = "not run by this trace";
    if (shaders.anyHit && trace.skipsAnyHit) use.withoutAnyHit = "skipped (Opaque)";
    if (shaders.anyHit && trace.executes) use.withoutAnyHit = "not run by an execution";
    return use;
  }

  // One box for the groups of a ray type with the same shaders.
  void addHits() {
    std::set<HitUse> uses;
    for (const PipelineModel::Trace& trace : model_.traces)
      for (const PipelineModel::Target& target : trace.targets)
        if (target.role == Role::closestHit) uses.insert(useOf(trace, target.index));
    using Stage = std::optional<std::size_t>;
    std::map<std::tuple<std::string, Stage, Stage, Stage, std::string_view, std::string_view>, std::vector<HitUse>>
        boxes;
    std::vector<const std::vector<HitUse>*> order;
    for (const HitUse& use : uses) {
      const PipelineModel::Hit& hit = model_.hits[use.hit];
      std::vector<HitUse>& box =
          boxes[{hit.ray, hit.closestHit, hit.anyHit, hit.intersection, use.withoutClosestHit, use.withoutAnyHit}];
      if (box.empty()) order.push_back(&box);
      box.push_back(use);
    }
    for (const std::vector<HitUse>* box : order) addHitBox(*box);
  }

  void addHitBox(const std::vector<HitUse>& uses) {
    const HitUse& use = uses.front();
    const PipelineModel::Hit& first = model_.hits[use.hit];
    DiagramNode node{NodeKind::hit, first.ray.empty() ? "hit" : fmt::format("hit, ray type {}", first.ray), {}, {}};
    const auto text = [&](std::string_view without, std::optional<std::size_t> stage) {
      return without.empty() ? fileOf(stage) : std::string(without);
    };
    node.rows = {{"closest hit", text(use.withoutClosestHit, first.closestHit)},
                 {"any hit", text(use.withoutAnyHit, first.anyHit)},
                 {"intersection", fileOf(first.intersection)}};
    if (!first.closestHit && !first.anyHit && !first.intersection) node.rows = {{"", "no shaders"}};
    Indices diagnostics;
    for (const HitUse& other : uses) {
      const PipelineModel::Hit& hit = model_.hits[other.hit];
      node.rows.push_back({"group", fmt::format("{}{}", hit.group, hit.binding.empty() ? "" : bindingText(hit))});
      node.rows.push_back({"  record", hit.record});
      if (!model_.scene.empty()) node.rows.push_back({"  geometry", geometryText(hit)});
      diagnostics.insert(diagnostics.end(), hit.diagnostics.begin(), hit.diagnostics.end());
    }
    for (const auto& stage : {first.closestHit, first.anyHit, first.intersection})
      if (stage)
        diagnostics.insert(diagnostics.end(), model_.stages[*stage].diagnostics.begin(),
                           model_.stages[*stage].diagnostics.end());
    node.ids = idsOf(diagnostics);
    const std::size_t index = add(std::move(node));
    for (const HitUse& other : uses) hitNodes_[other] = index;
    if (first.closestHit && use.withoutClosestHit.empty()) stageNodes_[*first.closestHit].push_back(index);
  }

  static std::string bindingText(const PipelineModel::Hit& hit) {
    return fmt::format(": {}", fmt::join(hit.binding, ", "));
  }

  static std::string geometryText(const PipelineModel::Hit& hit) {
    if (hit.geometry.empty()) return "none in the scene";
    const std::size_t shown = std::min(hit.geometry.size(), kMaxNames);
    std::string text = fmt::format(
        "{}", fmt::join(hit.geometry.begin(), hit.geometry.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
    if (shown < hit.geometry.size()) text += fmt::format(" and {} more", hit.geometry.size() - shown);
    return text;
  }

  void addRecords(const std::vector<PipelineModel::Record>& records, NodeKind kind,
                  std::map<std::size_t, std::size_t>& nodes) {
    const char* noun = kind == NodeKind::miss ? "miss" : "callable";
    for (std::size_t i = 0; i < records.size(); ++i) {
      const std::optional<std::size_t> stage = records[i].stage;
      const bool reached = stage && model_.stages[*stage].reached;
      DiagramNode node{kind,
                       fmt::format("{} {}{}{}", noun, i, records[i].name.empty() ? "" : " " + records[i].name,
                                   reached ? "" : ", unreachable"),
                       {{"", fileOf(stage)}, {"record", records[i].record}},
                       diagnosticsOf(stage)};
      nodes[i] = add(std::move(node));
      if (stage) stageNodes_[*stage].push_back(nodes[i]);
    }
  }

  template <class Site>
  void connect(const std::vector<Site>& sites, const Indices& nodes) {
    for (std::size_t i = 0; i < sites.size(); ++i) {
      for (const std::size_t source : stageNodes_[sites[i].stage])
        diagram_.edges.push_back({source, nodes[i], {}, true, {}});
      std::map<std::size_t, DiagramEdge> edges;  // by node
      for (const PipelineModel::Target& target : sites[i].targets) {
        const std::size_t node = nodeOf(sites[i], target);
        DiagramEdge& edge =
            edges.try_emplace(node, DiagramEdge{nodes[i], node, onlyRay(sites[i]), false, {}}).first->second;
        edge.exact = edge.exact || target.exact;
        if (edge.ids.empty()) edge.ids = idsOf(target.diagnostics);
      }
      for (auto& [node, edge] : edges) diagram_.edges.push_back(std::move(edge));
    }
  }

  std::size_t nodeOf(const PipelineModel::Trace& trace, const PipelineModel::Target& target) const {
    return target.role == Role::miss ? missNodes_.at(target.index) : hitNodes_.at(useOf(trace, target.index));
  }
  std::size_t nodeOf(const PipelineModel::Call&, const PipelineModel::Target& target) const {
    return callableNodes_.at(target.index);
  }

  static std::optional<std::size_t> onlyRay(const PipelineModel::Trace& trace) {
    return trace.rays.size() == 1 ? std::optional(trace.rays.front()) : std::nullopt;
  }
  static std::optional<std::size_t> onlyRay(const PipelineModel::Call&) { return {}; }

  const PipelineModel& model_;
  Diagram diagram_;
  Indices traceNodes_, callNodes_;
  std::map<HitUse, std::size_t> hitNodes_;
  std::map<std::size_t, std::size_t> missNodes_, callableNodes_;  // index in the model -> node
  std::map<std::size_t, Indices> stageNodes_;                     // that run the stage
};

std::string dotString(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result + "\"";
}

}  // namespace

std::string_view fillColor(NodeKind kind) {
  switch (kind) {
    case NodeKind::rayGeneration: return "#d6e6f7";
    case NodeKind::trace:
    case NodeKind::call: break;
    case NodeKind::miss: return "#ececec";
    case NodeKind::hit: return "#dcefdc";
    case NodeKind::callable: return "#eadff2";
  }
  return "#ffffff";
}

Diagram diagramOf(const PipelineModel& model) { return DiagramBuilder(model).build(); }

std::string dotText(const Diagram& diagram) {
  constexpr std::string_view kHighlight = "color=\"#c8102e\", penwidth=2.5";
  // "\l" ends a line that is aligned to the left, so it must not be escaped.
  const auto lines = [](const std::vector<std::string>& texts) {
    std::string label;
    for (const std::string& text : texts) {
      const std::string escaped = dotString(text);
      label += escaped.substr(1, escaped.size() - 2) + "\\l";
    }
    return label;
  };
  std::vector<std::string> head{diagram.title};
  head.insert(head.end(), diagram.facts.begin(), diagram.facts.end());
  std::string text = fmt::format(
      "digraph pipeline {{\n  rankdir=LR;\n  labelloc=t;\n  labeljust=l;\n  label=\"{}\";\n"
      "  node [shape=box, style=\"filled\", fontname=\"monospace\", fontsize=10];\n  edge [fontsize=10];\n",
      lines(head));
  for (std::size_t i = 0; i < diagram.nodes.size(); ++i) {
    const DiagramNode& node = diagram.nodes[i];
    std::vector<std::string> rows{node.title};
    for (const DiagramNode::Row& row : node.rows)
      rows.push_back(row.label.empty() ? row.text : row.label + ": " + row.text);
    if (!node.ids.empty()) rows.push_back(node.ids);
    text += fmt::format("  n{} [label=\"{}\", fillcolor=\"{}\"{}{}];\n", i, lines(rows), fillColor(node.kind),
                        node.ids.empty() ? "" : ", ", node.ids.empty() ? "" : kHighlight);
  }
  for (const DiagramEdge& edge : diagram.edges) {
    std::vector<std::string> attributes;
    if (edge.ray) attributes.push_back("tooltip=" + dotString(diagram.rays[*edge.ray]));
    if (!edge.exact) attributes.emplace_back("style=dashed");
    if (!edge.ids.empty()) attributes.push_back(fmt::format("{}, label={}", kHighlight, dotString(edge.ids)));
    text += fmt::format("  n{} -> n{} [{}];\n", edge.from, edge.to, fmt::join(attributes, ", "));
  }
  return text + "}\n";
}

}  // namespace quintet::check
