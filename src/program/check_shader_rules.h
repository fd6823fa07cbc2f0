// The rules of check_shader.h, one function each, and what they share. Included by check_shader*.cpp alone.
#ifndef QUINTET_PROGRAM_CHECK_SHADER_RULES_H
#define QUINTET_PROGRAM_CHECK_SHADER_RULES_H

#include <set>
#include <string>

#include "program/check_shader.h"
#include "shader/spirv_flow.h"

namespace quintet::program {

// Numbers of GLSL.std.450 (extended instruction set, Khronos) that rules look for.
namespace glsl450 {
enum : std::uint32_t {
  kFAbs = 4,
  kFSign = 6,
  kPow = 26,
  kSqrt = 31,
  kInverseSqrt = 32,
  kFMin = 37,
  kFMax = 40,
  kFClamp = 43,
  kFMix = 46,
  kStep = 48,
  kSmoothStep = 49,
  kFma = 50,
  kLength = 66,
  kDistance = 67,
  kCross = 68,
  kNormalize = 69,
  kFaceForward = 70,
  kReflect = 71,
  kNMin = 79,
  kNMax = 80,
  kNClamp = 81,
};
}  // namespace glsl450

// Collects diagnostics; the same id at the same line is kept once.
class Findings {
 public:
  explicit Findings(const shader::SpirvModule& module) : module_(module) {}
  // `token`: what the message is about, as it stands in the source; gives the column.
  void add(std::string_view id, const shader::SpirvInstruction& where, std::string text, std::string_view token = {});
  std::vector<shader::Diagnostic> take() { return std::move(diagnostics_); }

 private:
  const shader::SpirvModule& module_;
  std::set<std::string> seen_;
  std::vector<shader::Diagnostic> diagnostics_;
};

// GLSL's name of a built-in of ray tracing: "gl_PrimitiveID". RayTmaxKHR: "gl_RayTmaxEXT".
std::string_view glslName(spv::BuiltIn builtIn);

// The built-in that an instruction loads, wholly or in part.
std::optional<spv::BuiltIn> loadedBuiltIn(const shader::SpirvModule& module,
                                          const shader::SpirvInstruction& instruction);

// A line of a text, 1-based, without its end; empty: not there.
std::string_view lineOf(std::string_view text, int line);

void checkDistance(const shader::SpirvModule& module, Findings& findings);           // Q701
void checkNormals(const shader::SpirvModule& module, Findings& findings);            // Q702
void checkInstanceIndex(const shader::SpirvModule& module, Findings& findings);      // Q703
void checkDescriptorIndices(const shader::SpirvModule& module, Findings& findings);  // Q704
void checkOrigins(const shader::SpirvModule& module, Findings& findings);            // Q705
// A trace with tmin 0 whose origin is a member of a payload that the shader has traced with (0 of what is no structure).
struct PayloadOrigin {
  std::size_t trace = 0;  // instruction
  shader::SpirvId payload = 0;
  std::uint32_t member = 0;
};
std::vector<PayloadOrigin> payloadOrigins(const shader::SpirvModule& module);
// Does a closest-hit shader write the position of its hit, without an offset, into that member of its payload?
bool storesHitPosition(const shader::SpirvModule& module, std::uint32_t member);

void checkNestedBuiltIns(const shader::SpirvModule& module, Findings& findings);   // Q901
void checkAttributeWrites(const shader::SpirvModule& module, Findings& findings);  // Q902
void checkRayTmaxReads(const shader::SpirvModule& module, Findings& findings);     // Q904
void checkLocalArrays(const shader::SpirvModule& module, Findings& findings);      // Q905

}  // namespace quintet::program
#endif
