// SPDX-License-Identifier: Apache-2.0
// The page of the lab as a student uses it in Chromium: the commands and changes of the lessons, tasks in their order, what an
// image shows, versions, and work that must not be lost.
import assert from "node:assert/strict";
import { existsSync, readFileSync, rmSync } from "node:fs";
import path from "node:path";
import { test } from "node:test";
import { frameOf, imageOf, replaceInEditor, showTab, until, useBrowser, waitForChange, waitForImage, waitForSaved } from "./harness.mjs";

const lab = useBrowser();
const fileOf = (lesson) => path.join(lab.server.folder, `lessons/${lesson}/${lesson.slice(3)}.rt.glsl`);
const textOf = (lesson) => readFileSync(fileOf(lesson), "utf8");
const command = (page, text) => page.locator(".command", { hasText: text }).first().getByRole("button").first();
const shownFrames = (page, frames) => page.waitForFunction((count) => /paused/.test(document.querySelector(".image-facts").textContent) && Number(document.querySelector("canvas.image").dataset.samples) === count, frames);

async function openLesson(name) {
  const page = await lab.open(`#lesson=${name}`);
  await page.locator(`.tasks[data-lesson="${name}"]`).waitFor();
  await waitForImage(page);
  return page;
}

async function check(task) {
  await task.getByRole("button", { name: "Check" }).click();
  await task.locator(".passed, .failed").waitFor();
  return (await task.locator(".passed").count()) > 0;
}

async function chooseVersion(page, name) {
  await page.getByRole("button", { name: "Versions of the program" }).click();
  await page.getByRole("menuitem", { name }).click();
}

for (const [lesson, edits] of [
  ["01_first_ray", [["Closest hit", "payload.color = hitColor;", "payload.color = vec3(0.25 * float(gl_InstanceID + 1));"], ["Miss", "payload.color = vec3(0.0);", "payload.color = vec3(0.5 + 0.5 * gl_WorldRayDirectionEXT.y);"]]],
  ["05_shadow", [["Closest hit", "  payload.color = radiance;", "  if (!payload.lampIsSeen) radiance *= vec3(0.4, 0.5, 1.5);\n  payload.color = radiance;"], ["Closest hit", "float(frameID % framesPerTurn)", "0.0"]]],
])
  test(`the tasks of lesson ${lesson} can be done one after the other in the same program`, async () => {
    const page = await openLesson(lesson);
    const tasks = await page.locator(".task").all();
    assert.equal(tasks.length, edits.length);
    for (const [i, [tab, from, to]] of edits.entries()) {
      assert.equal(await check(tasks[i]), false);
      await showTab(page, tab);
      await replaceInEditor(page, from, to);
      assert.equal(await check(tasks[i]), true, `task ${i + 1}`);
    }
    assert.equal(await check(tasks[0]), true, "the first one stays done");
    assert.equal(await page.locator(".task.done").count(), edits.length);
  });

test("commands of a lesson change parameters, and others have their defaults again", async () => {
  const page = await openLesson("02_cameras");
  assert.equal(await page.locator(".lesson-body pre", { hasText: "quintet run" }).count(), 0);
  const before = await imageOf(page);
  await command(page, "eye = -3, 1, 2").click();
  const left = await waitForChange(page, before);
  await page.locator("[data-parameter=eye].changed").waitFor();
  await page.locator(".command.shown", { hasText: "eye = -3, 1, 2" }).waitFor();
  await command(page, "way = 1").click();
  await waitForChange(page, left);
  await page.locator("[data-parameter=eye]:not(.changed)").waitFor();
  await page.locator("[data-parameter=way].changed").waitFor();
  await command(page, "the two images above").click();
  await page.locator(".command-result .passed", { hasText: "equal up to rounding" }).waitFor();
});

test("a command shows the frame that it writes, and a series of files plays", async () => {
  const page = await openLesson("19_dynamic");
  await command(page, "25 frames").click();
  await shownFrames(page, 25);
  assert.equal(await frameOf(page), 24);
  await command(page, "all frames").click();
  await page.getByRole("button", { name: "Pause at this frame" }).waitFor();
  await page.waitForFunction(() => Number(document.querySelector("canvas.image").dataset.samples) < 25);
});

test("a command shows the program of a different lesson beside the page, and a button leads back", async () => {
  const page = await openLesson("07_mirror_recursion");
  await command(page, "lessons/06_mirror_loop").click();
  await page.locator(".program-title", { hasText: "06_mirror_loop" }).waitFor();
  await waitForImage(page);
  await page.getByRole("heading", { name: "Lesson 07" }).waitFor();
  await page.locator(".version-label", { hasText: /^lessons\/06_mirror_loop$/ }).waitFor();
  await page.getByRole("button", { name: "Back to the lesson" }).click();
  await page.locator(".program-title", { hasText: "07_mirror_recursion" }).waitFor();
  await page.locator(".version-label", { hasText: "Original" }).waitFor();
});

test("commands that describe a pipeline show it, and those without an equivalent can be copied", async () => {
  const page = await openLesson("00_pipeline");
  await page.getByText("the editors show that of lesson 01").waitFor();
  await command(page, "lessons/17_records").click();
  await page.getByRole("tab", { name: "Pipeline", selected: true }).waitFor();
  await page.locator(".pipeline svg").first().waitFor();
  await page.locator(".program-title", { hasText: "17_records" }).waitFor();
  const other = await openLesson("11_many_spheres");
  const terminal = other.locator(".command.terminal", { hasText: `quintet bench ${lab.server.folder}/lessons/11_many_spheres` });
  await terminal.getByText("In a terminal").waitFor();
  await lab.context.grantPermissions(["clipboard-read", "clipboard-write"]);
  await terminal.getByRole("button", { name: "Copy the command" }).click();
  assert.match(await other.evaluate(() => navigator.clipboard.readText()), /^quintet bench \S+\/lessons\/11_many_spheres --size 128x128$/);
});

test("changes of a page are wrapped, and can be made by a button; the version before is kept", async () => {
  const page = await openLesson("04_diffuse");
  const wide = await page.locator(".lesson-body pre.diff").evaluateAll((blocks) => blocks.filter((block) => block.scrollWidth > block.clientWidth + 1).length);
  assert.equal(wide, 0);
  await showTab(page, "Miss");
  await replaceInEditor(page, "payload.color = ", "payload.color = 0.0 + ");
  await waitForSaved(page);
  const mine = textOf("04_diffuse");
  await page.locator(".edit", { hasText: "baseColor * dot(normal, toLight);" }).getByRole("button", { name: "Apply" }).click();
  await until(() => /baseColor \* dot\(normal, toLight\);/.test(textOf("04_diffuse")));
  assert.doesNotMatch(textOf("04_diffuse"), /= 0\.0 \+/, "an exercise starts with the lesson's program");
  await chooseVersion(page, "before a change of the page");
  await until(() => textOf("04_diffuse") === mine);
});

test("a solution and a reset keep the student's version, in the history of the editor and by name", async () => {
  const page = await openLesson("06_mirror_loop");
  const task = page.locator(".task").first();
  await showTab(page, "Closest hit");
  await replaceInEditor(page, "payload.reflectance = reflectance;", "payload.reflectance = 0.125; // mine");
  await waitForSaved(page);
  await task.getByRole("button", { name: "Solution" }).click();
  await page.getByRole("button", { name: "Show the solution" }).click();
  await page.locator(".cm-line", { hasText: "gl_InstanceID == 1 ? reflectance" }).waitFor();
  await page.locator(".version-label", { hasText: "Solution of task 1" }).waitFor();
  await page.locator(".cm-content").first().focus();
  await page.keyboard.press("Control+z");
  await page.locator(".cm-line", { hasText: "0.125; // mine" }).waitFor();
  await waitForSaved(page);
  await task.getByRole("button", { name: "Reset" }).click();
  await page.getByRole("dialog").getByRole("button", { name: "Reset" }).click();
  await page.locator(".cm-line", { hasText: "payload.reflectance = reflectance;" }).waitFor();
  await page.locator(".version-label", { hasText: "Original" }).waitFor();
  // Also after the page was closed, when the editors have no history.
  await waitForSaved(page);
  await page.reload();
  await waitForImage(page);
  await chooseVersion(page, "before the solution of task 1");
  await showTab(page, "Closest hit");
  await page.locator(".cm-line", { hasText: "0.125; // mine" }).waitFor();
  await until(() => /0\.125; \/\/ mine/.test(textOf("06_mirror_loop")));
});

test("pixels that are not finite and traces that are too deep are reported beside the image and in the problems", async () => {
  const page = await openLesson("02_cameras");
  await command(page, "eye = 0, 5, 0 · target").click();
  await page.locator(".image-findings", { hasText: "not finite" }).waitFor();
  const problem = page.locator(".problem.warning", { hasText: "Q002" });
  await problem.getByRole("button", { name: "Pixel" }).click();
  await page.getByRole("tab", { name: "Pixel", selected: true }).waitFor();
  await command(page, "with the defaults").click();
  await page.locator(".image-findings").waitFor({ state: "hidden" });
  await problem.waitFor({ state: "detached" });

  const recursion = await openLesson("07_mirror_recursion");
  await recursion.locator(".edit", { hasText: "recursion: 3" }).getByRole("button", { name: "Apply" }).click();
  await recursion.locator(".image-findings", { hasText: "deeper than the recursion depth 3" }).waitFor();
  await recursion.locator(".problem.warning", { hasText: "Q003" }).getByRole("button", { name: "Explain Q003" }).waitFor();
});

test("run-time checks name the line", async () => {
  const page = await openLesson("05_shadow");
  await page.locator(".edit", { hasText: "position, 0.0, toLamp" }).getByRole("button", { name: "Apply" }).click();
  await waitForSaved(page);
  await page.locator(".command", { hasText: "Run-time checks" }).getByRole("button").first().click();
  await page.locator(".problem", { hasText: "Q005" }).locator(".location").first().waitFor();
});

test("a program whose frames are equal renders one, and a hidden page none", async () => {
  let sent = [];
  let shown = 0;
  const page = await lab.open("#lesson=01_first_ray", (opened) =>
    opened.routeWebSocket(/\/ws$/, (socket) => {
      const server = socket.connectToServer();
      socket.onMessage((message) => {
        const { do: name, on } = JSON.parse(message);
        if (name === "received") ++shown;
        if (name === "pause") sent.push(on);
        server.send(message);
      });
      server.onMessage((message) => socket.send(message));
    }),
  );
  await page.locator(".image-facts", { hasText: "all frames are equal" }).waitFor();
  assert.equal(await page.getByRole("button", { name: "Pause at this frame" }).count(), 0);
  await page.waitForFunction(() => document.querySelector("canvas.image").dataset.state === "complete");
  const images = shown;
  // Answers to later requests arrive after images that were on their way.
  for (let i = 0; i < 20; ++i) await page.evaluate(async () => (await fetch("/api/project")).json());
  assert.equal(shown, images);
  // The browser of the tests does not hide pages.
  const show = (state) => page.evaluate((value) => {
    Object.defineProperty(document, "visibilityState", { value, configurable: true });
    document.dispatchEvent(new Event("visibilitychange"));
  }, state);
  await page.locator(".lessons select").selectOption("19_dynamic");
  await page.getByRole("button", { name: "Pause at this frame" }).waitFor();
  await show("hidden");
  await page.getByRole("button", { name: "Play frames" }).waitFor();
  await show("visible");
  await page.getByRole("button", { name: "Pause at this frame" }).waitFor();
  assert.deepEqual(sent, [true, false]);
});

test("a save that failed is repeated, and the page says so until it succeeds", async () => {
  const page = await openLesson("16_callable");
  let full = true;
  await page.route("**/api/files/**", (route) => (full && route.request().method() === "PUT" ? route.fulfill({ status: 500, contentType: "application/json", body: '{"error":"the disk is full"}' }) : route.continue()));
  await showTab(page, "Miss");
  await page.locator(".cm-line").last().click();
  await page.keyboard.press("Control+End");
  await page.keyboard.type(" // kept");
  await page.locator(".save-state.failed", { hasText: "Not saved: trying again" }).waitFor();
  assert.equal(await page.locator(".toast.error", { hasText: "the disk is full" }).count(), 1);
  const asked = page.waitForEvent("dialog");
  const left = page.close({ runBeforeUnload: true });
  await (await asked).dismiss(); // stay
  await left;
  full = false;
  await waitForSaved(page); // without another edit
  assert.equal(await page.locator(".toast.error").count(), 0, "the message no longer holds");
  assert.match(textOf("16_callable"), /\/\/ kept/);
});

test("a folder that was deleted is not shown as saved, and Ctrl+S writes it again", async () => {
  const page = await openLesson("12_box");
  await showTab(page, "Miss");
  await page.locator(".cm-line").last().click();
  await page.keyboard.press("Control+End");
  await page.keyboard.type(" // here");
  await waitForSaved(page);
  rmSync(path.join(lab.server.folder, "lessons/12_box"), { recursive: true });
  await page.locator(".save-state.missing", { hasText: "Deleted on disk" }).waitFor();
  assert.ok(!existsSync(fileOf("12_box")));
  await page.locator(".cm-content").first().focus();
  await page.keyboard.press("Control+s");
  await waitForSaved(page);
  assert.match(textOf("12_box"), /\/\/ here/);
  await waitForImage(page);
});
