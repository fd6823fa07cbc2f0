// SPDX-License-Identifier: Apache-2.0
// Splits a lecture file (docs/lecture-form.md) into the parts that the page shows as one editor each: the common text and
// the stages. The parts in sequence are the file, byte for byte.

export type StageKind = "rgen" | "rchit" | "rmiss" | "rint" | "rahit" | "rcall";

export interface Segment {
  kind: StageKind | "common" | "unknown";
  text: string;
}

export const kStageNames: Record<StageKind, string> = {
  rgen: "Ray generation",
  rchit: "Closest hit",
  rmiss: "Miss",
  rint: "Intersection",
  rahit: "Any hit",
  rcall: "Callable",
};

const kMarkers: [RegExp, StageKind][] = [
  [/ray[\s-]*generation[\s-]*shader/i, "rgen"],
  [/closest[\s-]*hit[\s-]*shader/i, "rchit"],
  [/any[\s-]*hit[\s-]*shader/i, "rahit"],
  [/intersection[\s-]*shader/i, "rint"],
  [/callable[\s-]*shader/i, "rcall"],
  [/miss[\s-]*shader/i, "rmiss"],
];

interface Token {
  start: number;
  end: number;
  text: string;
  comment: boolean;
}

// Comments, words and punctuation. Strings do not exist in GLSL.
function tokens(text: string): Token[] {
  const found: Token[] = [];
  const pattern = /\/\/[^\n]*|\/\*[\s\S]*?(?:\*\/|$)|[A-Za-z_]\w*|[{}()]/g;
  for (let match = pattern.exec(text); match; match = pattern.exec(text)) {
    const token = match[0];
    found.push({ start: match.index, end: match.index + token.length, text: token, comment: token.startsWith("/") });
  }
  return found;
}

// A comment with stars names the stage, as does one that has only the name and "shader".
function markerOf(comment: string): StageKind | undefined {
  const found = kMarkers.find(([pattern]) => pattern.test(comment));
  if (!found) return undefined;
  const [pattern, kind] = found;
  return /\*{2,}/.test(comment) || !/[A-Za-z0-9]/.test(comment.replace(pattern, "")) ? kind : undefined;
}

interface Main {
  start: number; // of "void"
  marker: number; // start of the comment before "void" that names the stage; else that of "void"
  end: number; // after the closing brace
  kind: StageKind | "unknown";
}

function findMains(text: string): Main[] {
  const all = tokens(text);
  const mains: Main[] = [];
  let depth = 0;
  let after = -1; // the last token of the main before
  for (let i = 0; i < all.length; ++i) {
    const token = all[i]!;
    if (token.text === "{") ++depth;
    else if (token.text === "}") depth = Math.max(0, depth - 1);
    if (depth !== 0 || token.text !== "void") continue;
    const code: Token[] = [];
    for (let j = i; j < all.length && code.length < 5; ++j) if (!all[j]!.comment) code.push(all[j]!);
    if (code.length < 5 || code[1]!.text !== "main" || code[2]!.text !== "(" || code[3]!.text !== ")" || code[4]!.text !== "{") continue;
    let end = text.length;
    let level = 0;
    let last = all.length - 1;
    let atStart: StageKind | undefined;
    let inBody: StageKind | undefined;
    let codeInBody = false;
    for (let j = i; j < all.length; ++j) {
      const inner = all[j]!;
      if (inner.comment) {
        const kind = level > 0 || inner.start > code[0]!.start ? markerOf(inner.text) : undefined;
        if (kind && !codeInBody) atStart ??= kind;
        else if (kind) inBody ??= kind;
      } else if (inner.text === "{") ++level;
      else if (inner.text === "}") {
        if (--level === 0) {
          end = inner.end;
          last = j;
          break;
        }
      } else if (level > 0) codeInBody = true;
    }
    // Declarations may follow the comment.
    let before: StageKind | undefined;
    let marker = token.start;
    for (let j = i - 1; j > after && before === undefined; --j) {
      if (!all[j]!.comment) continue;
      before = markerOf(all[j]!.text);
      if (before && !atStart) marker = all[j]!.start;
    }
    mains.push({ start: token.start, marker, end, kind: atStart ?? before ?? inBody ?? "unknown" });
    i = after = last;
  }
  return mains;
}

// Start of the line of `offset`, or of the comments directly above it that contain a stage marker.
function startOfMain(text: string, main: Main, floor: number): number {
  let start = text.lastIndexOf("\n", main.marker - 1) + 1;
  for (;;) {
    const above = text.slice(floor, start);
    const line = /(?:^|\n)([^\n]*)\n$/.exec(above)?.[1];
    if (line === undefined || !/^\s*(\/\/|\/\*)/.test(line) || /COMMON\s+(START|END)/i.test(line)) break;
    start -= line.length + 1;
  }
  return Math.max(start, floor);
}

function endOfLine(text: string, offset: number): number {
  const end = text.indexOf("\n", offset);
  return end < 0 ? text.length : end + 1;
}

// Returns one segment of the kind "unknown" if the text has no main().
export function splitLecture(text: string): Segment[] {
  const mains = findMains(text);
  if (mains.length === 0) return [{ kind: "unknown", text }];
  const segments: Segment[] = [];
  let at = 0;
  const cut = (end: number, kind: Segment["kind"]) => {
    if (end > at) segments.push({ kind, text: text.slice(at, end) });
    at = Math.max(at, end);
  };
  cut(startOfMain(text, mains[0]!, 0), "common");
  mains.forEach((main, index) => {
    const next = mains[index + 1];
    // Common text between two stages has an editor of its own.
    const from = main.end;
    const until = next ? next.start : text.length;
    const between = text.slice(from, until);
    const common = /\/\*+\s*COMMON\s+START\s*\*+\/[\s\S]*?\/\*+\s*COMMON\s+END\s*\*+\//i.exec(between);
    cut(next || common ? endOfLine(text, main.end) : text.length, main.kind);
    if (common) {
      cut(text.lastIndexOf("\n", from + common.index) + 1, main.kind);
      cut(endOfLine(text, from + common.index + common[0].length), "common");
    }
  });
  if (at < text.length) {
    const last = segments[segments.length - 1]!;
    if (last.kind === "common") segments.push({ kind: mains[mains.length - 1]!.kind, text: text.slice(at) });
    else last.text += text.slice(at);
  }
  return segments;
}

export function joinSegments(segments: readonly { text: string }[]): string {
  return segments.map((segment) => segment.text).join("");
}

// Titles for tabs: "Callable 0", "Callable 1" if there are several of a kind.
export function segmentTitles(segments: readonly { kind: Segment["kind"] }[]): string[] {
  const total = new Map<string, number>();
  for (const { kind } of segments) total.set(kind, (total.get(kind) ?? 0) + 1);
  const seen = new Map<string, number>();
  return segments.map(({ kind }) => {
    const name = kind === "common" ? "Common" : kind === "unknown" ? "Source" : kStageNames[kind];
    const index = seen.get(kind) ?? 0;
    seen.set(kind, index + 1);
    if ((total.get(kind) ?? 0) < 2) return name;
    return kind === "rcall" ? `${name} ${index}` : `${name} ${index + 1}`;
  });
}

// The stage of a file by its extension; common text for included files.
export function stageOfFile(file: string): StageKind | "common" | undefined {
  const extension = /\.(rgen|rchit|rmiss|rint|rahit|rcall|glsl)$/.exec(file)?.[1];
  if (extension === "glsl") return file.endsWith(".rt.glsl") ? undefined : "common";
  return extension as StageKind | undefined;
}
