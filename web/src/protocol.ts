// SPDX-License-Identifier: Apache-2.0
// The answers of docs/design/lab-protocol.md as types, the headers of its binary messages, and the messages of the WebSocket,
// whose types build/check.mjs generates.
import type { Commands, Common, Diagnostic, Events } from "./protocol_messages";

export type * from "./protocol_messages";

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

export type CommandName = keyof Commands;
export type Command = { [K in CommandName]: { do: K } & Common & Commands[K] }[CommandName];

export type EventName = keyof Events;
export type EventOf<K extends EventName> = { event: K } & Common & Events[K];
export type ServerEvent = { [K in EventName]: EventOf<K> }[EventName];

export type SessionState = Events["state"];
export type Opened = Events["opened"];
export type Statistics = Events["statistics"];
export type Picked = Events["picked"];

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
