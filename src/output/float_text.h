// SPDX-License-Identifier: Apache-2.0
// Floats for people.
#ifndef QUINTET_OUTPUT_FLOAT_TEXT_H
#define QUINTET_OUTPUT_FLOAT_TEXT_H

#include <span>
#include <string>

#include "base/math.h"

namespace quintet::output {

// With up to `digits` digits. "0" also for -0, "nan", "infinity" also for the largest float: a ray without limit in the shader
// library.
std::string floatText(float value, int digits = 5);
// Separated by spaces.
std::string floatsText(std::span<const float> values, int digits = 5);
inline std::string vectorText(const vec3& v) { return floatsText({&v[0], 3}); }

}  // namespace quintet::output
#endif
