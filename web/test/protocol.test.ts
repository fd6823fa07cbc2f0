// SPDX-License-Identifier: Apache-2.0
// The readers of binary messages, and the events of the fake server, against the files that describe the protocol.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { chmodSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import path from "node:path";
import { test } from "node:test";
import { parseFilePart, parseImage } from "../src/protocol";
import { eventProblem, readProtocol } from "../build/protocol.mjs";

declare const REPOSITORY: string;
declare const WEB: string; // the folder with node_modules
const protocol = readProtocol(REPOSITORY);

// A message with 8 bytes after its header.
function binaryMessage(kind: "image" | "file", values: Record<string, number>): ArrayBuffer {
  const { magic, version, fields } = protocol.binary[kind];
  const bytes = Buffer.alloc(40);
  bytes.write(magic);
  bytes.writeUInt32LE(version, 4);
  assert.deepEqual(Object.keys(values), Object.keys(fields));
  for (const [name, field] of Object.entries(fields)) bytes.writeUIntLE(values[name]!, field.at, Math.min(field.bytes, 6));
  return new Uint8Array(bytes).buffer;
}

test("the header of an image", () => {
  const message = (changes: object = {}) => binaryMessage("image", { number: 7, width: 640, height: 360, factor: 2, samples: 16, format: 2, complete: 1, ...changes });
  const { file, ...header } = parseImage(message())!;
  assert.deepEqual(header, { number: 7, width: 640, height: 360, factor: 2, samples: 16, mime: "image/png", complete: true });
  assert.equal(file.length, 8);
  assert.equal(parseImage(message({ format: 1 }))!.mime, "image/jpeg");
  assert.equal(parseImage(message({ format: 3 })), undefined);
  assert.equal(parseImage(message().slice(0, 31)), undefined);
  for (const at of [0, 4]) {
    const other = message();
    new Uint8Array(other)[at] = 2;
    assert.equal(parseImage(other), undefined);
  }
});

test("the header of a part of a file", () => {
  const message = binaryMessage("file", { file: 3, offset: 5_000_000_000 });
  const { bytes, ...header } = parseFilePart(message)!;
  assert.deepEqual(header, { file: 3, offset: 5_000_000_000 });
  assert.equal(bytes.length, 8);
  assert.equal(parseImage(message), undefined);
});

test("events that differ from their description", () => {
  const problem = (event: object) => eventProblem(protocol, event);
  assert.equal(problem({ event: "worker", state: "idle", message: "", restarts: 0 }), undefined);
  assert.equal(problem({ event: "value", id: "a", x: 0, y: 1, value: [0.5, "nan"] }), undefined);
  assert.equal(problem({ event: "wroker" }), "unknown event wroker");
  assert.equal(problem({ event: "worker", state: "ended", message: "", restarts: 0 }), "worker: state must be WorkerState");
  assert.equal(problem({ event: "worker", state: "idle", restarts: 0 }), "worker: message is missing");
  assert.equal(problem({ event: "opening", number: 0.5 }), "opening: number must be whole");
  assert.equal(problem({ event: "stage", text: "a", more: 1 }), "stage: more is unknown");
  assert.equal(problem({ event: "printed", omitted: 0, lines: [{ pixel: [1], stage: "", file: "", line: 1, text: "" }] }), "printed: lines[0].pixel must be whole[2]");
});

// A command line program that answers as `quintet` does.
const kQuintet = `#!/usr/bin/env node
const { writeFileSync } = require("node:fs");
const args = process.argv.slice(2);
const after = (name) => args[args.indexOf(name) + 1];
if (args.includes("--help")) console.log(JSON.stringify({ name: "p", description: "", accumulation: "film", rays: [], parameters: [], outputs: [{ name: "image", kind: "color", pixel: "mean", optional: false, channels: ["R", "G", "B"], help: "" }] }));
else if (args[0] === "check") {
  writeFileSync(after("--graph"), JSON.stringify({ stages: [], traces: [], calls: [], diagnostics: [] }));
  console.log("[]");
} else if (args[0] === "run") writeFileSync(after("-o"), "image");
else console.log("{}");
`;

test("the events of the fake server", { timeout: 60_000 }, async () => {
  const folder = mkdtempSync(path.join(tmpdir(), "quintet-fake-test-"));
  const quintet = path.join(folder, "quintet");
  writeFileSync(quintet, kQuintet);
  chmodSync(quintet, 0o755);
  const server = spawn(process.execPath, [path.join(REPOSITORY, "web/build/fake_server.mjs"), "--port", "0", "--quintet", quintet], { stdio: ["ignore", "pipe", "inherit"] });
  try {
    const line = await new Promise<string>((resolve) => server.stdout.once("data", (data) => resolve(String(data))));
    const WebSocket = createRequire(`${WEB}/`)("ws");
    const socket = new WebSocket(`ws://127.0.0.1:${/:(\d+)\//.exec(line)![1]}/ws`);
    const wanted = new Set(["worker", "opening", "stage", "opened", "state", "diagnostics", "graph", "restarted", "image", "statistics", "value", "picked", "explained", "done"]);
    const received = new Promise<void>((resolve, reject) => {
      socket.on("error", reject);
      socket.on("message", (data: Buffer, isBinary: boolean) => {
        if (isBinary) return;
        const event = JSON.parse(String(data));
        const problem = eventProblem(protocol, event);
        if (problem) reject(new Error(problem));
        if (event.event === "statistics") for (const name of ["value", "pick", "explain"]) socket.send(JSON.stringify({ do: name, id: 2, x: 1, y: 2 }));
        if (wanted.delete(event.event) && wanted.size === 0) resolve();
      });
    });
    socket.on("open", () => socket.send(JSON.stringify({ do: "open", id: 1, program: "<programs/lessons/05_shadow>" })));
    await received;
    socket.close();
  } finally {
    server.kill();
    rmSync(folder, { recursive: true });
  }
});
