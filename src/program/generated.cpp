#include "program/generated.h"

#include <fmt/format.h>

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

// kChoice_NAME_VALUE
std::string choicesOf(std::string_view kind, const std::vector<Parameter>& fields) {
  std::string text;
  for (const Parameter& field : fields)
    for (std::size_t i = 0; i < field.choices.size(); ++i)
      text += constant(kind, fmt::format("{}_{}", field.name, field.choices[i]), i);
  return text;
}

}  // namespace

std::string generatedConstants(const Program& program) {
  const std::vector<MissShader> misses = missShaders(program);
  std::string text =
      "// Generated from program.toml.\n#ifndef QUINTET_GENERATED_PROGRAM\n#define QUINTET_GENERATED_PROGRAM\n"
      "#extension GL_EXT_scalar_block_layout : require\n#extension GL_EXT_buffer_reference : require\n";
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
      "#define parameters ParametersReference(launch.parameters).value\n#endif\n";
  return text;
}

std::string generatedRecord(const Program& program) {
  if (program.record.empty()) return "#error the program declares no record, so its shaders cannot read one\n";
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

}  // namespace quintet::program
