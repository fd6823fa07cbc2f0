// SPDX-License-Identifier: Apache-2.0
#include "check/swapped_arguments.h"

#include <fmt/format.h>

#include <spirv/unified1/GLSL.std.450.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "spirv/source_text.h"
#include "spirv/trace_instruction.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

using spv::Op;

constexpr int kMaxSteps = 8;

// The bits of which Vulkan allows at most one: VUID-RuntimeSpirv-OpTraceRayKHR-06892 to 06894.
bool contradicts(std::uint32_t flags) {
  constexpr std::uint32_t kOpacity = 1 | 2 | 64 | 128, kTriangles = 256 | 16 | 32, kGeometry = 256 | 512;
  const auto several = [](std::uint32_t bits) { return (bits & (bits - 1)) != 0; };
  return several(flags & kOpacity) || several(flags & kTriangles) || several(flags & kGeometry);
}

bool mentions(const std::string& argument, std::string_view prefix) {
  for (std::size_t at = argument.find(prefix); at != argument.npos; at = argument.find(prefix, at + 1))
    if (at == 0 || !spirv::isWordCharacter(argument[at - 1])) return true;
  return false;
}

const spirv::Instruction* original(const spirv::Module& module, spirv::Id value) {
  const spirv::Instruction* definition = module.definition(value);
  for (int i = 0; definition && definition->op == Op::OpCopyObject && i < kMaxSteps; ++i)
    definition = module.definition(definition->at(0));
  return definition;
}

// True for a unit vector: normalize(…) or reflect(…) of a ray direction.
bool isDirection(const spirv::Module& module, spirv::Id value) {
  const spirv::Instruction* i = original(module, value);
  for (int depth = 0; i && depth < kMaxSteps && spirv::isExtended(module, *i, GLSLstd450Reflect); ++depth)
    i = original(module, i->at(2));
  return i && (spirv::isExtended(module, *i, GLSLstd450Normalize) ||
               spirv::loadsBuiltIn(module, *i, spv::BuiltIn::WorldRayDirectionKHR));
}

// True for gl_WorldRayOriginEXT, alone or plus t * gl_WorldRayDirectionEXT.
bool isPosition(const spirv::Module& module, spirv::Id value) {
  const auto isStep = [&](spirv::Id part) {
    const spirv::Instruction* step = original(module, part);
    return step && step->op == Op::OpVectorTimesScalar && isDirection(module, step->at(0));
  };
  const spirv::Instruction* i = original(module, value);
  for (int depth = 0; i && depth < kMaxSteps && i->op == Op::OpFAdd; ++depth) {
    const std::size_t step = isStep(i->at(1)) ? 1 : 0;
    if (!isStep(i->at(step))) return false;
    i = original(module, i->at(1 - step));
  }
  return i && spirv::loadsBuiltIn(module, *i, spv::BuiltIn::WorldRayOriginKHR);
}

// True for the direction of a pinhole camera: normalize(vec3(x, y, -2.0)), with the distance of the image plane.
bool isCameraDirection(const spirv::StageFacts& facts, spirv::Id value) {
  const spirv::Module& module = facts.module();
  const spirv::Instruction* i = original(module, value);
  if (!i || !spirv::isExtended(module, *i, GLSLstd450Normalize)) return false;
  for (std::uint32_t c = 0; c < 3; ++c)
    if (const auto component = facts.ranges().range(i->at(2), {c}).constant(); component && *component != 0.0)
      return true;
  return false;
}

// True for a constant vector whose length is not 1.
bool isConstantNotUnit(const spirv::StageFacts& facts, spirv::Id value) {
  double square = 0.0;
  for (std::uint32_t c = 0; c < 3; ++c) {
    const std::optional<double> component = facts.ranges().range(value, {c}).constant();
    if (!component) return false;
    square += *component * *component;
  }
  return square > 0.0 && std::abs(std::sqrt(square) - 1.0) > 0.01;
}

std::string_view functionOf(const spirv::TraceFacts& trace) {
  return trace.part == spirv::TracePart::whole ? "traceRayEXT" : "the trace";
}

std::string flagsAndMask(const spirv::TraceFacts& trace, const std::vector<std::string>& arguments) {
  std::string text =
      fmt::format("ray flags and cull mask of this trace are swapped: {} expects the flags first", functionOf(trace));
  if (trace.flags.exact() && trace.mask.exact())
    text +=
        fmt::format(", but the flags are {:#x} and the mask is {:#04x}", trace.flags.values[0], trace.mask.values[0]);
  else if (!arguments.empty())
    text += fmt::format(", but the mask is {}", arguments[2]);
  return text;
}

}  // namespace

std::vector<std::string> callArguments(std::string_view text, int line, int column) {
  const std::string_view first = spirv::lineOf(text, line);
  if (line < 1 || column < 1 || first.empty()) return {};
  std::size_t at = static_cast<std::size_t>(first.data() - text.data()) + static_cast<std::size_t>(column) - 1;
  while (at < text.size() && spirv::isWordCharacter(text[at])) ++at;
  while (at < text.size() && std::string_view(" \t\r\n").find(text[at]) != std::string_view::npos) ++at;
  if (at >= text.size() || text[at] != '(') return {};
  std::vector<std::string> arguments(1);
  const auto trim = [](std::string& argument) {
    const std::size_t begin = argument.find_first_not_of(" \t\r\n"), end = argument.find_last_not_of(" \t\r\n");
    argument = begin == argument.npos ? "" : argument.substr(begin, end - begin + 1);
  };
  int depth = 0;
  for (; at < text.size() && arguments.size() < 32; ++at) {
    const std::string_view rest = text.substr(at);
    if (rest.starts_with("//") || rest.starts_with("/*")) {
      const std::size_t end = rest.starts_with("//") ? rest.find('\n') : rest.find("*/", 2);
      if (end == rest.npos) return {};
      at += end + (rest.starts_with("//") ? 0 : 1);
      continue;
    }
    const char c = text[at];
    if (c == ';' || c == '{' || c == '#') return {};
    if (c == '(' || c == '[') ++depth;
    if (c == ')' || c == ']') --depth;
    if (depth == 0) {
      for (std::string& argument : arguments) trim(argument);
      return arguments;
    }
    if (depth == 1 && c == ',')
      arguments.emplace_back();
    else if (depth > 1 || c != '(')
      arguments.back() += c;
  }
  return {};
}

SwappedArguments findSwappedArguments(const spirv::StageFacts& facts, const spirv::TraceFacts& trace,
                                      std::size_t rayCount) {
  SwappedArguments result{{}, trace};
  const auto source = std::ranges::find(facts.traces(), trace.ray, &spirv::TraceFacts::instruction);
  if (trace.ray == spirv::Module::kNone || source == facts.traces().end()) return result;
  const spirv::Module& module = facts.module();
  const spirv::Instruction& call = module.instructions()[source->instruction];
  const std::optional<spirv::RayOperands> ray = spirv::rayOperands(call);
  std::vector<std::string> arguments =
      callArguments(module.source(source->location.file), source->location.line, source->location.column);
  constexpr std::size_t kArguments = 11;
  if (source->part == spirv::TracePart::search && arguments.size() > kArguments)  // the hit object, hints at the end
    arguments.erase(arguments.begin()), arguments.resize(kArguments);
  if (arguments.size() != kArguments || !ray) arguments.clear();
  const bool named = !arguments.empty();

  constexpr std::string_view kFlag = "gl_RayFlags";
  const bool flagsNamed = named && mentions(arguments[1], kFlag), maskNamed = named && mentions(arguments[2], kFlag);
  const bool byValue = !flagsNamed && trace.flags.exact() && trace.mask.exact() && trace.flags.values[0] == 0xFFu &&
                       !contradicts(trace.mask.values[0]);
  const bool byName = maskNamed && !flagsNamed && trace.flags.exact() && trace.flags.values[0] != 0;
  if (byValue || byName) {
    result.texts.push_back(flagsAndMask(*source, arguments));
    std::swap(result.intended.flags, result.intended.mask);
  }

  // With several ray types, the stride is out of range as an offset.
  const bool records = trace.offset.exact() && trace.stride.exact();
  const bool nameOrder = named && arguments[3] == "kRayTypeCount" && mentions(arguments[4], "kRay_");
  const bool valueOrder = records && rayCount > 1 && trace.offset.values[0] == rayCount &&
                          trace.stride.values[0] < rayCount && trace.stride.values[0] != 0;
  if (nameOrder || valueOrder) {
    std::string text =
        fmt::format("offset and stride of this trace are swapped: {} expects the offset first", functionOf(*source));
    if (records)
      text +=
          fmt::format(", but the offset is {} and the stride is {}", trace.offset.values[0], trace.stride.values[0]);
    result.texts.push_back(text);
    std::swap(result.intended.offset, result.intended.stride);
  }

  if (ray && ((isPosition(module, ray->direction) && isDirection(module, ray->origin)) ||
              (isCameraDirection(facts, ray->origin) && isConstantNotUnit(facts, ray->direction))))
    result.texts.push_back(
        "origin and direction of this trace are swapped: the origin is a unit vector, and the direction is a position");
  return result;
}

}  // namespace quintet::check
