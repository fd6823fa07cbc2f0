// SPDX-License-Identifier: Apache-2.0
// The explanation of a sample (docs/explain-pixel.md) as a tree of rows: rays, the shaders that they run, and the values of
// payloads before and after.
import { capitalized } from "./text";

export type Value = number | string | boolean | null | Value[] | { [name: string]: Value };

export interface ExplanationEvent {
  type: string;
  events?: ExplanationEvent[];
  stage?: string;
  file?: string;
  line?: number;
  [field: string]: unknown;
}

export interface Explanation {
  pixel: [number, number];
  size: [number, number];
  sample?: number;
  frame?: number;
  outputs: { name: string; value: Value; recorded?: Value }[];
  contributions: { source: string; value: Value; scatterings?: number; ray?: number }[];
  events: ExplanationEvent[];
  discarded?: boolean;
  origin?: { file: string; line: number; stage: string; operation: string; nan: boolean }; // of a value that is not finite
  lostRecords?: number;
}

export interface TreeRow {
  kind: string; // type of the event
  title: string;
  facts: [string, string][];
  file: string;
  line: number;
  children: TreeRow[];
  color?: [number, number, number]; // linear, of contributions and stores
}

export function formatValue(value: unknown): string {
  if (typeof value === "number") {
    if (Number.isInteger(value)) return String(value);
    return String(Number(value.toPrecision(5)));
  }
  if (Array.isArray(value)) return value.map(formatValue).join(" ");
  if (value === null || value === undefined) return "none";
  if (typeof value === "object") return Object.entries(value).map(([name, member]) => `${name} ${formatValue(member)}`).join(", ");
  return String(value);
}

const kHeading = new Set(["type", "events", "stage", "file", "line", "when", "variable", "dataType", "complete"]);

const kNames: Record<string, string> = {
  tmin: "tmin", tmax: "tmax", uv: "uv", pdf: "pdf", bsdfPdf: "BSDF pdf", misWeight: "MIS weight", bsdf: "BSDF", u: "u", ior: "index of refraction", id: "id", t: "t",
};

export function fieldName(name: string): string {
  return kNames[name] ?? name.replace(/[A-Z]/g, (letter) => ` ${letter.toLowerCase()}`);
}

function asColor(value: unknown): [number, number, number] | undefined {
  if (!Array.isArray(value) || value.length < 3 || !value.slice(0, 3).every((v) => typeof v === "number")) return undefined;
  return [value[0] as number, value[1] as number, value[2] as number];
}

function titleOf(event: ExplanationEvent, ray: number): string {
  const text = (name: string) => (event[name] === undefined ? "" : formatValue(event[name]));
  switch (event.type) {
    case "ray": {
      const kind = text("rayType") || "ray";
      return `Ray ${ray}: ${kind === "ray" ? "" : `${kind}, `}${text("result") || "traced"}`;
    }
    case "closest-hit":
    case "hit":
      return `${event.type === "hit" ? "Hit, no shader runs" : "Closest hit"}: ${text("instanceName") || `instance ${text("instance")}`}`;
    case "any-hit":
      return `Any hit: ${text("result")}`;
    case "intersection":
      return `Intersection: ${text("instanceName") || `instance ${text("instance")}`}`;
    case "report":
      return `Report at t ${text("t")}: ${event["accepted"] ? "accepted" : "not accepted"}`;
    case "miss":
      return "Miss";
    case "callable":
      return "Callable shader";
    case "call":
      return `Call of callable ${text("index")}`;
    case "store":
      return `${event["mode"] === "add" ? "Add to" : "Store"} ${text("output")}`;
    case "contribution":
      return `Contribution: ${text("source")}`;
    case "roulette":
      return `Russian roulette: ${event["survived"] ? "survived" : "ended"}`;
    case "light":
      return text("light") === "none" ? "Light sample: none" : `Light sample: ${text("lightType")} ${text("light")}`;
    case "bsdf":
      return `BSDF sample: ${text("lobe")}`;
    case "end":
      return `End: ${text("reason")}`;
    default:
      return capitalized(event.type);
  }
}

const kInTitle: Record<string, string[]> = {
  ray: ["rayType", "result"],
  "closest-hit": ["instanceName"],
  hit: ["instanceName"],
  "any-hit": ["result"],
  report: ["t", "accepted"],
  call: ["index"],
  store: ["output", "mode"],
  contribution: ["source"],
  roulette: ["survived"],
  end: ["reason"],
  bsdf: ["lobe"],
  light: ["light", "lightType"],
};

// "color 0.25 0.25 0.25 → 0.5 0.5 0.5" for each member that the trace changed; the other members without an arrow.
function payloadFacts(before: ExplanationEvent, after: ExplanationEvent | undefined): [string, string][] {
  const facts: [string, string][] = [];
  const names = new Set([...Object.keys(before), ...Object.keys(after ?? {})].filter((name) => !kHeading.has(name)));
  for (const name of names) {
    const old = formatValue(before[name]);
    const now = after ? formatValue(after[name]) : old;
    // Members have their full names in GLSL, such as payload.color.
    facts.push([name === "value" ? String(before["variable"] ?? name) : name, old === now ? old : `${old} → ${now}`]);
  }
  return facts;
}

interface Counter {
  rays: number;
}

function rowsOf(events: readonly ExplanationEvent[], counter: Counter): TreeRow[] {
  const rows: TreeRow[] = [];
  for (const event of events) {
    if (event.type === "payload" || event.type === "data") continue; // facts of the row above
    const isRay = event.type === "ray";
    if (isRay) ++counter.rays;
    const title = titleOf(event, counter.rays);
    const hidden = new Set([...kHeading, ...(kInTitle[event.type] ?? [])]);
    const facts: [string, string][] = [];
    if (event.stage && !isRay && event.type !== "call") facts.push(["shader", event.stage]);
    for (const [name, value] of Object.entries(event)) if (!hidden.has(name) && value !== "") facts.push([fieldName(name), formatValue(value)]);
    const shared = (event.events ?? []).filter((inner) => inner.type === "payload" || inner.type === "data");
    const before = shared.find((inner) => inner["when"] === "before");
    if (before) facts.push(...payloadFacts(before, shared.find((inner) => inner["when"] === "after")));
    const color = event.type === "store" || event.type === "contribution" ? asColor(event["value"]) : undefined;
    rows.push({
      kind: event.type,
      title,
      facts,
      file: event.file ?? event.stage ?? "",
      line: event.line ?? 0,
      children: rowsOf(event.events ?? [], counter),
      ...(color && { color }),
    });
  }
  return rows;
}

export function rayTree(explanation: Explanation): TreeRow[] {
  return rowsOf(explanation.events, { rays: 0 });
}
