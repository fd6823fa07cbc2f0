// SPDX-License-Identifier: Apache-2.0
// Limits of programs.
#ifndef QUINTET_PROGRAM_DESCRIPTION_LIMITS_H
#define QUINTET_PROGRAM_DESCRIPTION_LIMITS_H

#include <cstddef>

namespace quintet::program {

// Of a program, heat maps included. The same as shared::kMaxOutputs, which render/film/film.cpp asserts.
inline constexpr std::size_t kMaxOutputs = 32;

}  // namespace quintet::program
#endif
