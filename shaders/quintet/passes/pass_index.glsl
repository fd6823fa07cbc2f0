// SPDX-License-Identifier: Apache-2.0
// The element of this invocation of a compute pass.
#ifndef QUINTET_PASSES_PASS_INDEX_GLSL
#define QUINTET_PASSES_PASS_INDEX_GLSL
#include <quintet/shared/pass.h>

uint passIndex() { return gl_GlobalInvocationID.y * (kPassColumns * kPassGroupSize) + gl_GlobalInvocationID.x; }

#endif
