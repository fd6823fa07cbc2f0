// SPDX-License-Identifier: Apache-2.0
#include "program/frame_dependence.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "program/lecture/text.h"
#include "shader/include_resolver.h"

namespace quintet::program {
namespace {

// frameSize is the same in all frames.
constexpr std::array<std::string_view, 6> kNamesOfFrames{"frameID",      "gsnGetPreviousPixel", "clockARB",
                                                         "clock2x32ARB", "clockRealtimeEXT",    "clockRealtime2x32EXT"};

bool isNameOfFrame(std::string_view word) { return std::ranges::find(kNamesOfFrames, word) != kNamesOfFrames.end(); }

// A macro can contain the name, or join it from two parts.
bool definesFrame(std::string_view directive) {
  if (directive.find("##") != directive.npos) return true;
  const std::string_view rest = directiveOf(directive).rest;
  return std::ranges::any_of(tokenize(rest), [&](const Token& token) {
    return token.kind == TokenKind::word && isNameOfFrame(textOf(rest, token));
  });
}

bool usesFrame(const std::string& text, const Program& program) {
  for (const Token& token : tokenize(text)) {
    if (token.inactive) continue;
    if (token.kind == TokenKind::word && isNameOfFrame(textOf(text, token))) return true;
    if (token.kind == TokenKind::directive && definesFrame(textOf(text, token))) return true;
  }
  // Stages of the lecture form include the predeclared names and the inputs. Other files of the library are not read here.
  return std::ranges::any_of(shader::findIncludes(text), [&](const shader::IncludeDirective& include) {
    const std::string name = std::filesystem::path(include.name).lexically_normal().generic_string();
    const bool isOfForm = name.starts_with("quintet/gsn") || name.starts_with("quintet/generated/");
    return !isOfForm && !program.files.contains(name);
  });
}

}  // namespace

bool framesCanDiffer(const Program& program) {
  return program.accumulation != Accumulation::program || std::ranges::any_of(program.files, [&](const auto& file) {
           return !file.first.ends_with(".toml") && usesFrame(file.second, program);
         });
}

}  // namespace quintet::program
