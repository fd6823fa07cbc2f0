// SPDX-License-Identifier: Apache-2.0
// Types and macros that C++ and GLSL share. A struct in shaders/quintet/shared/*.h is declared once and has the same
// layout in both languages. Rules: layout(scalar), 8-byte members first, explicit padding to a multiple of 8 bytes if a
// struct has a 64-bit member, static_assert(sizeof) below each struct, and a round-trip test in tests/gpu/shared. An
// Address is the buffer device address of a tightly packed array.
#ifndef QUINTET_SHARED_TYPES_H
#define QUINTET_SHARED_TYPES_H

#ifdef __cplusplus
#include <cstdint>

#include "base/math.h"

namespace quintet::shared {
using uint = std::uint32_t;
using Address = std::uint64_t;
using glm::ivec2;
using glm::uvec2;
using glm::uvec3;
using glm::uvec4;
using glm::vec2;
using glm::vec3;
using glm::vec4;
}  // namespace quintet::shared
#define QT_SHARED_BEGIN namespace quintet::shared {
#define QT_SHARED_END }
#define QT_SHARED_SIZE(type, bytes) static_assert(sizeof(type) == (bytes), "layout differs from GLSL's scalar layout")
#define QT_CONSTANT inline constexpr uint
#else
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_nonuniform_qualifier : require
#extension GL_EXT_debug_printf : enable
#define Address uint64_t
#define QT_SHARED_BEGIN
#define QT_SHARED_END
#define QT_SHARED_SIZE(type, bytes)
#define QT_CONSTANT const uint
#endif

#endif
