// SPDX-License-Identifier: Apache-2.0
// Starts quintet-lab with a project folder of its own, and Chromium; waits for states of the page. Nothing here, and no test, waits
// for a fixed time or requires a speed: a slow machine only takes longer. Environment: QUINTET_LAB, the server; WEB, the folder
// with node_modules; CHROMIUM, the browser, for startBrowser().
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtempSync, readdirSync, readFileSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import path from "node:path";
import { after, afterEach, before, beforeEach } from "node:test";

const { QUINTET_LAB, WEB, CHROMIUM } = process.env;
for (const [name, value] of Object.entries({ QUINTET_LAB, WEB })) if (!value) throw new Error(`the environment variable ${name} is missing`);
const { chromium } = createRequire(path.join(WEB, "package.json"))("playwright-core");

// Milliseconds that anything may take on a slow machine with a busy CPU.
export const kPatience = Number(process.env.PATIENCE ?? 60_000);

export class Server {
  static async start({ folder, port = 0, args = [], env = {} } = {}) {
    const server = new Server();
    server.ownsFolder = folder === undefined;
    server.folder = folder ?? mkdtempSync(path.join(tmpdir(), "quintet-lab-page-"));
    server.process = spawn(QUINTET_LAB, [server.folder, "--no-open", "--port", String(port), ...args], { stdio: ["ignore", "pipe", "pipe"], env: { ...process.env, ...env } });
    server.output = "";
    server.url = await new Promise((resolve, reject) => {
      const read = (data) => {
        server.output += data;
        const url = /http:\/\/\S+/.exec(server.output)?.[0];
        if (url) resolve(url);
      };
      server.process.stdout.on("data", read);
      server.process.stderr.on("data", read);
      server.process.on("exit", (code) => reject(new Error(`the server ended with status ${code}: ${server.output}`)));
    });
    return server;
  }
  get origin() {
    return new URL(this.url).origin;
  }
  get port() {
    return Number(new URL(this.url).port);
  }
  // Process ids of the workers.
  workers() {
    const children = readFileSync(`/proc/${this.process.pid}/task/${this.process.pid}/children`, "utf8").trim();
    const ids = new Set(children ? children.split(" ").map(Number) : []);
    for (const task of readdirSync(`/proc/${this.process.pid}/task`)) {
      const more = readFileSync(`/proc/${this.process.pid}/task/${task}/children`, "utf8").trim();
      for (const id of more ? more.split(" ") : []) ids.add(Number(id));
    }
    return [...ids];
  }
  async stop({ keepFolder = false } = {}) {
    if (this.process.exitCode === null && this.process.signalCode === null) {
      this.process.removeAllListeners("exit");
      const ended = new Promise((resolve) => this.process.once("exit", resolve));
      this.process.kill("SIGTERM");
      await Promise.race([ended, new Promise((resolve) => setTimeout(resolve, 5000))]);
      this.process.kill("SIGKILL");
    }
    if (this.ownsFolder && !keepFolder) rmSync(this.folder, { recursive: true, force: true });
  }
}

export async function startBrowser() {
  if (!CHROMIUM) throw new Error("the environment variable CHROMIUM is missing");
  return chromium.launch({ executablePath: CHROMIUM, args: ["--no-sandbox", "--disable-gpu"] });
}

// Small images with few samples are complete soon.
export const kSmall = ["--size", "320x180", "--spp", "4"];

// Hooks of a file of tests in Chromium: a browser and a server for all of them, and a context for each. The tests share the
// folder of the server: each edits a lesson of its own.
export function useBrowser({ args = kSmall } = {}) {
  const used = {
    // Opens a page with the token. `prepare` can change it before it loads.
    open: async (hash, prepare) => (used.page = await openPage(used.context, used.server.url + hash, prepare)),
  };
  before(async () => {
    used.browser = await startBrowser();
    used.server = await Server.start({ args });
  });
  after(async () => {
    await used.browser?.close();
    await used.server?.stop();
  });
  beforeEach(async () => {
    used.context = await used.browser.newContext({ viewport: { width: 1440, height: 900 } });
  });
  afterEach(async (t) => {
    const { page } = used;
    if (t.error && page && process.env.SCREENSHOTS) await page.screenshot({ path: path.join(process.env.SCREENSHOTS, `${t.name.replace(/\W+/g, "_")}.png`) }).catch(() => undefined);
    used.page = undefined;
    await used.context.close();
    assert.deepEqual(page?.problems ?? [], []);
  });
  return used;
}

// Waits until the function, which can be asynchronous, returns something true, and returns that.
export async function until(condition) {
  const end = Date.now() + kPatience;
  for (;;) {
    const value = await condition();
    if (value) return value;
    if (Date.now() > end) throw new Error(`not within ${kPatience / 1000} s: ${condition}`);
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
}

// Holds requests of a page whose URL matches the pattern, until release().
export async function holdRequests(page, pattern) {
  const waiting = [];
  let open = false;
  await page.route(pattern, (route) => (open ? route.continue() : void waiting.push(route)));
  return {
    get count() {
      return waiting.length;
    },
    async release() {
      open = true;
      await Promise.all(waiting.splice(0).map((route) => route.continue()));
    },
  };
}

// Passes the messages of a page to the server and back. While `held` is set, commands wait, except that images are confirmed.
export async function watchSocket(page) {
  const gate = { held: false, confirmed: 0, waiting: [] };
  await page.routeWebSocket(/\/ws$/, (socket) => {
    const server = socket.connectToServer();
    gate.release = () => {
      gate.held = false;
      for (const message of gate.waiting.splice(0)) server.send(message);
    };
    socket.onMessage((message) => {
      const isConfirmation = JSON.parse(message).do === "received";
      gate.confirmed += isConfirmation ? 1 : 0;
      if (gate.held && !isConfirmation) gate.waiting.push(message);
      else server.send(message);
    });
    server.onMessage((message) => socket.send(message));
  });
  return gate;
}

// A page whose errors, and requests to other hosts, end the test.
export async function openPage(context, url, prepare) {
  const page = await context.newPage();
  page.problems = [];
  page.on("pageerror", (error) => page.problems.push(`error in the page: ${error.message}`));
  page.on("console", (message) => {
    if (message.type() === "error" && /Content Security Policy|Uncaught/.test(message.text())) page.problems.push(message.text());
  });
  page.on("request", (request) => {
    const { protocol, host } = new URL(request.url());
    if (/^(http|ws)s?:$/.test(protocol) && host !== new URL(url).host) page.problems.push(`request to ${host}`);
  });
  // For the development of the page: a folder whose build replaces the embedded one.
  if (process.env.PAGE)
    for (const [name, type] of [["lab.js", "text/javascript"], ["lab.css", "text/css"]])
      await page.route(`**/${name}`, (route) => route.fulfill({ path: path.join(process.env.PAGE, name), contentType: type }));
  page.setDefaultTimeout(kPatience);
  // The browser can tell a page that is already open about interception later than about the next key, so holdRequests() would
  // miss a request. A route that matches nothing turns interception on before the page loads.
  await page.route(() => false, (route) => route.fallback());
  await prepare?.(page);
  await page.goto(url);
  return page;
}

// The displayed pixels as a text.
export function imageOf(page) {
  return page.evaluate(() => document.querySelector("canvas.image").toDataURL());
}

export async function waitForImage(page) {
  await page.waitForFunction(() => /(Frame \d+|\d+ of \d+ samples)/.test(document.querySelector(".image-facts")?.textContent ?? "") && document.querySelector(".image-overlay").hidden && Number(document.querySelector("canvas.image").dataset.shown) > 0);
}

// Waits until all samples are shown, so that only a command changes the image.
export async function waitForComplete(page) {
  await waitForImage(page);
  await page.waitForFunction(() => document.querySelector("canvas.image").dataset.state === "complete");
}

// Pauses a program that counts frames, and returns the number of the frame that is shown.
export async function pauseFrames(page) {
  await page.getByRole("button", { name: "Pause at this frame" }).click();
  await page.getByRole("button", { name: "Play frames" }).waitFor();
  // The image without loss is the last one.
  await page.waitForFunction(() => document.querySelector("canvas.image").dataset.state === "at rest" && /paused/.test(document.querySelector(".image-facts").textContent));
  return frameOf(page);
}

export async function frameOf(page) {
  return Number(await page.evaluate(() => document.querySelector("canvas.image").dataset.samples)) - 1;
}

// Waits until the image differs from `before`, and returns it.
export async function waitForChange(page, before) {
  await page.waitForFunction((old) => document.querySelector("canvas.image").toDataURL() !== old, before);
  return imageOf(page);
}

// The color at a share of the width and height of the image, 0 to 255.
export function colorAt(page, x, y) {
  return page.evaluate(
    ([u, v]) => {
      const canvas = document.querySelector("canvas.image");
      return [...canvas.getContext("2d").getImageData(Math.floor(u * canvas.width), Math.floor(v * canvas.height), 1, 1).data.slice(0, 3)];
    },
    [x, y],
  );
}

// Waits until the function returns true for the color there.
export function waitForColor(page, x, y, matches) {
  return until(async () => matches(await colorAt(page, x, y)));
}

export async function showTab(page, title) {
  await page.getByRole("tab", { name: title, exact: false }).first().click();
}

// Replaces the only occurrence of a text in the shown editor, with the keyboard and the search panel of the editor.
export async function replaceInEditor(page, from, to) {
  await page.locator(".cm-content").first().focus();
  await page.keyboard.press("Control+f");
  const panel = page.locator(".cm-search");
  await panel.locator("input[name=search]").fill(from);
  await panel.locator("input[name=replace]").fill(to);
  await panel.locator("[name=replaceAll]").click();
  await panel.locator("[name=close]").click();
}

export async function waitForSaved(page) {
  await page.locator(".save-state", { hasText: /^Saved$/ }).waitFor();
}

export function openProgram(page, server, name) {
  return page.goto(`${server.origin}/#program=${encodeURIComponent(name)}`);
}

// The file that a click downloads.
export async function downloadOf(page, click) {
  const waiting = page.waitForEvent("download");
  await click();
  const file = await waiting;
  return { name: file.suggestedFilename(), content: readFileSync(await file.path()) };
}

// Chooses an item of the menu "Share".
export async function share(page, item) {
  await page.getByRole("button", { name: "Share" }).click();
  await page.getByRole("menuitem", { name: item }).click();
}
