// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { factsText, percentText, raysText } from "../src/image_bar";
import type { SessionState } from "../src/protocol";

const state = (changes: Partial<SessionState>): SessionState => ({
  program: "p", parameters: {}, output: "color", exposure: 0, tonemap: "default", width: 640, height: 360, samples: 64, frame: 0, frames: false, still: false, paused: false, camera: null, environment: { source: "", intensity: 1, rotation: 0, on: true }, canUndo: false, canRedo: false, prints: false,
  ...changes,
});

test("the facts of an image", () => {
  const statistics = { samples: 12, frames: false, seconds: 2, raysPerSecond: 3.4e6, error: 0.021 };
  assert.equal(factsText(state({}), 12, statistics), "12 of 64 samples · 3.40 M rays/s · error ≤ 2.1 % · 640 × 360");
  assert.equal(factsText(state({ paused: true }), 12, undefined), "12 of 64 samples · 640 × 360 · paused");
  assert.equal(factsText(state({ frames: true }), 13, { ...statistics, frames: true, samples: 48, raysPerSecond: 0 }), "Frame 12 · 24 frames/s · 640 × 360");
  assert.equal(factsText(state({ frames: true, still: true }), 1, undefined), "Frame 0 · all frames are equal · 640 × 360");
});

test("rates and shares", () => {
  assert.equal(raysText(950), "950");
  assert.equal(raysText(2.5e9), "2.50 G");
  assert.equal(percentText(0.5), "50 %");
});
