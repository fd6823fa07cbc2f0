// SPDX-License-Identifier: Apache-2.0
// The pipeline as a drawing: boxes with rows of text, connected by arrows. Shaders are boxes with the records that run
// them; traces and calls are boxes with their arguments. Hit groups with the same shaders share a box.
#ifndef QUINTET_CHECK_DIAGRAM_DIAGRAM_H
#define QUINTET_CHECK_DIAGRAM_DIAGRAM_H

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "check/diagram/pipeline_model.h"

namespace quintet::check {

enum class NodeKind { rayGeneration, trace, call, miss, hit, callable };

struct DiagramNode {
  struct Row {
    std::string label;  // can be empty
    std::string text;
  };
  NodeKind kind = NodeKind::trace;
  std::string title;
  std::vector<Row> rows;
  std::string ids;  // of diagnostics, "Q101, Q104"; empty if there are none
};

// Color of the boxes of a kind of nodes.
std::string_view fillColor(NodeKind kind);

struct DiagramEdge {
  std::size_t from = 0, to = 0;    // nodes
  std::optional<std::size_t> ray;  // the only ray type of the trace
  bool exact = true;               // false if the arguments of the trace are not constant
  std::string ids;                 // of diagnostics
};

struct Diagram {
  std::string title;               // of the program
  std::vector<std::string> facts;  // lines below the title
  std::vector<DiagramNode> nodes;
  std::vector<DiagramEdge> edges;
  std::vector<std::string> rays;         // names, for the legend
  std::vector<std::string> diagnostics;  // one line each
};

Diagram diagramOf(const PipelineModel& model);

// Returns the text of a graph for Graphviz.
std::string dotText(const Diagram& diagram);

}  // namespace quintet::check
#endif
