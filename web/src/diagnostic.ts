// SPDX-License-Identifier: Apache-2.0
// A problem of a program, in the format of `quintet check --json` (docs/cli.md).
import type { Diagnostic } from "./protocol_messages";

export type { Diagnostic, RelatedLocation } from "./protocol_messages";

// Whether the check's pages explain the diagnostic.
export function hasPage(id: string): boolean {
  return /^Q\d{3}$/.test(id);
}

// Found by rendering, not in the sources.
export function isRunFinding(diagnostic: Diagnostic): boolean {
  return diagnostic.severity === "warning" && diagnostic.file === "";
}

// The pixel that the text of a finding names, from the top left corner.
export function pixelOf(diagnostic: Diagnostic): { x: number; y: number } | undefined {
  const pixel = isRunFinding(diagnostic) ? /\bat pixel \((\d+), (\d+)\)/.exec(diagnostic.text) : null;
  return pixel ? { x: Number(pixel[1]), y: Number(pixel[2]) } : undefined;
}

export function countText(diagnostics: readonly Diagnostic[]): string {
  const parts: string[] = [];
  for (const severity of ["error", "warning", "note"] as const) {
    const count = diagnostics.filter((diagnostic) => diagnostic.severity === severity).length;
    if (count > 0) parts.push(`${count} ${severity}${count === 1 ? "" : "s"}`);
  }
  return parts.join(", ");
}

// Offset in a line of the byte `column` (from 1) of its UTF-8 text.
export function columnOffset(line: string, column: number): number {
  let bytes = 1;
  let offset = 0;
  for (const character of line) {
    if (bytes >= column) break;
    const code = character.codePointAt(0)!;
    bytes += code < 0x80 ? 1 : code < 0x800 ? 2 : code < 0x10000 ? 3 : 4;
    offset += character.length;
  }
  return offset;
}

export interface TextRange {
  from: number;
  to: number;
}

// What to underline in a line: the name or number at the column; else the rest of the line without spaces and comments.
// A name that the message quotes takes precedence if the column is unknown.
export function rangeInLine(line: string, column: number, message: string): TextRange {
  const start = line.length - line.trimStart().length;
  const code = line.replace(/\/\/.*$/, "").trimEnd();
  const whole = { from: start, to: Math.max(code.length, Math.min(line.length, start + 1)) };
  if (column > 0) {
    const from = Math.min(columnOffset(line, column), line.length);
    const word = /^[A-Za-z_0-9.]+/.exec(line.slice(from));
    if (word) return { from, to: from + word[0].length };
    if (from < line.length && line[from] !== " ") return { from, to: from + 1 };
  }
  for (const quoted of message.matchAll(/'([A-Za-z_]\w*)'/g)) {
    const at = new RegExp(`\\b${quoted[1]}\\b`).exec(code);
    if (at) return { from: at.index, to: at.index + quoted[1]!.length };
  }
  return whole;
}
