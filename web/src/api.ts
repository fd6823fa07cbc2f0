// SPDX-License-Identifier: Apache-2.0
// The HTTP routes of docs/design/lab-protocol.md. Errors have the text of the server.
import type { Lesson, ProgramList, ProgramText, Project } from "./protocol";

export class ApiError extends Error {
  constructor(
    message: string,
    readonly status: number, // 0: the server does not answer
    readonly body: Record<string, unknown>,
  ) {
    super(message);
  }
}

const encodePath = (path: string) => path.split("/").map(encodeURIComponent).join("/");

async function request(path: string, init: RequestInit = {}): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(path, { credentials: "same-origin", cache: "no-store", ...init });
  } catch {
    throw new ApiError("The server does not answer", 0, {});
  }
  if (response.ok) return response;
  let body: Record<string, unknown> = {};
  try {
    body = (await response.json()) as Record<string, unknown>;
  } catch {
    // Not JSON: the status has to do.
  }
  const text = typeof body["error"] === "string" ? body["error"] : `${path}: the server answered ${response.status}`;
  throw new ApiError(text, response.status, body);
}

async function json<T>(path: string, init?: RequestInit): Promise<T> {
  return (await (await request(path, init)).json()) as T;
}

const post = (body: unknown): RequestInit => ({ method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) });

export interface Copied {
  name: string;
  files: string[];
}

export interface FileEntry {
  path: string;
  size: number;
  modified: number;
}

export interface SavedFile {
  path: string;
  hash: string;
  size: number;
}

export const api = {
  project: () => json<Project>("/api/project"),
  programs: () => json<ProgramList>("/api/programs"),
  program: (name: string) => json<ProgramText>(`/api/program?name=${encodeURIComponent(name)}`),
  lessons: () => json<Lesson[]>("/api/lessons"),
  files: async () => (await json<{ files: FileEntry[] }>("/api/files")).files,
  library: () => json<{ path: string; text: string }[]>("/api/library"),
  copyProgram: (from: string, to: string, replace = false) => json<Copied>("/api/programs", post({ from, to, replace })),

  docs: async (path: string) => (await request(`/api/docs/${encodePath(path)}`)).text(),
  docsAddress: (path: string) => `/api/docs/${encodePath(path)}`,

  file: async (path: string) => {
    const response = await request(`/api/files/${encodePath(path)}`);
    return { text: await response.text(), hash: (response.headers.get("ETag") ?? "").replaceAll('"', "") };
  },
  bytes: async (path: string) => new Uint8Array(await (await request(`/api/files/${encodePath(path)}`)).arrayBuffer()),

  // `hash` is that of the content to replace; "" creates the file, "*" replaces whatever it has. A different content on
  // disk is an ApiError with status 412.
  save: (path: string, content: BodyInit, hash: string) =>
    json<SavedFile>(`/api/files/${encodePath(path)}`, {
      method: "PUT",
      headers: hash === "" ? { "If-None-Match": "*" } : { "If-Match": hash === "*" ? "*" : `"${hash}"` },
      body: content,
    }),

  // GLSL with clang-format, where the server has it; otherwise an ApiError with status 501.
  format: (text: string) => json<{ text: string; formatter: string }>("/api/format", { method: "POST", headers: { "Content-Type": "text/plain" }, body: text }),

  export: async (name: string, form: "zip" | "lecture") =>
    (await request(`/api/export?name=${encodeURIComponent(name)}&form=${form}`)).blob(),
  import: (to: string, content: BodyInit, type: "text/plain" | "application/zip", replace: boolean) =>
    json<Copied>(`/api/import?to=${encodeURIComponent(to)}${replace ? "&replace=1" : ""}`, {
      method: "POST",
      headers: { "Content-Type": type },
      body: content,
    }),
};
