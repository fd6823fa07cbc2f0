// SPDX-License-Identifier: Apache-2.0
// The closest-hit shader of hit groups without one, with runtime checks (program::withHitShaders).
#define QUINTET_INSTRUMENT_STAGE 0u  // unused: a report names the stage of the trace
#define QUINTET_INSTRUMENT_KIND 1
#include <quintet/instrument.glsl>
#undef main

void main() { instrumentSelfHit_(); }
