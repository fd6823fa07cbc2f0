// SPDX-License-Identifier: Apache-2.0
// The files of the open program: what is saved, what is discarded, and what the editors show then.
import assert from "node:assert/strict";
import { beforeEach, mock, test } from "node:test";
import type { ProgramText } from "../src/protocol";
import { Workspace } from "../src/workspace";

// The page: no element exists.
Object.assign(globalThis, { document: { querySelector: () => null } });

const kLecture = "/**** RAY GENERATION SHADER ****/\nvoid main() {}\n/**** MISS SHADER ****/\nvoid main() {}\n";

// The server: the files on disk, and the answer to the next requests that save.
let disk: Map<string, string>;
let refusal: { status: number; error: string } | undefined;
let requests: string[];
const hashOf = (text: string) => `h${text.length}_${[...text].reduce((sum, letter) => (31 * sum + letter.charCodeAt(0)) >>> 0, 7)}`;

beforeEach(() => {
  disk = new Map([
    ["mine/a.rt.glsl", kLecture],
    ["mine/a.scene.toml", "# scene\n"],
  ]);
  refusal = undefined;
  requests = [];
});

globalThis.fetch = (async (address: string, init: RequestInit = {}) => {
  const method = init.method ?? "GET";
  const path = decodeURIComponent(address.replace("/api/files/", ""));
  requests.push(`${method} ${path}`);
  if (method === "PUT") {
    if (refusal) return Response.json({ error: refusal.error }, { status: refusal.status });
    const expected = new Headers(init.headers).get("If-Match")?.replaceAll('"', "");
    const before = disk.get(path);
    if (before === undefined ? expected !== undefined : expected !== hashOf(before)) return Response.json({ error: "other content" }, { status: 412 });
    disk.set(path, String(init.body));
    return Response.json({ path, hash: hashOf(disk.get(path)!), size: disk.get(path)!.length });
  }
  if (refusal) return Response.json({ error: refusal.error }, { status: refusal.status });
  if (path === "/api/files") return Response.json({ files: [...disk].map(([name, text]) => ({ path: name, size: text.length, modified: text.length })) });
  const text = disk.get(path);
  if (text === undefined) return Response.json({ error: "not found" }, { status: 404 });
  return new Response(text, { headers: { ETag: `"${hashOf(text)}"` } });
}) as typeof fetch;

function opened(): { workspace: Workspace; messages: string[] } {
  const messages: string[] = [];
  const workspace = new Workspace({
    onDocuments: () => undefined,
    onStatus: () => undefined,
    onSaved: () => undefined,
    onRenamed: () => undefined,
    resolveConflict: () => Promise.resolve(undefined),
    chooseFolder: () => Promise.resolve(undefined),
    explain: () => undefined,
    openLocation: () => undefined,
    notify: (message) => messages.push(message),
    withdraw: (message) => messages.includes(message) && messages.splice(messages.indexOf(message), 1),
  });
  const file = (path: string, role: string) => ({ path, role, text: disk.get(path)!, hash: hashOf(disk.get(path)!) });
  workspace.open({
    name: "mine",
    title: "mine",
    builtIn: false,
    form: "lecture",
    main: "mine/a.rt.glsl",
    scene: "mine/a.scene.toml",
    files: [file("mine/a.rt.glsl", "lecture"), file("mine/a.scene.toml", "scene")],
    diagnostics: [],
  } as unknown as ProgramText);
  return { workspace, messages };
}

test("an edit is saved with the version that it replaces", async () => {
  const { workspace } = opened();
  const edited = kLecture.replace("void main() {}", "void main() { int a; }");
  workspace.setText(workspace.files[0]!, edited);
  assert.equal(workspace.status, "changed");
  assert.equal(await workspace.finish(), true);
  assert.equal(disk.get("mine/a.rt.glsl"), edited);
  assert.deepEqual(requests, ["PUT mine/a.rt.glsl"]);
});

test("discarded edits are not shown as saved", async () => {
  const { workspace, messages } = opened();
  const [program, scene] = workspace.files;
  workspace.setText(program!, kLecture.replace("MISS", "CLOSEST-HIT")); // other documents
  workspace.setText(scene!, "# edited\n");
  refusal = { status: 400, error: "the disk is full" };
  assert.equal(await workspace.finish(), false);
  assert.equal(workspace.status, "failed");
  assert.ok(messages.some((message) => message.includes("the disk is full")));
  workspace.discard();
  assert.equal(workspace.status, "saved");
  assert.equal(workspace.textOf(program!), kLecture);
  assert.deepEqual(program!.documents.map((document) => document.kind), ["rgen", "rmiss"]);
  assert.equal(workspace.textOf(scene!), "# scene\n");
  assert.equal(program!.message, "");
  // Nothing is left to save, and the next edit can be saved.
  refusal = undefined;
  requests = [];
  assert.equal(await workspace.finish(), true);
  assert.deepEqual(requests, []);
  workspace.setText(scene!, "# again\n");
  assert.equal(await workspace.finish(), true);
  assert.equal(disk.get("mine/a.scene.toml"), "# again\n");
  assert.equal(disk.get("mine/a.rt.glsl"), kLecture);
});

test("a version that conflicts with the disk is discarded, and the next edit keeps that of the disk", async () => {
  const { workspace } = opened();
  const scene = workspace.files[1]!;
  disk.set("mine/a.scene.toml", "# on disk\n");
  workspace.setText(scene, "# mine\n");
  assert.equal(await workspace.finish(), false);
  assert.equal(workspace.status, "conflict");
  workspace.discard();
  assert.equal(workspace.status, "saved");
  assert.equal(workspace.textOf(scene), "# scene\n", "the version that was read");
  workspace.setText(scene, "# scene\n[camera]\n");
  await workspace.finish();
  assert.match(disk.get("mine/a.scene.toml")!, /# on disk/);
});

test("a save that failed is repeated with longer pauses, reported once, and stops when it succeeds", async () => {
  mock.timers.enable({ apis: ["setTimeout"] });
  try {
    const { workspace, messages } = opened();
    const scene = workspace.files[1]!;
    const tries = () => requests.filter((request) => request.startsWith("PUT")).length;
    // The save and what it waits for.
    const elapse = async (seconds: number) => {
      mock.timers.tick(1000 * seconds);
      for (let i = 0; i < 20; ++i) await new Promise((resolve) => setImmediate(resolve));
    };
    refusal = { status: 500, error: "the disk is full" };
    workspace.setText(scene, "# edited\n");
    await elapse(0.1);
    assert.equal(workspace.status, "failed");
    assert.equal(scene.message, "the disk is full");
    assert.equal(tries(), 1);
    for (const [seconds, count] of [[0.9, 1], [0.2, 2], [1.5, 2], [0.6, 3], [4.1, 4]] as const) {
      await elapse(seconds);
      assert.equal(tries(), count, `after ${seconds} s`);
    }
    assert.deepEqual(messages, ["mine/a.scene.toml: the disk is full"]);
    refusal = undefined;
    await elapse(8.1);
    assert.equal(workspace.status, "saved");
    assert.equal(scene.message, "");
    assert.equal(disk.get("mine/a.scene.toml"), "# edited\n");
    assert.deepEqual(messages, [], "the error no longer holds");
    const count = tries();
    await elapse(100);
    assert.equal(tries(), count);
  } finally {
    mock.timers.reset();
  }
});

test("a file that was deleted on disk is not shown as saved, and the next edit or Ctrl+S writes it again", async () => {
  const { workspace } = opened();
  const [program, scene] = workspace.files;
  await workspace.refresh();
  assert.equal(workspace.status, "saved");
  disk.clear();
  await workspace.refresh();
  assert.equal(workspace.status, "missing");
  assert.match(program!.message, /mine\/a\.rt\.glsl was deleted on disk/);
  assert.equal(workspace.textOf(program!), kLecture, "the editors keep the text");
  await workspace.save();
  assert.equal(disk.size, 0, "leaving the program does not write what the user has deleted");
  workspace.setText(scene!, "# edited\n");
  await workspace.finish();
  assert.equal(disk.get("mine/a.scene.toml"), "# edited\n");
  assert.equal(workspace.status, "missing", "the other file is not on disk");
  await workspace.save({ missing: true });
  assert.equal(workspace.status, "saved");
  assert.equal(disk.get("mine/a.rt.glsl"), kLecture);
});

test("a deleted file that another program writes again is read", async () => {
  const { workspace } = opened();
  const scene = workspace.files[1]!;
  disk.delete("mine/a.scene.toml");
  await workspace.refresh();
  assert.equal(workspace.status, "missing");
  disk.set("mine/a.scene.toml", "# restored by git\n");
  await workspace.refresh();
  assert.equal(workspace.status, "saved");
  assert.equal(workspace.textOf(scene), "# restored by git\n");
});

test("a project that cannot be read is not shown as saved", async () => {
  const { workspace } = opened();
  refusal = { status: 500, error: "the folder cannot be read" };
  await workspace.refresh();
  assert.equal(workspace.status, "missing");
  assert.equal(workspace.files[0]!.message, "the folder cannot be read");
  refusal = undefined;
  await workspace.refresh();
  assert.equal(workspace.status, "saved");
});
