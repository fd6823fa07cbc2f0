#include "program/glsl_names.h"

#include <algorithm>
#include <cctype>
#include <regex>
#include <set>
#include <string_view>

namespace quintet::program {
namespace {

// GLSL 4.60, 3.6, without the families that isTypeName knows.
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

bool isIdentifier(const std::string& name) {
  const auto word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
  return !name.empty() && name.size() <= 128 && !std::isdigit(static_cast<unsigned char>(name[0])) &&
         std::all_of(name.begin(), name.end(), word) && !name.starts_with("gl_") &&
         name.find("__") == std::string::npos;
}

bool isReservedWord(const std::string& name) { return words().contains(name) || isTypeName(name); }

}  // namespace quintet::program
