// SPDX-License-Identifier: Apache-2.0
#include "check/diagram/svg.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/text.h"
#include "base/wrap.h"
#include "check/diagram/layered_layout.h"

namespace quintet::check {
namespace {

// Pixels. Monospaced fonts have an advance of at most 0.61 of their size.
constexpr double kFont = 12, kCharacter = 0.61 * kFont, kLine = 16, kPadding = 8, kPageMargin = 20;
constexpr std::size_t kTextColumns = 46;  // rows of boxes break here
constexpr double kMinWidth = 560;         // of the image, for the diagnostics

constexpr const char* kInk = "#1b1f24";
constexpr const char* kFaint = "#57606a";
constexpr const char* kHighlight = "#c8102e";
// Colors of ray types: dark enough on white, and different for people with color vision deficiencies (after Okabe and
// Ito, "Color Universal Design", 2008).
constexpr std::array kRayColors{"#0067a3", "#b35900", "#00795a", "#7a4b94", "#5c6b00", "#3d4f9f"};
constexpr const char* kNeutral = "#57606a";

const char* rayColor(std::optional<std::size_t> ray) { return ray ? kRayColors[*ray % kRayColors.size()] : kNeutral; }

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : printable(text)) {
    switch (c) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      case '"': result += "&quot;"; break;
      default: result += c;
    }
  }
  return result;
}

std::string textAt(double x, double y, std::string_view text, const char* color = kInk, bool bold = false) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"{}\"{}>{}</text>\n", x, y, color,
                     bold ? " font-weight=\"bold\"" : "", escaped(text));
}

// As wrapText(), but words that are too long are split.
std::vector<std::string> linesOf(std::string_view text, std::size_t columns) {
  std::vector<std::string> result;
  for (std::string line : wrapText(printable(text), columns)) {
    while (columnsOf(line) > columns) {
      std::size_t end = columns;
      while (end < line.size() && (line[end] & 0xC0) == 0x80) ++end;
      result.push_back(line.substr(0, end));
      line.erase(0, end);
    }
    result.push_back(std::move(line));
  }
  return result;
}

// A node with its lines of text.
struct Box {
  struct Line {
    std::string label, text;
    std::size_t column = 0;  // of the text
  };
  std::vector<std::string> title;
  std::vector<Line> lines;
  std::size_t labelColumns = 0;
  LayoutSize size;

  explicit Box(const DiagramNode& node) : title(linesOf(node.title, kTextColumns)) {
    for (const DiagramNode::Row& row : node.rows) labelColumns = std::max(labelColumns, columnsOf(row.label));
    std::size_t columns = 0;
    for (const std::string& line : title) columns = std::max(columns, columnsOf(line));
    for (const DiagramNode::Row& row : node.rows) {
      std::string label = row.label;
      const std::size_t column = label.empty() || labelColumns == 0 ? 0 : labelColumns + 1;
      for (std::string& line : linesOf(row.text, kTextColumns)) {
        columns = std::max(columns, column + columnsOf(line));
        lines.push_back({std::exchange(label, ""), std::move(line), column});
      }
    }
    if (!node.ids.empty()) columns = std::max(columns, columnsOf(node.ids) + 2);
    const std::size_t rows = title.size() + lines.size() + (node.ids.empty() ? 0 : 1);
    size.width = static_cast<double>(columns) * kCharacter + 2 * kPadding;
    size.height = static_cast<double>(rows) * kLine + 2 * kPadding;
  }
};

class Drawing {
 public:
  explicit Drawing(const Diagram& diagram) : diagram_(diagram) {
    std::vector<LayoutSize> sizes;
    for (const DiagramNode& node : diagram.nodes) {
      boxes_.emplace_back(node);
      sizes.push_back(boxes_.back().size);
    }
    std::vector<LayoutEdge> edges;
    for (const DiagramEdge& edge : diagram.edges) edges.push_back({edge.from, edge.to});
    layout_ = layoutLayers(sizes, edges);
  }

  std::string run() {
    width_ = std::max(layout_.size.width, kMinWidth) + 2 * kPageMargin;
    drawHead();
    top_ = y_;
    std::string highlights;  // on top of all others
    for (std::size_t i = 0; i < diagram_.edges.size(); ++i)
      (diagram_.edges[i].ids.empty() ? body_ : highlights) += edge(i);
    body_ += highlights;
    for (std::size_t i = 0; i < boxes_.size(); ++i) drawBox(i);
    for (std::size_t i = 0; i < diagram_.edges.size(); ++i) drawEdgeLabel(i);
    y_ = top_ + layout_.size.height + 1.5 * kLine;
    drawDiagnostics();
    return document();
  }

 private:
  void drawHead() {
    y_ = kPageMargin + kLine;
    body_ += fmt::format("<text x=\"{}\" y=\"{:.1f}\" fill=\"{}\" font-weight=\"bold\" font-size=\"16\">{}</text>\n",
                         kPageMargin, y_, kInk, escaped(diagram_.title));
    for (const std::string& fact : diagram_.facts) body_ += textAt(kPageMargin, y_ += kLine, fact, kFaint);
    y_ += 1.5 * kLine;
    double x = kPageMargin;
    const auto entry = [&](std::string_view label, const char* color, bool dashed, double thickness) {
      const double width = 30 + static_cast<double>(columnsOf(label)) * kCharacter;
      if (x > kPageMargin && x + width > width_ - kPageMargin) x = kPageMargin, y_ += kLine;
      body_ += fmt::format("<path d=\"M{:.1f} {:.1f}h22\" stroke=\"{}\" stroke-width=\"{}\"{}/>\n", x, y_ - 4, color,
                           thickness, dashed ? " stroke-dasharray=\"5 4\"" : "");
      body_ += textAt(x + 28, y_, label, kFaint);
      x += width + 20;
    };
    for (std::size_t ray = 0; ray < diagram_.rays.size(); ++ray)
      entry("ray type " + diagram_.rays[ray], rayColor(ray), false, 2);
    if (std::ranges::any_of(diagram_.edges, [](const DiagramEdge& e) { return !e.exact; }))
      entry("possible, arguments are not constant", kNeutral, true, 2);
    if (!diagram_.diagnostics.empty()) entry("diagnostic", kHighlight, false, 3);
    y_ += kLine;
  }

  LayoutPoint shifted(LayoutPoint p) const { return {p.x + kPageMargin, p.y + top_}; }

  std::string edge(std::size_t index) const {
    const DiagramEdge& e = diagram_.edges[index];
    const std::vector<LayoutPoint>& points = layout_.edges[index];
    const LayoutPoint start = shifted(points.front());
    std::string path = fmt::format("M{:.1f} {:.1f}", start.x, start.y);
    for (std::size_t i = 1; i < points.size(); ++i) {
      const LayoutPoint a = shifted(points[i - 1]), b = shifted(points[i]);
      const double middle = 0.5 * (a.x + b.x);
      path += i % 2 == 1 ? fmt::format("C{:.1f} {:.1f} {:.1f} {:.1f} {:.1f} {:.1f}", middle, a.y, middle, b.y, b.x, b.y)
                         : fmt::format("H{:.1f}", b.x);
    }
    const char* color = e.ids.empty() ? rayColor(e.ray) : kHighlight;
    return fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{} marker-end=\"url(#a{})\"/>\n",
                       path, color, e.ids.empty() ? "1.5" : "3", e.exact ? "" : " stroke-dasharray=\"5 4\"",
                       std::string_view(color).substr(1));
  }

  // The ids of a highlighted edge, on a white patch in the middle of its last curve.
  void drawEdgeLabel(std::size_t index) {
    const std::string& ids = diagram_.edges[index].ids;
    if (ids.empty()) return;
    const std::vector<LayoutPoint>& points = layout_.edges[index];
    const LayoutPoint a = shifted(points[points.size() - 2]), b = shifted(points.back());
    const double width = static_cast<double>(columnsOf(ids)) * kCharacter + 6;
    const LayoutPoint middle{0.5 * (a.x + b.x), 0.5 * (a.y + b.y)};
    body_ += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"16\" rx=\"3\" fill=\"#ffffff\" stroke=\"{}\"/>\n",
        middle.x - 0.5 * width, middle.y - 8, width, kHighlight);
    body_ += textAt(middle.x - 0.5 * width + 3, middle.y + 4, ids, kHighlight, true);
  }

  void drawBox(std::size_t index) {
    const DiagramNode& node = diagram_.nodes[index];
    const Box& box = boxes_[index];
    const LayoutPoint at = shifted(layout_.nodes[index]);
    const bool marked = !node.ids.empty();
    const bool site = node.kind == NodeKind::trace || node.kind == NodeKind::call;
    body_ += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" rx=\"{}\" fill=\"{}\" stroke=\"{}\" "
        "stroke-width=\"{}\"/>\n",
        at.x, at.y, box.size.width, box.size.height, site ? 10 : 3, fillColor(node.kind), marked ? kHighlight : kFaint,
        marked ? 3 : 1);
    double y = at.y + kPadding - 4;
    for (const std::string& line : box.title) body_ += textAt(at.x + kPadding, y += kLine, line, kInk, true);
    for (const Box::Line& line : box.lines) {
      y += kLine;
      // Spaces at the start of a label are an indentation.
      const std::size_t indent = std::min(line.label.find_first_not_of(' '), line.label.size());
      if (!line.label.empty())
        body_ +=
            textAt(at.x + kPadding + static_cast<double>(indent) * kCharacter, y, line.label.substr(indent), kFaint);
      body_ += textAt(at.x + kPadding + static_cast<double>(line.column) * kCharacter, y, line.text);
    }
    if (marked) body_ += textAt(at.x + kPadding, y + kLine, node.ids, kHighlight, true);
  }

  void drawDiagnostics() {
    const auto columns = static_cast<std::size_t>((width_ - 2 * kPageMargin) / kCharacter);
    for (const std::string& diagnostic : diagram_.diagnostics)
      for (const std::string& line : linesOf(diagnostic, columns))
        body_ += textAt(kPageMargin, y_ += kLine, line, kHighlight);
  }

  std::string document() const {
    std::string markers;
    std::vector<std::string_view> colors(kRayColors.begin(), kRayColors.end());
    colors.insert(colors.end(), {kNeutral, kHighlight});
    for (const std::string_view color : colors)
      markers += fmt::format(
          "<marker id=\"a{}\" viewBox=\"0 0 10 10\" refX=\"9\" refY=\"5\" markerWidth=\"9\" markerHeight=\"9\" "
          "markerUnits=\"userSpaceOnUse\" orient=\"auto\"><path d=\"M0 0L10 5L0 10z\" fill=\"{}\"/></marker>\n",
          color.substr(1), color);
    const double height = y_ + kPageMargin;
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} "
        "{1:.0f}\" "
        "font-family=\"ui-monospace, Menlo, Consolas, 'DejaVu Sans Mono', 'Liberation Mono', monospace\" "
        "font-size=\"{2}\">\n<title>{3}</title>\n<defs>\n{4}</defs>\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{5}</svg>\n",
        width_, height, kFont, escaped(diagram_.title), markers, body_);
  }

  const Diagram& diagram_;
  std::vector<Box> boxes_;
  Layout layout_;
  double width_ = 0, top_ = 0, y_ = 0;
  std::string body_;
};

}  // namespace

std::string svgText(const Diagram& diagram) { return Drawing(diagram).run(); }

}  // namespace quintet::check
