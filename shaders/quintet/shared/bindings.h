// SPDX-License-Identifier: Apache-2.0
// Bindings of the only descriptor set. All other data is passed by buffer address (shared/frame.h). The table kBindings is
// the only place that lists them: gpu::BindlessSet creates its layout from it, and the check compares shaders with it.
#ifndef QUINTET_SHARED_BINDINGS_H
#define QUINTET_SHARED_BINDINGS_H

#include "types.h"

QT_SHARED_BEGIN
QT_CONSTANT kBindingTlas = 0;
QT_CONSTANT kBindingTextures = 1;

#ifdef __cplusplus
enum class BindingType { accelerationStructure, textures };

struct Binding {
  uint number;           // in set 0
  BindingType type;
  const char* constant;  // name of the number in GLSL
  const char* glsl;      // type of the declaration
};

inline constexpr Binding kBindings[] = {
    {kBindingTlas, BindingType::accelerationStructure, "kBindingTlas", "accelerationStructureEXT"},
    {kBindingTextures, BindingType::textures, "kBindingTextures", "sampler2D[]"},
};
#endif
QT_SHARED_END

#endif
