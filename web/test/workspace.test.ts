// SPDX-License-Identifier: Apache-2.0
// The files of the open program: what is saved, what is discarded, and what the editors show then.
import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
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
    if (expected !== hashOf(disk.get(path)!)) return Response.json({ error: "other content" }, { status: 412 });
    disk.set(path, String(init.body));
    return Response.json({ path, hash: hashOf(disk.get(path)!), size: disk.get(path)!.length });
  }
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
