// SPDX-License-Identifier: Apache-2.0
// Compares values of a program with those of a solution, for the checks of lesson tasks: means of pixels, the payload of a
// ray, and what a pixel prints. A difference is a sentence for the user.
import { type Explanation, type ExplanationEvent, formatValue } from "./ray_tree";
import { capitalized } from "./text";

// Pixels of the image, x right, y down.
export interface Block {
  x: number;
  y: number;
  width: number;
  height: number;
}

export type ValueComparison =
  | { kind: "mean"; blocks: readonly Block[]; tolerance: number } // of the linear values; tolerance relative to the solution
  | { kind: "payload"; pixel: readonly [number, number]; member: string } // after the first ray of the pixel
  | { kind: "printed"; pixel: readonly [number, number] };

export interface ValueResult {
  passed: boolean;
  message: string; // what was compared, and the first difference
}

// Rounding of different but equal expressions.
const kRounding = 1e-4;

function isClose(yours: number, wanted: number, tolerance: number): boolean {
  return Math.abs(yours - wanted) <= tolerance * Math.max(Math.abs(wanted), kRounding);
}

// Numbers of any depth; texts like "nan" must be equal.
export function valuesMatch(yours: unknown, wanted: unknown, tolerance = kRounding): boolean {
  if (typeof yours === "number" && typeof wanted === "number") return isClose(yours, wanted, tolerance);
  if (Array.isArray(yours) && Array.isArray(wanted)) return yours.length === wanted.length && yours.every((value, i) => valuesMatch(value, wanted[i], tolerance));
  return yours === wanted;
}

const kNumber = /[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?/gi;

// Lines are equal if their texts are, apart from spaces and the rounding of numbers.
export function linesMatch(yours: string, wanted: string): boolean {
  const words = (line: string) => line.replace(kNumber, "#").replace(/\s+/g, " ").trim();
  const numbers = (line: string) => (line.match(kNumber) ?? []).map(Number);
  return words(yours) === words(wanted) && valuesMatch(numbers(yours), numbers(wanted));
}

const blockText = (block: Block) => `${block.x}, ${block.y} to ${block.x + block.width - 1}, ${block.y + block.height - 1}`;

// `yours` and `wanted`: a value for each block, red, green, blue and alpha.
export function compareMeans(blocks: readonly Block[], tolerance: number, yours: readonly (number | string)[][], wanted: readonly (number | string)[][]): ValueResult {
  const color = (value: readonly (number | string)[]) => formatValue(value.slice(0, 3).map((channel) => (typeof channel === "number" ? Number(channel.toPrecision(3)) : channel)));
  for (const [i, block] of blocks.entries())
    if (!valuesMatch(yours[i]!.slice(0, 3), wanted[i]!.slice(0, 3), tolerance))
      return { passed: false, message: `The mean of the pixels ${blockText(block)} is ${color(yours[i]!)} (linear), that of the solution is ${color(wanted[i]!)}.` };
  return { passed: true, message: `Done: the mean of the pixels ${blockText(blocks[0]!)} is ${color(yours[0]!)}, like that of the solution.` };
}

function firstRay(events: readonly ExplanationEvent[]): ExplanationEvent | undefined {
  for (const event of events) {
    if (event.type === "ray") return event;
    const inner = firstRay(event.events ?? []);
    if (inner) return inner;
  }
  return undefined;
}

// A member of the payload after the first ray; undefined if there is none.
export function payloadAfter(explanation: Explanation, member: string): unknown {
  const ray = firstRay(explanation.events);
  const after = ray?.events?.find((event) => event.type === "payload" && event["when"] === "after");
  return after?.[`${String(after["variable"])}.${member}`];
}

export function comparePayloads(pixel: readonly [number, number], member: string, yours: Explanation, wanted: Explanation): ValueResult {
  const own = payloadAfter(yours, member);
  const expected = payloadAfter(wanted, member);
  const place = `after the first ray of pixel ${pixel[0]}, ${pixel[1]}, payload.${member} is`;
  if (own === undefined) return { passed: false, message: `Pixel ${pixel[0]}, ${pixel[1]} has no ray that returns payload.${member}; the solution has ${formatValue(expected)}.` };
  if (!valuesMatch(own, expected)) return { passed: false, message: `${capitalized(place)} ${formatValue(own)}; the solution has ${formatValue(expected)}.` };
  return { passed: true, message: `Done: ${place} ${formatValue(own)}.` };
}

export function comparePrints(pixel: readonly [number, number], yours: readonly string[], wanted: readonly string[]): ValueResult {
  const place = `pixel ${pixel[0]}, ${pixel[1]}`;
  const count = (lines: readonly string[]) => (lines.length === 1 ? "1 line" : `${lines.length} lines`);
  if (yours.length === 0) return { passed: false, message: `Your program prints nothing for ${place}; the solution prints: ${wanted.join(" / ")}` };
  for (let i = 0; i < Math.max(yours.length, wanted.length); ++i) {
    const [own, expected] = [yours[i], wanted[i]];
    if (own === undefined || expected === undefined) return { passed: false, message: `Your program prints ${count(yours)} for ${place}; the solution prints ${count(wanted)}.` };
    if (!linesMatch(own, expected)) return { passed: false, message: `For ${place}, your program prints: ${own} · The solution prints: ${expected}` };
  }
  return { passed: true, message: `Done: ${place} prints ${yours[0]!}, as the solution does.` };
}
