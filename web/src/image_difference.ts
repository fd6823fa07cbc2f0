// SPDX-License-Identifier: Apache-2.0
// Compares two images of the same size, as 8-bit RGBA, for the checks of lesson tasks.

export interface ImageDifference {
  differing: number; // share of the pixels that differ visibly, 0 to 1
  rms: number; // root of the mean squared difference, 0 to 255
  worst: { x: number; y: number; left: [number, number, number]; right: [number, number, number] } | undefined;
  map: Uint8ClampedArray<ArrayBuffer>; // RGBA: gray where equal, red where different
}

// A difference of a channel that counts as visible. Rounding differs by one or two steps.
const kVisible = 8;
// Pixels at edges can differ, because rays are computed in a different order.
export const kAllowedShare = 0.004;

export function compareImages(left: Uint8ClampedArray, right: Uint8ClampedArray, width: number): ImageDifference {
  const count = left.length / 4;
  const map = new Uint8ClampedArray(left.length);
  let differing = 0;
  let sum = 0;
  let largest = kVisible;
  let worst: ImageDifference["worst"];
  for (let i = 0; i < count; ++i) {
    const at = 4 * i;
    let difference = 0;
    for (let channel = 0; channel < 3; ++channel) {
      const d = Math.abs(left[at + channel]! - right[at + channel]!);
      sum += d * d;
      difference = Math.max(difference, d);
    }
    const gray = 0.2126 * right[at]! + 0.7152 * right[at + 1]! + 0.0722 * right[at + 2]!;
    const visible = difference > kVisible;
    if (visible) ++differing;
    map.set(visible ? [190 + difference / 4, 40, 40, 255] : [90 + gray / 3, 90 + gray / 3, 90 + gray / 3, 255], at);
    if (difference > largest) {
      largest = difference;
      const color = (data: Uint8ClampedArray): [number, number, number] => [data[at]!, data[at + 1]!, data[at + 2]!];
      worst = { x: i % width, y: Math.floor(i / width), left: color(left), right: color(right) };
    }
  }
  return { differing: count > 0 ? differing / count : 0, rms: count > 0 ? Math.sqrt(sum / (3 * count)) : 0, worst, map };
}
