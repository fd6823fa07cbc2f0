// Q701: a reported t that does not change with the length of the ray's direction, because the direction was made a unit
// vector on the way. Decided by degrees (ray_degree.h): right is -1, a distance has 0.
#include "program/check_shader_rules.h"
#include "program/ray_degree.h"

namespace quintet::program {

using shader::SpirvInstruction;
using shader::SpirvModule;

namespace {

// normalize(d), length(d) or inversesqrt(dot(d, d)), of something that the object-space direction is part of.
bool takesLength(const SpirvModule& module, const SpirvInstruction& instruction, const RayDegrees& degrees) {
  using namespace glsl450;
  if (!isExtended(module, instruction, kNormalize) && !isExtended(module, instruction, kLength) &&
      !isExtended(module, instruction, kInverseSqrt))
    return false;
  const shader::SpirvId argument = instruction.at(2);
  const RayDegree degree = degrees.met(argument);
  if (degree.unknown || degree.constant() || degree.is(0.0)) return false;
  return dependsOn(module, argument, [&](const SpirvInstruction& i) {
    return loadsBuiltIn(module, i, spv::BuiltIn::ObjectRayDirectionKHR);
  });
}

// The instruction that makes `t` a distance, if it is one by the degrees of the last evaluation.
const SpirvInstruction* causeOf(const SpirvModule& module, shader::SpirvId t, const RayDegree& degree,
                                const RayDegrees& degrees) {
  if (!degree.may(0.0)) return nullptr;
  const auto find = [&](std::uint32_t number) {
    return findInSlice(module, t, [&](const SpirvInstruction& i) {
      return (number == 0 || isExtended(module, i, number)) && takesLength(module, i, degrees);
    });
  };
  const SpirvInstruction* cause = find(glsl450::kNormalize);
  // length() only if it is so on every path: a value of another origin is no alarm.
  return cause || !degree.is(0.0) ? cause : find(0);
}

}  // namespace

void checkDistance(const SpirvModule& module, Findings& findings) {
  RayDegrees degrees(module);
  for (const SpirvInstruction& report : module.instructions()) {
    if (report.op != spv::Op::OpReportIntersectionKHR) continue;
    const shader::SpirvId t = report.at(0);
    const RayDegree degree = degrees.of(t);
    const SpirvInstruction* cause = causeOf(module, t, degree, degrees);
    if (degree.unknown)
      degrees.alternatives(t, [&](const RayDegree& side) {
        if (!cause && side.is(0.0)) cause = causeOf(module, t, side, degrees);
      });
    if (!cause) continue;
    findings.add("Q701", *cause,
                 "the reported t is computed with the normalized gl_ObjectRayDirectionEXT: it is a distance in object "
                 "space, wrong in scaled instances",
                 isExtended(module, *cause, glsl450::kNormalize) ? "normalize"
                 : isExtended(module, *cause, glsl450::kLength)  ? "length"
                                                                 : "inversesqrt");
  }
}

}  // namespace quintet::program
