// SPDX-License-Identifier: Apache-2.0
// The page of the lab in Chromium: editors, problems, saving, and what happens if the process that renders ends.
import assert from "node:assert/strict";
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import { test } from "node:test";
import { colorAt, openPage, replaceInEditor, Server, showTab, until, useBrowser, waitForColor, waitForImage, waitForSaved } from "./harness.mjs";

const lab = useBrowser();

test("a lesson opens with text, editors, image and parameters", async () => {
  const page = await lab.open("#lesson=01_first_ray");
  await page.getByRole("heading", { name: "Lesson 01: the first ray" }).waitFor();
  await waitForImage(page);
  const [r, g, b] = await colorAt(page, 0.37, 0.55);
  assert.ok(r > 240 && g < 16 && b < 16, "the triangle is red, also in a JPEG");
  const tabs = await page.locator(".editor-pane").first().getByRole("tab").allTextContents();
  assert.deepEqual(tabs.slice(0, 4), ["Common", "Ray generation", "Closest hit", "Miss"]);
  await page.locator("[data-parameter=fieldOfView]").waitFor();
  assert.equal(existsSync(path.join(lab.server.folder, "lessons/01_first_ray")), false, "opening does not write");
});

test("an edit is saved and shown; an error is underlined and explained; the fix shows the image again", async () => {
  const page = await lab.open("#lesson=07_mirror_recursion");
  await waitForImage(page);
  await showTab(page, "Miss");
  await replaceInEditor(page, "payload.color = background;", "payload.color = vec3(0.0, 1.0, 0.0);");
  await waitForColor(page, 0.01, 0.01, ([, g]) => g > 250);
  await waitForSaved(page);
  const file = path.join(lab.server.folder, "lessons/07_mirror_recursion/mirror_recursion.rt.glsl");
  assert.match(readFileSync(file, "utf8"), /vec3\(0\.0, 1\.0, 0\.0\)/);

  await replaceInEditor(page, "vec3(0.0, 1.0, 0.0)", "vec3(green)");
  await page.locator(".cm-lintRange-error", { hasText: "green" }).waitFor();
  await page.locator(".problem.error", { hasText: "green" }).waitFor();
  await page.locator(".image-overlay", { hasText: "the image shows the last version without errors" }).waitFor();
  assert.ok((await colorAt(page, 0.01, 0.01))[1] > 250);

  await replaceInEditor(page, "vec3(green)", "vec3(0.0, 0.0, 1.0)");
  await waitForColor(page, 0.01, 0.01, ([, , b]) => b > 250);
  await page.locator(".problem.error").waitFor({ state: "detached" });
});

test("a problem of the linked pipeline has an explanation page and stands out in the diagram", async () => {
  const folder = path.join(lab.server.folder, "broken");
  mkdirSync(folder, { recursive: true });
  const lesson = (name) => path.join(process.env.REPOSITORY, "programs/lessons/17_records", name);
  for (const name of ["program.toml", "records.rgen", "sky.rmiss", "lit.rmiss", "far.rmiss", "matt.rchit", "foil.rchit", "foil_shadow.rahit", "distance.rchit", "payloads.glsl", "records.scene.toml"])
    writeFileSync(path.join(folder, name), readFileSync(lesson(name)));
  const far = path.join(folder, "far.rmiss");
  writeFileSync(far, readFileSync(far, "utf8").replace(/rayPayloadInEXT \w+ (\w+);/, "rayPayloadInEXT mat4 $1;").replace(/void main\(\)[\s\S]*/, "void main() { free[0][0] = 0.0; }\n"));
  const page = await lab.open("#program=broken");
  const problem = page.locator(".problem", { hasText: "Q101" });
  await problem.first().getByRole("button", { name: "Explain Q101" }).click();
  await page.getByRole("dialog", { name: "Q101" }).getByText("Why it matters").waitFor();
  await page.keyboard.press("Escape");
  await problem.first().getByRole("button", { name: "Diagram" }).click();
  await page.locator(".pipeline .reported").first().waitFor();
});

test("completion, hover help and undo in the editor", async () => {
  const page = await lab.open("#lesson=05_shadow");
  await showTab(page, "Miss");
  await page.locator(".cm-line", { hasText: "lampIsSeen" }).click();
  await page.keyboard.press("End");
  await page.keyboard.type(" vec3 d = gl_WorldRayD");
  await page.locator(".cm-tooltip-autocomplete", { hasText: "gl_WorldRayDirectionEXT" }).waitFor();
  assert.equal(await page.locator(".cm-tooltip-autocomplete", { hasText: "gl_HitTEXT" }).count(), 0);
  await page.keyboard.press("Escape");
  for (let i = 0; i < 6; ++i) await page.keyboard.press("Control+z");
  await page.locator(".cm-line", { hasText: "vec3 d = gl_World" }).waitFor({ state: "detached" });
  await page.locator(".cm-line", { hasText: "payload.color" }).first().hover({ position: { x: 40, y: 8 } });
  await page.locator(".code-help", { hasText: "RayPayloadType" }).waitFor();
});

test("code is formatted, and a message says by what", async () => {
  const page = await lab.open("#lesson=16_callable");
  await showTab(page, "Miss");
  await page.locator(".cm-line", { hasText: "payload.color" }).first().click();
  await page.keyboard.press("End");
  await page.keyboard.type(" if(true)payload.color*=1.0;");
  await page.keyboard.press("Escape");
  await page.getByRole("button", { name: "Format" }).first().click();
  // The message disappears after some time.
  const message = await page.waitForFunction(() => [...document.querySelectorAll(".toast")].map((toast) => toast.textContent).find((text) => /Formatted by clang-format|Indented only: clang-format is not installed/.test(text)));
  if (/Formatted by/.test(await message.jsonValue())) await page.locator(".cm-line", { hasText: /^  if \(true\) payload\.color \*= 1\.0;$/ }).waitFor();
  await waitForSaved(page);
});

test("two tabs are independent sessions, and an edit in one is merged into the other", async () => {
  const first = await lab.open("#lesson=02_cameras");
  await waitForImage(first);
  await showTab(first, "Miss");
  await replaceInEditor(first, "0.5 + 0.5 * gl_WorldRayDirectionEXT", "vec3(1.0, 0.0, 0.0)");
  await waitForSaved(first);
  const second = await openPage(lab.context, lab.server.origin + "/#lesson=02_cameras");
  await waitForImage(second);
  await showTab(second, "Miss");
  await second.locator(".cm-line", { hasText: "vec3(1.0, 0.0, 0.0)" }).waitFor();
  await replaceInEditor(second, "vec3(1.0, 0.0, 0.0)", "vec3(0.0, 0.0, 1.0)");
  await waitForSaved(second);
  await first.locator(".cm-line", { hasText: "vec3(0.0, 0.0, 1.0)" }).waitFor();
  await waitForColor(first, 0.01, 0.01, ([r, , b]) => r < 20 && b > 250);
  assert.equal(lab.server.workers().length >= 2, true);
  assert.deepEqual(second.problems, []);
  await second.close();
});

test("an external change of the same lines asks which version counts", async () => {
  const page = await lab.open("#lesson=03_mesh_data");
  await waitForImage(page);
  await showTab(page, "Miss");
  await replaceInEditor(page, "payload.color = vec3(0.0);", "payload.color = vec3(0.1);");
  await waitForSaved(page);
  const file = path.join(lab.server.folder, "lessons/03_mesh_data/mesh_data.rt.glsl");
  // The next save meets different content on disk.
  let changed = false;
  await page.route("**/api/files/**", (route) => {
    if (route.request().method() === "PUT" && !changed) {
      changed = true;
      writeFileSync(file, readFileSync(file, "utf8").replace("payload.color = vec3(0.1);", "payload.color = vec3(0.2);"));
    }
    return route.continue();
  });
  await page.locator(".cm-line", { hasText: "vec3(0.1)" }).click();
  await page.keyboard.press("End");
  await page.keyboard.insertText(" // mine"); // at once: a save after its first letters would open the dialog for the others
  const dialog = page.getByRole("dialog", { name: /was changed on disk/ });
  await dialog.getByRole("button", { name: "Keep my version" }).click();
  await waitForSaved(page);
  assert.match(readFileSync(file, "utf8"), /vec3\(0\.1\); \/\/ mine/);
});

test("a killed worker starts again", async () => {
  const page = await lab.open("#lesson=01_first_ray");
  await waitForImage(page);
  const [worker] = lab.server.workers();
  process.kill(worker, "SIGKILL");
  await page.locator(".toast.error", { hasText: "crashed" }).waitFor();
  const before = await page.evaluate(() => Number(document.querySelector("canvas.image").dataset.shown));
  await page.waitForFunction((count) => Number(document.querySelector("canvas.image").dataset.shown) > count, before);
  await waitForImage(page);
  assert.ok(!lab.server.workers().includes(worker));
});

test("an endless shader ends in a message, which disappears when the fix shows the image", async () => {
  const own = await Server.start({ args: ["--size", "64x36", "--timeout", "3"] });
  try {
    const page = (lab.page = await openPage(lab.context, own.url + "#lesson=01_first_ray"));
    await waitForImage(page);
    await showTab(page, "Miss");
    const endless = "float x = 1.0; while (x > 0.0) x = fract(x * 1.37) + 0.1; payload.color = vec3(x);";
    await replaceInEditor(page, "payload.color = vec3(0.0);", endless);
    await page.locator(".image-overlay", { hasText: "takes too long" }).or(page.locator(".image-overlay", { hasText: "has stopped" })).first().waitFor();
    await replaceInEditor(page, endless, "payload.color = vec3(0.0, 0.5, 0.0);");
    await waitForColor(page, 0.03, 0.03, ([r, g]) => r < 20 && g > 100);
    await waitForImage(page);
    assert.doesNotMatch(await page.locator("body").innerText(), /too long|too slow|has stopped/);
  } finally {
    await own.stop();
  }
});

test("the page connects again after a restart of the server, and edits survive", async () => {
  const own = await Server.start({ args: ["--size", "320x180"] });
  try {
    const page = (lab.page = await openPage(lab.context, own.url + "#lesson=01_first_ray"));
    await waitForImage(page);
    const { port } = own;
    await own.stop({ keepFolder: true });
    await page.locator(".image-overlay", { hasText: "does not answer" }).waitFor();
    await showTab(page, "Miss");
    await replaceInEditor(page, "payload.color = vec3(0.0);", "payload.color = vec3(0.0, 0.0, 1.0);");
    const again = await Server.start({ folder: own.folder, port, args: ["--size", "320x180"] });
    try {
      // The new server has a new token: the page says so, and the browser gets the new cookie from the new address.
      await page.locator(".image-overlay", { hasText: "new token" }).waitFor();
      const other = await openPage(lab.context, again.url);
      await other.close();
      await page.bringToFront();
      // The page can have connected by itself already.
      await until(async () => {
        await page.evaluate(() => [...document.querySelectorAll(".image-overlay button")].find((button) => button.textContent === "Connect now")?.click());
        return page.evaluate(() => !/No connection|does not answer/.test(document.querySelector(".image-overlay").textContent));
      });
      await waitForImage(page);
      await page.keyboard.press("Control+s");
      await waitForSaved(page);
      await waitForColor(page, 0.01, 0.01, ([r, , b]) => r < 20 && b > 250);
    } finally {
      await again.stop({ keepFolder: true });
    }
  } finally {
    await own.stop();
  }
});
