// SPDX-License-Identifier: Apache-2.0
// The messages of docs/design/lab-protocol.md as types, and the header of its images.
import type { Diagnostic } from "./diagnostic";
import type { PipelineModel } from "./pipeline_model";
import type { Explanation } from "./ray_tree";

export interface Project {
  folder: string;
  version: string;
  program: string;
  scene: string;
  size: [number, number];
  samples: number;
  timeout: number;
  workers: number;
}

export interface ProgramEntry {
  name: string;
  title: string;
  description: string;
}

export interface ProgramList {
  builtIn: ProgramEntry[];
  project: ProgramEntry[];
  scenes: string[];
}

export interface ProgramFile {
  path: string;
  role: "lecture" | "description" | "scene" | "raygen" | "closesthit" | "anyhit" | "intersection" | "miss" | "callable" | "include";
  hash: string;
  text: string;
}

export interface ProgramText {
  name: string;
  title: string;
  builtIn: boolean;
  form: "lecture" | "folder";
  main: string;
  scene: string;
  files: ProgramFile[];
  diagnostics: Diagnostic[];
}

export interface Lesson {
  name: string; // "05_shadow"
  number: string;
  title: string;
  page: string;
  image: string;
  program: string; // built-in, that it starts with
  copy: string;
  copied: boolean;
}

export interface ParameterDescription {
  name: string;
  type: "bool" | "int" | "uint" | "float" | "vec2" | "vec3" | "vec4" | "color" | "choice" | "image";
  default: ParameterValue;
  min: number | null;
  max: number | null;
  choices?: string[];
  unit?: string;
  help?: string;
}

export type ParameterValue = number | boolean | string | number[];

export interface OutputDescription {
  name: string;
  kind: string;
  help?: string;
}

export interface Description {
  name: string;
  description: string;
  accumulation: string;
  parameters: ParameterDescription[];
  outputs: OutputDescription[];
}

export interface Camera {
  from: [number, number, number];
  at: [number, number, number];
  up: [number, number, number];
  fov: number;
}

export interface SessionState {
  program: string;
  parameters: Record<string, ParameterValue>;
  output: string;
  exposure: number;
  tonemap: string;
  width: number;
  height: number;
  samples: number;
  frame: number;
  frames: boolean; // the program counts frames
  still: boolean; // all of them are equal, so that one is rendered
  paused: boolean;
  camera: Camera | null;
  canUndo: boolean;
  canRedo: boolean;
  prints: boolean;
}

export interface Opened {
  program: string;
  scene: string;
  device: string;
  description: Description;
  materials: string[];
  lights: string[];
  instances: string[];
  cameras: string[];
  animated: boolean;
  lastFrame: number;
}

export interface Statistics {
  samples: number;
  frames: boolean;
  seconds: number;
  raysPerSecond: number;
  error: number | null;
}

export interface PrintedLine {
  pixel: [number, number];
  frame?: number;
  sample?: number;
  stage: string;
  file: string;
  line: number;
  text: string;
}

export type WorkerState = "started" | "waiting" | "crashed" | "hung" | "idle";

export interface Picked {
  x: number;
  y: number;
  instance: string | null;
  geometry?: number;
  primitive?: number;
  material?: string | null;
  position?: number[];
  normal?: number[];
  geometricNormal?: number[];
  front?: boolean;
  distance?: number;
}

interface EventBodies {
  worker: { state: WorkerState; message: string; restarts: number };
  opening: { number: number };
  stage: { text: string };
  opened: Opened;
  state: SessionState;
  diagnostics: { diagnostics: Diagnostic[]; outdated?: boolean };
  graph: { graph: PipelineModel | null };
  image: { number: number; samples: number; width: number; height: number; factor: number; complete: boolean };
  statistics: Statistics;
  restarted: Record<never, never>;
  reloaded: { files: string[] | string };
  printed: { lines: PrintedLine[]; omitted: number };
  picked: Picked;
  value: { x: number; y: number; value: (number | string)[] };
  progress: { done: number; total: number };
  file: { file: number; name: string; type: string; size: number };
  explained: { x: number; y: number; sample?: number; frame?: number; explanation: Explanation };
  deviceReplaced: { device: string; message: string };
  note: { message: string };
  warning: { message: string };
  error: { message: string };
  done: Record<never, never>;
}

export type EventName = keyof EventBodies;
export type ServerEvent = { [K in EventName]: { event: K; id?: number } & EventBodies[K] }[EventName];
export type EventOf<K extends EventName> = Extract<ServerEvent, { event: K }>;

export type Command = { do: string; [key: string]: unknown };

export interface ImageMessage {
  number: number;
  width: number;
  height: number;
  factor: number;
  samples: number;
  mime: "image/jpeg" | "image/png";
  complete: boolean;
  file: Uint8Array<ArrayBuffer>;
}

export interface FilePart {
  file: number;
  offset: number;
  bytes: Uint8Array<ArrayBuffer>;
}

const kMagicImage = 0x51494d47; // "QIMG"
const kMagicFile = 0x5146494c; // "QFIL"

// Returns undefined for anything but a part of a file of version 1.
export function parseFilePart(message: ArrayBuffer): FilePart | undefined {
  if (message.byteLength < 32) return undefined;
  const view = new DataView(message);
  if (view.getUint32(0, false) !== kMagicFile || view.getUint32(4, true) !== 1) return undefined;
  return { file: view.getUint32(8, true), offset: Number(view.getBigUint64(16, true)), bytes: new Uint8Array(message, 32) };
}

// Returns undefined for anything but an image of version 1.
export function parseImage(message: ArrayBuffer): ImageMessage | undefined {
  if (message.byteLength < 32) return undefined;
  const view = new DataView(message);
  if (view.getUint32(0, false) !== kMagicImage || view.getUint32(4, true) !== 1) return undefined;
  const format = view.getUint8(28);
  if (format !== 1 && format !== 2) return undefined;
  return {
    number: view.getUint32(8, true),
    width: view.getUint32(12, true),
    height: view.getUint32(16, true),
    factor: view.getUint32(20, true),
    samples: view.getUint32(24, true),
    mime: format === 1 ? "image/jpeg" : "image/png",
    complete: view.getUint8(29) === 1,
    file: new Uint8Array(message, 32),
  };
}
