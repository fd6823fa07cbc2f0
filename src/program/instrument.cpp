// SPDX-License-Identifier: Apache-2.0
#include "program/instrument.h"

#include <fmt/format.h>

#include <string_view>

#include "base/text.h"

namespace quintet::program {
namespace {

int kindOf(shader::Stage stage) {
  switch (stage) {
    case shader::Stage::rayGeneration: return 0;
    case shader::Stage::closestHit: return 1;
    case shader::Stage::anyHit: return 2;
    case shader::Stage::miss: return 3;
    case shader::Stage::intersection: return 4;
    default: return 5;
  }
}

// QUINTET_HEAT_KIND
int heatKindOf(shader::Stage stage) {
  switch (stage) {
    case shader::Stage::rayGeneration: return 0;
    case shader::Stage::anyHit: return 1;
    case shader::Stage::intersection: return 2;
    default: return 3;
  }
}

// The lines that must stay first: those up to the last of the leading #version and #extension lines, with the comments and
// blank lines between them.
struct Head {
  std::size_t bytes = 0;
  int lines = 0;
};

Head findHead(std::string_view source) {
  Head head;
  bool inComment = false;
  std::size_t at = 0;
  for (int line = 1; at < source.size(); ++line) {
    const std::size_t newline = source.find('\n', at);
    const std::size_t end = newline == source.npos ? source.size() : newline + 1;
    const std::string_view text = trimmed(source.substr(at, end - at));
    at = end;
    if (inComment) {
      inComment = text.find("*/") == text.npos;
      continue;
    }
    if (text.empty() || text.starts_with("//")) continue;
    if (text.starts_with("/*")) {
      inComment = text.find("*/", 2) == text.npos;
      continue;
    }
    if (!text.starts_with("#version") && !text.starts_with("#extension")) break;
    head = {end, line};
  }
  return head;
}

bool includesLectureForm(const std::string& source) {
  return source.find("#include <quintet/gsn.glsl>") != source.npos;
}

// Inserts text after the head. Messages keep their line numbers.
std::string insertAfterHead(const std::string& source, const std::string& text) {
  const Head head = findHead(source);
  std::string result = source.substr(0, head.bytes);
  if (!result.empty() && result.back() != '\n') result += '\n';
  return result + text + fmt::format("#line {}\n", head.lines + 1) + source.substr(head.bytes);
}

// The lines that include files of the library. The front end of the lecture form includes the files itself.
std::string includeLines(const std::string& source, const std::string& includes, bool usesLibrary) {
  if (includesLectureForm(source)) return {};
  if (usesLibrary) return includes;
  return "#include <quintet/names_begin.glsl>\n" + includes + "#include <quintet/names_end.glsl>\n";
}

}  // namespace

std::string probedStage(const std::string& source, shader::Stage stage, Probes probes, bool accumulates,
                        bool usesLibrary) {
  std::string defines, includes, before, after;
  if (probes.prints) {
    defines += "#define QUINTET_PRINT 1\n";
    includes += "#include <quintet/print.glsl>\n";
    before += "  printKeep_();\n";
  }
  if (probes.heat) {
    defines += fmt::format("#define QUINTET_HEAT 1\n#define QUINTET_HEAT_KIND {}\n", heatKindOf(stage));
    if (accumulates) defines += "#define QUINTET_HEAT_STORES 1\n";
    includes += "#include <quintet/heat.glsl>\n";
    before += "  heatKeep_();\n  heatBegin_();\n";
    after = "  heatEnd_();\n";
  }
  if (probes.values) {
    defines += "#define QUINTET_VALUES 1\n";
    includes += "#include <quintet/values.glsl>\n";
    before += "  valuesKeep_();\n";
  }
  return insertAfterHead(source, defines + includeLines(source, includes, usesLibrary) + "#define main probedMain_\n") +
         "\n#undef main\nvoid main() {\n" + before + "  probedMain_();\n" + after + "}\n";
}

std::string instrumentStage(const std::string& source, shader::Stage stage, std::size_t index,
                            Instrumentation instrumentation, bool usesLibrary) {
  const bool wraps = instrumentation == Instrumentation::checks || instrumentation == Instrumentation::explain;
  const bool traces =
      stage == shader::Stage::rayGeneration || stage == shader::Stage::closestHit || stage == shader::Stage::miss;
  if (!wraps && !(traces && instrumentation == Instrumentation::recursion)) return source;
  const bool explain = instrumentation == Instrumentation::explain;
  std::string inserted;
  if (wraps)
    inserted = fmt::format("#define QUINTET_{0} 1\n#define QUINTET_{0}_STAGE {1}u\n#define QUINTET_{0}_KIND {2}\n",
                           explain ? "EXPLAIN" : "INSTRUMENT", index, kindOf(stage));
  else
    inserted = "#define QUINTET_RECURSION 1\n";
  if (!wraps && stage == shader::Stage::rayGeneration) inserted += "#define QUINTET_RECURSION_START 1\n";
  const std::string include = fmt::format("#include <quintet/{}.glsl>\n", explain ? "explain"
                                                                          : wraps ? "instrument"
                                                                                  : "recursion");
  inserted += includeLines(source, include, usesLibrary);
  std::string result = insertAfterHead(source, inserted);
  if (!wraps) return result;
  result += "\n#undef main\nvoid main() {\n";
  result += explain ? "  if (explainBegin_()) {\n    explainedMain_();\n    explainEnd_(0u);\n  }\n"
                    : "  if (instrumentBegin_()) instrumentedMain_();\n";
  return result + "}\n";
}

}  // namespace quintet::program
