// SPDX-License-Identifier: Apache-2.0
// The closest-hit shader of hit groups without one, for quintet explain-pixel (program::withHitShaders).
#define QUINTET_EXPLAIN 1
#define QUINTET_EXPLAIN_STAGE 0u  // unused: no code of the program runs
#define QUINTET_EXPLAIN_KIND 1
#define QUINTET_EXPLAIN_HIT_ONLY 1
#include <quintet/explain.glsl>
#undef main

void main() { explainBegin_(); }
