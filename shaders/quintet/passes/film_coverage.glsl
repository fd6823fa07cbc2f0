// SPDX-License-Identifier: Apache-2.0
// Counts the ids of a batch's samples. A compute shader with one invocation per value of the batch.
#extension GL_EXT_scalar_block_layout : require
#include <quintet/passes/batch_pixel.glsl>
#include <quintet/passes/pass_index.glsl>

layout(local_size_x = kPassGroupSize) in;
layout(push_constant, scalar) uniform FilmCoverageBlock { FilmCoverage pass; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer IdArray { uint at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer SlotArray { CoverageSlot at[]; };

// Keeps the slots sorted by id, with empty slots last. If there are more ids than slots, the smallest ids are kept. The
// result then does not depend on the order of the samples or on the number of parts.
void count(SlotArray slots, uint first, uint id) {
  uint slot = 0u;
  while (slot < kCoverageSlots && slots.at[first + slot].samples > 0u && slots.at[first + slot].id < id) ++slot;
  if (slot == kCoverageSlots) return;
  if (slots.at[first + slot].samples > 0u && slots.at[first + slot].id == id) {
    slots.at[first + slot].samples += 1u;
    return;
  }
  for (uint i = kCoverageSlots - 1u; i > slot; --i) slots.at[first + i] = slots.at[first + i - 1u];
  slots.at[first + slot] = CoverageSlot(id, 1u);
}

void main() {
  const uint i = passIndex();
  uint pixel;
  if (!findBatchPixel(pass.batch, i, pixel)) return;
  for (uint s = 0u; s < kBatchSamples; ++s) {
    const uint id = IdArray(pass.values).at[kBatchSamples * i + s];
    if (id != 0u) count(SlotArray(pass.total), kCoverageSlots * pixel, id);
  }
}
