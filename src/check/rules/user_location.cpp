// SPDX-License-Identifier: Apache-2.0
#include "check/rules/user_location.h"

#include <algorithm>

#include "spirv/source_text.h"
#include "spirv/trace_instruction.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

constexpr std::size_t kMaxCallerSteps = 64;

struct FunctionText {
  std::string_view name;
  int first = 0, last = 0;  // lines
};

// Offset behind a comment that starts at `at`; `at` itself if none does.
std::size_t skipComment(std::string_view text, std::size_t at) {
  const std::string_view rest = text.substr(at, 2);
  if (rest == "//") return std::min(text.find('\n', at), text.size());
  if (rest != "/*") return at;
  const std::size_t end = text.find("*/", at + 2);
  return end == text.npos ? text.size() : end + 2;
}

// Finds the function whose body has the line: the word before the parentheses in front of its braces.
std::optional<FunctionText> functionAround(std::string_view text, int line) {
  FunctionText found;
  std::string_view word, called;
  int depth = 0, now = 1;
  for (std::size_t at = 0; at < text.size();) {
    if (const std::size_t end = skipComment(text, at); end != at) {
      now += static_cast<int>(std::count(text.begin() + static_cast<std::ptrdiff_t>(at),
                                         text.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
      at = end;
      continue;
    }
    if (spirv::isWordCharacter(text[at])) {
      std::size_t end = at;
      while (end < text.size() && spirv::isWordCharacter(text[end])) ++end;
      if (depth == 0) word = text.substr(at, end - at);
      at = end;
      continue;
    }
    const char c = text[at++];
    if (c == '\n') ++now;
    if (c == ';' && depth == 0) called = {};
    if (c == '(' && depth == 0 && called.empty()) called = word;
    if (c == '{' && depth++ == 0) found = {called, now, 0};
    if (c == '}' && --depth == 0) {
      found.last = now;
      if (!found.name.empty() && found.first <= line && line <= found.last) return found;
      called = {};
    }
  }
  return {};
}

}  // namespace

bool isLibrary(const SourceLocation& location) { return location.file.starts_with("<quintet/"); }

SourceLocation locationAt(const spirv::Module& module, const spirv::Instruction& instruction, std::string_view token) {
  const SourceLocation plain = module.location(instruction);
  const bool named = spirv::lineOf(module.source(plain.file), plain.line).find(token) != std::string_view::npos;
  return named ? module.location(instruction, token) : plain;
}

std::optional<SourceLocation> userLocation(const spirv::Module& module, const spirv::Instruction& instruction,
                                           std::string_view token) {
  std::vector<const spirv::Instruction*> open{&instruction};
  for (std::size_t i = 0; i < open.size() && i < kMaxCallerSteps; ++i) {
    const bool trace = spirv::rayOperands(*open[i]).has_value();  // can begin some lines above
    const SourceLocation location = trace    ? module.location(*open[i], token)
                                    : i == 0 ? locationAt(module, *open[i], token)
                                             : module.location(*open[i]);
    if (location.line > 0 && !isLibrary(location)) return location;
    for (const std::size_t user : module.users(open[i]->result))
      if (const spirv::Instruction& next = module.instructions()[user]; std::ranges::find(open, &next) == open.end())
        open.push_back(&next);
  }
  return {};
}

std::optional<SourceLocation> callLocation(const spirv::Module& module, const spirv::Instruction& instruction,
                                           spirv::Id operand) {
  const SourceLocation own = module.location(instruction);
  const std::string_view text = module.source(own.file);
  const auto function = functionAround(text, own.line);
  if (!function || function->name == "main") return {};
  int from = 1;
  (void)spirv::dependsOn(module, operand, [&](const spirv::Instruction& i) {
    const SourceLocation location = module.location(i);
    const bool inside = function->first <= location.line && location.line <= function->last;
    if (location.file == own.file && !inside) from = std::max(from, location.line);
    return false;
  });
  const int last = static_cast<int>(std::ranges::count(text, '\n')) + 1;
  for (int line = from; line <= last; ++line) {
    const std::size_t at = spirv::findToken(spirv::lineOf(text, line), function->name);
    const bool inside = function->first <= line && line <= function->last;
    if (at != std::string_view::npos && !inside) return SourceLocation{own.file, line, static_cast<int>(at) + 1};
  }
  return {};
}

}  // namespace quintet::check
