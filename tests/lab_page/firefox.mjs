// SPDX-License-Identifier: Apache-2.0
// Firefox through WebDriver BiDi: starts the browser with a profile of its own, and drives one page with real pointer and key
// events. Environment: FIREFOX, the browser; WEB, the folder with node_modules.
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import path from "node:path";
import { kPatience } from "./harness.mjs";

const WebSocket = createRequire(path.join(process.env.WEB, "package.json"))("ws");
const kPoll = 50; // ms between two looks at the page

// Code points of WebDriver for keys without a character.
export const kKeys = { end: "\uE010", home: "\uE011", left: "\uE012", right: "\uE014", backspace: "\uE003", escape: "\uE00C", control: "\uE009", enter: "\uE007" };

export class Firefox {
  static async start({ width = 1440, height = 900 } = {}) {
    const browser = new Firefox();
    browser.profile = mkdtempSync(path.join(tmpdir(), "quintet-firefox-"));
    browser.process = spawn(process.env.FIREFOX, ["--headless", "--no-remote", "--profile", browser.profile, "--remote-debugging-port", "0", "about:blank"], {
      stdio: ["ignore", "ignore", "pipe"],
      env: { ...process.env, HOME: browser.profile, MOZ_CRASHREPORTER_DISABLE: "1" },
    });
    try {
      const address = await browser.address();
      await browser.connect(`${address}/session`);
      await browser.send("session.new", { capabilities: {} });
      await browser.send("session.subscribe", { events: ["log.entryAdded"] });
      browser.context = (await browser.send("browsingContext.getTree", {})).contexts[0].context;
      await browser.send("browsingContext.setViewport", { context: browser.context, viewport: { width, height } });
    } catch (error) {
      await browser.stop();
      throw error;
    }
    return browser;
  }

  problems = []; // errors of the page

  address() {
    return new Promise((resolve, reject) => {
      let output = "";
      const timer = setTimeout(() => reject(new Error(`Firefox does not start: ${output}`)), kPatience);
      this.process.on("exit", (code) => reject(new Error(`Firefox ended with status ${code}: ${output}`)));
      this.process.stderr.on("data", (data) => {
        output += data;
        const found = /WebDriver BiDi listening on (ws:\/\/\S+)/.exec(output);
        if (!found) return;
        clearTimeout(timer);
        resolve(found[1]);
      });
    });
  }

  connect(address) {
    this.waiting = new Map();
    this.socket = new WebSocket(address, { perMessageDeflate: false, maxPayload: 1 << 28 });
    this.socket.on("message", (data) => {
      const message = JSON.parse(data);
      if (message.method === "log.entryAdded" && message.params.level === "error") this.problems.push(message.params.text);
      const waiting = this.waiting.get(message.id);
      this.waiting.delete(message.id);
      if (message.type === "success") waiting?.resolve(message.result);
      else if (message.type === "error") waiting?.reject(new Error(`${message.error}: ${message.message}`));
    });
    return new Promise((resolve, reject) => {
      this.socket.on("open", resolve);
      this.socket.on("error", reject);
    });
  }

  send(method, params) {
    const id = (this.lastId = (this.lastId ?? 0) + 1);
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject });
      this.socket.send(JSON.stringify({ id, method, params }));
    });
  }

  async stop() {
    // The answer can be lost with the connection.
    if (this.socket?.readyState === WebSocket.OPEN) void this.send("browser.close", {}).catch(() => undefined);
    else this.process.kill("SIGTERM");
    if (this.process.exitCode === null && this.process.signalCode === null) {
      this.process.removeAllListeners("exit");
      const ended = new Promise((resolve) => this.process.once("exit", resolve));
      await Promise.race([ended, new Promise((resolve) => setTimeout(resolve, 5000))]);
      this.process.kill("SIGKILL");
    }
    this.socket?.terminate();
    rmSync(this.profile, { recursive: true, force: true, maxRetries: 20, retryDelay: 100 });
  }

  open(url) {
    return this.send("browsingContext.navigate", { context: this.context, url, wait: "complete" });
  }

  // Runs a function in the page; arguments and the result are JSON.
  async evaluate(run, ...args) {
    const { type, result, exceptionDetails } = await this.send("script.callFunction", {
      functionDeclaration: `async (text) => JSON.stringify((await (${run})(...JSON.parse(text))) ?? null)`,
      arguments: [{ type: "string", value: JSON.stringify(args) }],
      target: { context: this.context },
      awaitPromise: true,
    });
    if (type !== "success") throw new Error(exceptionDetails.text);
    return JSON.parse(result.value);
  }

  // Waits until the function returns something true in the page, and returns that.
  async waitFor(run, ...args) {
    const end = Date.now() + kPatience;
    for (;;) {
      const value = await this.evaluate(run, ...args);
      if (value) return value;
      if (Date.now() > end) throw new Error(`not within ${kPatience / 1000} s: ${run}; ${await this.evaluate(() => document.querySelector(".image-view")?.parentElement.textContent)}`);
      await new Promise((resolve) => setTimeout(resolve, kPoll));
    }
  }

  // The middle of the first visible element with this selector whose text contains `text`.
  middleOf(selector, text = "") {
    return this.waitFor(
      (query, part) => {
        const element = [...document.querySelectorAll(query)].find((candidate) => candidate.getClientRects().length > 0 && candidate.textContent.includes(part));
        if (!element) return null;
        element.scrollIntoView({ block: "nearest" });
        const box = element.getBoundingClientRect();
        return { x: Math.round(box.x + box.width / 2), y: Math.round(box.y + box.height / 2), width: box.width, height: box.height };
      },
      selector,
      text,
    );
  }

  pointer(actions) {
    return this.send("input.performActions", { context: this.context, actions: [{ type: "pointer", id: "mouse", parameters: { pointerType: "mouse" }, actions }] });
  }

  async click(selector, text) {
    const { x, y } = await this.middleOf(selector, text);
    await this.pointer([{ type: "pointerMove", x, y }, { type: "pointerDown", button: 0 }, { type: "pointerUp", button: 0 }]);
  }

  // Drags from the middle of an element, in small steps.
  async drag(selector, dx, dy, steps = 20) {
    const { x, y } = await this.middleOf(selector);
    const moves = Array.from({ length: steps }, (_, i) => ({ type: "pointerMove", x: x + Math.round((dx * (i + 1)) / steps), y: y + Math.round((dy * (i + 1)) / steps), duration: 30 }));
    await this.pointer([{ type: "pointerMove", x, y }, { type: "pointerDown", button: 0 }, ...moves, { type: "pointerUp", button: 0 }]);
  }

  // Types characters and keys (kKeys); `held` is pressed meanwhile.
  type(keys, held) {
    const strokes = [...keys].flatMap((value) => [{ type: "keyDown", value }, { type: "keyUp", value }]);
    const actions = held ? [{ type: "keyDown", value: held }, ...strokes, { type: "keyUp", value: held }] : strokes;
    return this.send("input.performActions", { context: this.context, actions: [{ type: "key", id: "keyboard", actions }] });
  }
}
