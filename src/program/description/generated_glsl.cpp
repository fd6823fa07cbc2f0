// SPDX-License-Identifier: Apache-2.0
#include "program/description/generated_glsl.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <regex>
#include <set>
#include <string_view>

namespace quintet::program {
namespace {

std::string constant(std::string_view kind, const std::string& name, std::size_t value) {
  return name.empty() ? "" : fmt::format("const uint k{}{} = {}u;\n", kind, name, value);
}

std::string structOf(std::string_view name, const std::vector<Parameter>& fields) {
  std::string text = fmt::format("struct {} {{\n", name);
  for (const Parameter& field : fields) text += fmt::format("  {} {};\n", glslType(field.type), field.name);
  if (fields.empty()) text += "  uint unused_;\n";
  return text + "};\n";
}

// Constants KIND_NAME_VALUE, such as kChoice_mode_heat.
std::string choicesOf(std::string_view kind, const std::vector<Parameter>& fields) {
  std::string text;
  for (const Parameter& field : fields)
    for (std::size_t i = 0; i < field.choices.size(); ++i)
      text += constant(kind, fmt::format("{}_{}", field.name, field.choices[i]), i);
  return text;
}

// Keywords of GLSL 4.60, 3.6, except the families of types that isTypeName matches.
const std::set<std::string_view>& words() {
  static const std::set<std::string_view> kWords{
      "attribute", "const", "uniform", "varying", "buffer", "shared", "coherent", "volatile", "restrict", "readonly",
      "writeonly", "atomic_uint", "layout", "centroid", "flat", "smooth", "noperspective", "patch", "sample", "break",
      "continue", "do", "for", "while", "switch", "case", "default", "if", "else", "subroutine", "in", "out", "inout",
      "true", "false", "invariant", "precise", "discard", "return", "lowp", "mediump", "highp", "precision", "struct",
      "common", "partition", "active", "asm", "class", "union", "enum", "typedef", "template", "this", "resource",
      "goto", "inline", "noinline", "public", "static", "extern", "external", "interface", "long", "short", "half",
      "fixed", "unsigned", "superp", "input", "output", "filter", "sizeof", "cast", "namespace", "using", "void",
      "bool", "int", "uint", "float", "double",
      // GL_EXT_ray_tracing and GL_EXT_nonuniform_qualifier
      "rayPayloadEXT", "rayPayloadInEXT", "hitAttributeEXT", "callableDataEXT", "callableDataInEXT",
      "accelerationStructureEXT", "shaderRecordEXT", "ignoreIntersectionEXT", "terminateRayEXT", "nonuniformEXT",
      // macros of the shader library
      "frame", "parameters", "Address"};
  return kWords;
}

bool isTypeName(const std::string& name) {
  static const std::regex kTypes(
      "[biudhf]?vec[234]|d?mat[234](x[234])?|[iu]?(sampler|image|texture)(1D|2D|3D|Cube|Buffer)\\w*|"
      "sampler(Shadow)?|[iu]?subpassInput(MS)?|(u?int|float)(8|16|32|64)_t|QT_\\w*");
  return std::regex_match(name, kTypes);
}

}  // namespace

std::string generatedConstants(const Program& program) {
  const std::vector<MissShader> misses = missShaders(program);
  std::string text =
      "// Generated from program.toml.\n#ifndef QUINTET_GENERATED_PROGRAM\n#define QUINTET_GENERATED_PROGRAM\n"
      "#include <quintet/frame.glsl>\n";
  text += constant("", "RayTypeCount", program.rays.size());
  text += constant("", "MissCount", misses.size());
  text += constant("", "CallableCount", program.callables.size());
  text += constant("", "OutputCount", program.outputs.size());
  for (std::size_t i = 0; i < program.rays.size(); ++i) text += constant("Ray_", program.rays[i].name, i);
  for (std::size_t i = 0; i < misses.size(); ++i) text += constant("Miss_", misses[i].name, i);
  for (std::size_t i = 0; i < program.callables.size(); ++i)
    text += constant("Callable_", program.callables[i].name, i);
  for (std::size_t i = 0; i < program.outputs.size(); ++i) text += constant("Output_", program.outputs[i].name, i);
  text += choicesOf("Choice_", program.parameters);
  text += structOf("Parameters", program.parameters);
  text +=
      "layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer ParametersReference { Parameters "
      "value; };\n"
      "#define parameters ParametersReference(launch.parameterAddress).value\n#endif\n";
  return text;
}

std::string generatedRecord(const Program& program) {
  if (program.record.empty()) return "#error the program declares no record fields\n";
  return "// Generated from program.toml: the data of this shader's record.\n"
         "#ifndef QUINTET_GENERATED_RECORD\n#define QUINTET_GENERATED_RECORD\n"
         "#extension GL_EXT_scalar_block_layout : require\n" +
         choicesOf("Record_", program.record) + structOf("Record", program.record) +
         "layout(shaderRecordEXT, scalar) buffer RecordBlock { Record record; };\n#endif\n";
}

std::map<std::string, std::string> generatedFiles(const Program& program) {
  return {{"quintet/generated/program.glsl", generatedConstants(program)},
          {"quintet/generated/record.glsl", generatedRecord(program)}};
}

bool isIdentifier(const std::string& name) {
  const auto word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
  return !name.empty() && name.size() <= 128 && !std::isdigit(static_cast<unsigned char>(name[0])) &&
         std::all_of(name.begin(), name.end(), word) && !name.starts_with("gl_") &&
         name.find("__") == std::string::npos;
}

bool isReservedWord(const std::string& name) { return words().contains(name) || isTypeName(name); }

}  // namespace quintet::program
