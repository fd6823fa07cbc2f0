// SPDX-License-Identifier: Apache-2.0
// A server for the development of the page, without the lab's server: the routes of docs/design/lab-protocol.md over a
// temporary folder, and a session that runs the command line program for each image. No access checks: for this machine
// only.
//
//   node build/fake_server.mjs [--port N] [--quintet PROGRAM]
import { createHash } from "node:crypto";
import { execFile } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";

const web = path.dirname(path.dirname(fileURLToPath(import.meta.url)));
const root = path.dirname(web);
const option = (name, otherwise) => {
  const at = process.argv.indexOf(name);
  return at >= 0 ? process.argv[at + 1] : otherwise;
};
const quintet = option("--quintet", path.join(root, "build/release/bin/quintet"));
const port = Number(option("--port", "8123"));
const folder = mkdtempSync(path.join(tmpdir(), "quintet-lab-fake-"));
const hashOf = (text) => createHash("md5").update(text).digest("hex");

const builtInFolder = (name) => path.join(root, name.slice(1, -1));
const isBuiltIn = (name) => name.startsWith("<");
const folderOf = (name) => (isBuiltIn(name) ? builtInFolder(name) : path.join(folder, name));

function programText(name) {
  const where = folderOf(name);
  if (!existsSync(where)) return undefined;
  const roles = { rgen: "raygen", rchit: "closesthit", rahit: "anyhit", rint: "intersection", rmiss: "miss", rcall: "callable" };
  const names = readdirSync(where).filter((file) => /\.(glsl|toml|r[a-z]+)$/.test(file));
  const main = names.find((file) => file.endsWith(".rt.glsl")) ?? "program.toml";
  const files = [main, ...names.filter((file) => file !== main)].map((file) => {
    const text = readFileSync(path.join(where, file), "utf8");
    const role = file.endsWith(".rt.glsl") ? "lecture" : file === "program.toml" ? "description" : file.endsWith(".scene.toml") ? "scene" : (roles[path.extname(file).slice(1)] ?? "include");
    return { path: `${name}/${file}`, role, hash: isBuiltIn(name) ? "" : hashOf(text), text };
  });
  const scene = files.find((file) => file.role === "scene");
  return { name, title: name.replace(/^<programs\//, "").replace(/>$/, ""), builtIn: isBuiltIn(name), form: main === "program.toml" ? "folder" : "lecture", main: `${name}/${main}`, scene: scene?.path ?? "", files, diagnostics: [] };
}

// A cell of the tables in docs/lessons/README.md. A lesson has its image in the cell above.
const kImage = /!\[[^\]]*\]\(\.\.\/([^)]*)\)/;
const kLesson = /\[(\d\d) · ([^\]]*)\]\((\w+)\.md\)/;
const rows = readFileSync(path.join(root, "docs/lessons/README.md"), "utf8").split("\n").map((line) => line.split("|"));
const course = rows.flatMap((cells, row) => cells.flatMap((cell, column) => {
  const lesson = kLesson.exec(cell);
  const image = lesson && kImage.exec(rows[row - 1]?.[column] ?? "");
  return image ? [[image[1], ...lesson.slice(1)]] : [];
}));
const lessons = () =>
  course.map(([image, number, title, name]) => ({
    name,
    number,
    title,
    page: `lessons/${name}.md`,
    image,
    program: `<programs/lessons/${existsSync(path.join(root, "programs/lessons", name)) ? name : "01_first_ray"}>`,
    copy: `lessons/${name}`,
    copied: existsSync(path.join(folder, "lessons", name)),
  }));

function filesBelow(where, prefix = "") {
  if (!existsSync(path.join(where, prefix))) return [];
  return readdirSync(path.join(where, prefix), { withFileTypes: true }).flatMap((entry) => {
    const name = prefix ? `${prefix}/${entry.name}` : entry.name;
    if (entry.isDirectory()) return filesBelow(where, name);
    const stat = statSync(path.join(where, name));
    return [{ path: name, size: stat.size, modified: stat.mtimeMs / 1000 }];
  });
}

const types = { html: "text/html", js: "text/javascript", css: "text/css", png: "image/png", svg: "image/svg+xml", md: "text/plain; charset=utf-8", json: "application/json" };

async function body(request) {
  const parts = [];
  for await (const part of request) parts.push(part);
  return Buffer.concat(parts);
}

const server = createServer(async (request, response) => {
  const url = new URL(request.url, "http://localhost");
  const target = decodeURIComponent(url.pathname);
  const send = (status, content, headers = {}) => {
    const isText = typeof content === "string" || Buffer.isBuffer(content);
    response.writeHead(status, {
      "Content-Type": isText ? (types[path.extname(target).slice(1)] ?? (target === "/" ? "text/html" : "text/plain; charset=utf-8")) : "application/json",
      "Content-Security-Policy":
        "default-src 'none'; script-src 'self'; style-src 'self' 'nonce-fake'; img-src 'self' data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'",
      ...headers,
    });
    response.end(isText ? content : JSON.stringify(content));
  };
  if (target === "/api/project") send(200, { folder, version: "0.1.0", program: "<programs/lessons/05_shadow>", scene: "", size: [640, 360], samples: 64, timeout: 10, workers: 16 });
  else if (target === "/api/lessons") send(200, lessons());
  else if (target === "/api/programs" && request.method === "GET") {
    const description = (name) => /^\/\/ (?:Lesson \d+: )?(.*)$/m.exec(programText(name)?.files[0].text.split("\n").slice(1).join("\n") ?? "")?.[1] ?? "";
    const builtIn = [...readdirSync(path.join(root, "programs/lessons")).map((name) => `<programs/lessons/${name}>`), ...["ao", "naive", "normals", "pathtracer"].map((name) => `<programs/${name}>`)];
    const own = new Set(filesBelow(folder).filter((file) => /(\.rt\.glsl|program\.toml)$/.test(file.path)).map((file) => path.dirname(file.path)));
    send(200, {
      builtIn: builtIn.map((name) => ({ name, title: name.slice(10, -1), description: description(name) })),
      project: [...own].map((name) => ({ name, title: name, description: description(name) })),
      scenes: filesBelow(folder).map((file) => file.path).filter((file) => /\.(glb|gltf|scene\.toml)$/.test(file)),
    });
  } else if (target === "/api/programs") {
    const { from, to } = JSON.parse((await body(request)).toString());
    mkdirSync(path.join(folder, to), { recursive: true });
    const source = from ? programText(from).files : [{ path: `new/${path.basename(to)}.rt.glsl`, text: readFileSync(path.join(root, "programs/lessons/01_first_ray/first_ray.rt.glsl"), "utf8").replace(/\/\/ scene.*\n/, "") }];
    for (const file of source) writeFileSync(path.join(folder, to, path.basename(file.path)), file.text);
    send(201, { name: to, files: source.map((file) => `${to}/${path.basename(file.path)}`) });
  } else if (target === "/api/program") {
    const program = programText(url.searchParams.get("name"));
    send(program ? 200 : 404, program ?? { error: "the program does not exist" });
  } else if (target === "/api/files") send(200, { files: filesBelow(folder), truncated: false });
  else if (target.startsWith("/api/files/")) {
    const file = path.join(folder, target.slice(11));
    const old = existsSync(file) ? hashOf(readFileSync(file)) : "";
    if (request.method === "PUT") {
      const content = await body(request);
      const match = request.headers["if-match"];
      if (match !== "*" && match !== `"${old}"` && !(request.headers["if-none-match"] === "*" && old === "")) send(412, { error: "the file has a different content", hash: old });
      else {
        mkdirSync(path.dirname(file), { recursive: true });
        writeFileSync(file, content);
        send(200, { path: target.slice(11), hash: hashOf(content), size: content.length });
        for (const session of sessions) session.saved();
      }
    } else if (old) send(200, readFileSync(file), { ETag: `"${old}"` });
    else send(404, { error: "the file does not exist" });
  } else if (target.startsWith("/api/docs/")) {
    const file = path.join(root, "docs", target.slice(10));
    if (existsSync(file)) send(200, readFileSync(file));
    else send(404, { error: "the page does not exist" });
  } else if (target === "/api/library") send(200, [{ path: "quintet/camera.glsl", text: readFileSync(path.join(root, "shaders/quintet/camera.glsl"), "utf8") }]);
  else {
    const file = path.join(web, "dist", target === "/" ? "index.html" : path.basename(target));
    if (existsSync(file)) send(200, target === "/" ? readFileSync(file, "utf8").replaceAll("__CSP_NONCE__", "fake") : readFileSync(file));
    else send(404, { error: "not found" });
  }
});

// WebSocket: frames of text and binary messages, without extensions.

const sessions = new Set();

function frame(content) {
  const binary = Buffer.isBuffer(content);
  const data = binary ? content : Buffer.from(content);
  const head = data.length < 126 ? Buffer.from([0, data.length]) : data.length < 65536 ? Buffer.from([0, 126, data.length >> 8, data.length & 255]) : Buffer.alloc(10);
  if (data.length >= 65536) {
    head[1] = 127;
    head.writeBigUInt64BE(BigInt(data.length), 2);
  }
  head[0] = 0x80 | (binary ? 2 : 1);
  return Buffer.concat([head, data]);
}

function run(args) {
  return new Promise((resolve) => execFile(quintet, args, { maxBuffer: 1 << 26, timeout: 60_000 }, (error, stdout, stderr) => resolve({ failed: error !== null, stdout, stderr })));
}

class FakeSession {
  constructor(socket) {
    this.socket = socket;
    this.number = 0;
    this.timer = undefined;
    this.state = undefined;
  }
  event(name, fields, id) {
    if (!this.socket.destroyed) this.socket.write(frame(JSON.stringify({ event: name, ...(id !== undefined && { id }), ...fields })));
  }
  saved() {
    if (!this.state) return;
    this.event("reloaded", { files: "" });
    this.soon();
  }
  soon() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => void this.render(), 30);
  }
  get target() {
    return isBuiltIn(this.state.program) ? this.state.program.slice(10, -1) : path.join(folder, this.state.program);
  }
  shown(file) {
    return isBuiltIn(this.state.program) ? file.replace(/^<?(?:programs\/)?(lessons\/[^/]+|[^/]+)\/(?=[^/]*$)/, `${this.state.program}/`) : path.relative(folder, file);
  }
  async open(command) {
    this.event("opening", { number: command.number ?? 0 });
    if (command.files) {
      const where = mkdtempSync(path.join(folder, ".check-"));
      for (const [name, text] of Object.entries(command.files)) writeFileSync(path.join(where, name), text);
      command.program = path.basename(where);
    }
    this.state = { program: command.program, parameters: {}, output: "", exposure: 0, tonemap: "default", width: command.width ?? 640, height: command.height ?? 360, samples: command.samples ?? 64, frame: 0, frames: false, still: false, paused: false, camera: { from: [0, 1, 4], at: [0, 0, 0], up: [0, 1, 0], fov: 45 }, environment: { source: "", intensity: 1, rotation: 0, on: true }, canUndo: false, canRedo: false, prints: false };
    this.event("worker", { state: "started", message: "", restarts: 0 });
    this.event("stage", { text: "compiling" });
    const { stdout, stderr, failed } = await run(["run", this.target, "--help", "--json"]);
    if (failed) {
      this.event("error", { message: stderr.trim() }, command.id);
      return;
    }
    const description = JSON.parse(stdout);
    this.state.frames = description.accumulation === "program";
    this.state.output = description.outputs[0].name;
    for (const parameter of description.parameters) this.state.parameters[parameter.name] = command.parameters?.[parameter.name] ?? parameter.default;
    this.event("opened", { program: command.program, scene: "", device: "llvmpipe (fake server)", description, materials: [], lights: [], instances: [], cameras: [], usesCamera: true, animated: false, lastFrame: 0 });
    this.event("state", this.state);
    this.event("done", {}, command.id);
    await this.render();
  }
  async render() {
    const state = this.state;
    const graphFile = path.join(folder, `.graph-${process.pid}.json`);
    const check = await run(["check", this.target, "--json", "--graph", graphFile]);
    let diagnostics = [];
    try {
      diagnostics = JSON.parse(check.stdout);
    } catch {
      this.event("error", { message: check.stderr.trim() });
    }
    for (const diagnostic of diagnostics) {
      diagnostic.file = this.shown(diagnostic.file);
      for (const related of diagnostic.related ?? []) related.file = this.shown(related.file);
    }
    const broken = diagnostics.some((diagnostic) => diagnostic.severity === "error");
    this.event("diagnostics", { diagnostics, outdated: broken });
    if (existsSync(graphFile)) {
      const graph = JSON.parse(readFileSync(graphFile, "utf8"));
      for (const stage of graph.stages) stage.file = this.shown(stage.file);
      for (const call of [...graph.traces, ...graph.calls]) call.location.file = this.shown(call.location.file);
      for (const diagnostic of graph.diagnostics) diagnostic.file = this.shown(diagnostic.file);
      this.event("graph", { graph });
    }
    if (broken) return;
    const file = path.join(folder, `.image-${process.pid}-${this.number}.png`);
    const sets = Object.entries(state.parameters).flatMap(([name, value]) => ["--set", `${name}=${value}`]);
    const count = state.frames ? ["--spp", String(Math.min(state.samples, 8))] : ["--spp", "4"];
    this.event("restarted", {});
    const result = await run(["run", this.target, "-o", file, "--size", `${state.width}x${state.height}`, ...count, ...sets]);
    if (result.failed) {
      this.event("error", { message: result.stderr.trim().split("\n").pop() });
      return;
    }
    const head = Buffer.alloc(32);
    head.write("QIMG");
    [1, ++this.number, state.width, state.height, 1, state.samples].forEach((value, i) => head.writeUInt32LE(value, 4 + 4 * i));
    head[28] = 2;
    head[29] = 1;
    this.event("image", { number: this.number, samples: state.samples, width: state.width, height: state.height, factor: 1, complete: true });
    this.socket.write(frame(Buffer.concat([head, readFileSync(file)])));
    this.event("statistics", { samples: state.samples, frames: state.frames, seconds: 1, raysPerSecond: 3.1e6, error: 0.021 });
  }
  async command(command) {
    const { id, do: name } = command;
    if (name === "open") return this.open(command);
    if (name === "received") return;
    if (name === "set") this.state.parameters[command.parameter] = command.value;
    else if (name === "samples") this.state.samples = command.count;
    else if (name === "size") Object.assign(this.state, { width: command.width, height: command.height });
    else if (name === "pause") this.state.paused = command.on;
    else if (name === "explain") {
      const { stdout, stderr, failed } = await run(["explain-pixel", "--program", this.target, "--pixel", `${command.x},${command.y}`, "--size", `${this.state.width}x${this.state.height}`, "--json"]);
      if (failed) this.event("error", { message: stderr.trim() }, id);
      else {
        const text = isBuiltIn(this.state.program) ? stdout : stdout.replaceAll(`${folder}/`, "");
        const explanation = JSON.parse(text, (key, value) => (key === "file" && isBuiltIn(this.state.program) ? this.shown(value) : value));
        this.event("explained", { x: command.x, y: command.y, sample: 0, explanation }, id);
        this.event("done", {}, id);
      }
      return;
    } else if (name === "value") {
      this.event("value", { x: command.x, y: command.y, value: [0.25, 0.5, 0.75, 1] }, id);
      return;
    } else if (name === "pick") {
      this.event("picked", { x: command.x, y: command.y, instance: "floor", geometry: 0, primitive: 1, material: "clay", position: [0, 0, 1], normal: [0, 1, 0], front: true, distance: 3.2 }, id);
      return;
    }
    this.event("state", this.state);
    this.event("done", {}, id);
    if (name === "set" || name === "samples" || name === "size") this.soon();
  }
}

server.on("upgrade", (request, socket) => {
  const accept = createHash("sha1").update(`${request.headers["sec-websocket-key"]}258EAFA5-E914-47DA-95CA-C5AB0DC85B11`).digest("base64");
  socket.write(`HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: ${accept}\r\n\r\n`);
  const session = new FakeSession(socket);
  sessions.add(session);
  let buffer = Buffer.alloc(0);
  socket.on("data", (data) => {
    buffer = Buffer.concat([buffer, data]);
    for (;;) {
      if (buffer.length < 6) return;
      let length = buffer[1] & 127;
      let at = 2;
      if (length === 126) {
        length = buffer.readUInt16BE(2);
        at = 4;
      } else if (length === 127) {
        length = Number(buffer.readBigUInt64BE(2));
        at = 10;
      }
      if (buffer.length < at + 4 + length) return;
      const mask = buffer.subarray(at, at + 4);
      const content = Buffer.from(buffer.subarray(at + 4, at + 4 + length));
      for (let i = 0; i < content.length; ++i) content[i] ^= mask[i & 3];
      const kind = buffer[0] & 15;
      buffer = buffer.subarray(at + 4 + length);
      if (kind === 8) socket.end();
      else if (kind === 1) void session.command(JSON.parse(content.toString())).catch((error) => session.event("error", { message: error.message }));
    }
  });
  const end = () => sessions.delete(session);
  socket.on("close", end);
  socket.on("error", end);
});

server.listen(port, "127.0.0.1", () => console.log(`http://127.0.0.1:${server.address().port}/, files in ${folder}`));
