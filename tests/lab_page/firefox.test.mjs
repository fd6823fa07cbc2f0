// SPDX-License-Identifier: Apache-2.0
// The page of the lab in Firefox: editing, an error and its correction, camera, parameters, and the check of a task. The other
// tests of the page run in Chromium.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import path from "node:path";
import { after, before, test } from "node:test";
import { Firefox, kKeys } from "./firefox.mjs";
import { kSmall, Server } from "./harness.mjs";

let server;
let firefox;

before(async () => {
  server = await Server.start({ args: kSmall });
  firefox = await Firefox.start();
  await firefox.open(server.url); // the cookie
});
after(async () => {
  await firefox?.stop();
  await server?.stop();
});

const hasImage = () => Number(document.querySelector("canvas.image")?.dataset.shown) > 0 && document.querySelector(".image-overlay").hidden && /(Frame \d|samples)/.test(document.querySelector(".image-facts").textContent);
const isComplete = () => document.querySelector("canvas.image")?.dataset.state === "complete";
const imageData = () => document.querySelector("canvas.image").toDataURL();
const differs = (before) => document.querySelector("canvas.image").toDataURL() !== before;

const isSaved = () => /^(Saved|Built-in)/.test(document.querySelector(".save-state")?.textContent ?? "Saved");

async function openPage(hash) {
  await firefox.waitFor(isSaved); // else the browser would ask whether to leave
  await firefox.open("about:blank");
  await firefox.open(`${server.origin}/${hash}`);
  await firefox.waitFor(hasImage);
}

// Appends text to the first line with `part` in the shown editor.
async function appendToLine(part, text) {
  await firefox.click(".cm-line", part);
  await firefox.type(kKeys.end);
  await firefox.type(text);
}

test("Firefox: an edit is rendered and saved; an error is underlined; the correction shows the image again", async () => {
  await openPage("#lesson=07_mirror_recursion");
  await firefox.click("[role=tab]", "Miss");
  await appendToLine("payload.color = background;", " payload.color = vec3(0.0, 1.0, 0.0);");
  const isGreen = () => {
    const [r, g] = document.querySelector("canvas.image").getContext("2d").getImageData(2, 2, 1, 1).data;
    return r < 20 && g > 250;
  };
  await firefox.waitFor(isGreen);
  await firefox.waitFor(() => document.querySelector(".save-state").textContent === "Saved");
  const file = readFileSync(path.join(server.folder, "lessons/07_mirror_recursion/mirror_recursion.rt.glsl"), "utf8");
  assert.match(file, /payload\.color = background; payload\.color = vec3\(0\.0, 1\.0, 0\.0\);/);

  await firefox.type(" oops");
  await firefox.type(kKeys.escape); // no completion
  await firefox.waitFor(() => document.querySelector(".cm-lintRange-error") !== null && document.querySelector(".problem.error") !== null);
  assert.match(await firefox.evaluate(() => document.querySelector(".image-overlay").textContent), /last version without errors/);
  await firefox.type(kKeys.backspace.repeat(5));
  await firefox.waitFor(() => document.querySelector(".problem.error") === null && document.querySelector(".image-overlay").hidden);
  assert.deepEqual(await firefox.evaluate(isGreen), true);
});

test("Firefox: dragging turns the camera", async () => {
  await openPage(`#program=${encodeURIComponent("<programs/normals>")}`);
  await firefox.waitFor(isComplete);
  const before = await firefox.evaluate(imageData);
  await firefox.drag(".image-stage", 160, 30);
  await firefox.waitFor(differs, before);
  await firefox.waitFor(isComplete);
});

test("Firefox: parameters change the image", async () => {
  await openPage("#lesson=01_first_ray");
  const before = await firefox.evaluate(imageData);
  await firefox.click("[data-parameter=fieldOfView] input[type=range]");
  await firefox.type(kKeys.right.repeat(10));
  await firefox.waitFor(differs, before);
});

test("Firefox: the task of a lesson fails, is done, and stays done", async () => {
  await openPage("#lesson=01_first_ray");
  await firefox.click(".task button", "Check");
  await firefox.waitFor(() => /of the pixels differ/.test(document.querySelector(".task .failed")?.textContent));
  await firefox.click("[role=tab]", "Closest hit");
  await appendToLine("payload.color = hitColor;", " payload.color = vec3(0.25 * float(gl_InstanceID + 1));");
  await firefox.type(kKeys.escape);
  await firefox.click(".task button", "Check");
  await firefox.waitFor(() => document.querySelector(".task .passed") !== null);
  await openPage("#lesson=01_first_ray");
  await firefox.waitFor(() => document.querySelector(".task.done") !== null);
});

test("Firefox: the page has reported no errors", () => {
  assert.deepEqual(firefox.problems, []);
});
