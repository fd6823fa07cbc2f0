// SPDX-License-Identifier: Apache-2.0
// The page of the lab in Chromium: lessons and their tasks, programs, sharing, the whole page, and users who do not wait.
import assert from "node:assert/strict";
import { existsSync, readdirSync, readFileSync } from "node:fs";
import path from "node:path";
import { test } from "node:test";
import { downloadOf, holdRequests, replaceInEditor, share, showTab, until, useBrowser, waitForColor, waitForImage, waitForSaved, watchSocket } from "./harness.mjs";

const lab = useBrowser();

for (const [lesson, tab, edits] of [
  ["01_first_ray", "Closest hit", [["payload.color = hitColor;", "float level = float(gl_InstanceID + 1); payload.color = 0.25 * vec3(level);"]]],
  ["04_diffuse", "Closest hit", [["payload.color = ambientColor + baseColor * max(dot(normal, toLight), 0.0);", "float d = length(lightPosition - position); payload.color = ambientColor + baseColor * 30.0 / (d * d) * max(dot(normal, toLight), 0.0);"]]],
  ["12_box", "Closest hit", [["vec3(1.0, 2.0, 3.0)))));", "vec3(1.0, 2.0, 3.0))))); vec2 e = abs(hit.texCoord - 0.5); if (max(e.x, e.y) > 0.45) payload.color = vec3(0.05);"]]],
])
  test(`the task of lesson ${lesson} can be done`, async () => {
    const page = await lab.open(`#lesson=${lesson}`);
    const task = page.locator(".task").first();
    await task.getByRole("button", { name: "Check" }).click();
    await task.locator(".failed", { hasText: "of the pixels differ" }).waitFor();
    assert.equal(await task.locator("canvas").count(), 3, "yours, the solution and the difference");
    await showTab(page, tab);
    for (const [from, to] of edits) await replaceInEditor(page, from, to);
    await task.getByRole("button", { name: "Check" }).click();
    await task.locator(".passed").waitFor();
    await waitForSaved(page);
    await page.reload();
    await page.locator(".task.done").first().waitFor();
  });

test("programs are exported and imported, and a shared page has image and sources", async () => {
  const page = await lab.open("#lesson=01_first_ray");
  await waitForImage(page);
  const download = async (item) => (await downloadOf(page, () => share(page, item))).content;
  const html = (await download("Page with image and sources")).toString();
  assert.match(html, /data:image\/png;base64,/);
  assert.match(html, /CLOSEST-HIT SHADER/);
  const zip = await download(/^Program/);
  assert.equal(zip.toString("latin1", 0, 2), "PK");
  await page.keyboard.press("Control+o");
  await page.locator("input[aria-label='File to import']").setInputFiles({ name: "imported one.zip", mimeType: "application/zip", buffer: zip });
  await page.locator(".program-title", { hasText: "imported_one" }).waitFor();
  await waitForImage(page);
  const png = await download(/^Image PNG/);
  assert.equal(png.toString("latin1", 1, 4), "PNG");
});

test("a folder program says why it has no lecture file", async () => {
  const page = await lab.open("#lesson=17_records");
  await page.locator(".program-title", { hasText: "17_records" }).waitFor();
  await share(page, "Lecture file");
  await page.locator(".toast.error", { hasText: "it has the ray types" }).waitFor();
});

test("a new program is created and found by name", async () => {
  const page = await lab.open("#lesson=01_first_ray");
  await page.keyboard.press("Control+o");
  await page.getByLabel("Folder of the new program").fill("fresh/one");
  await page.getByRole("button", { name: "Create" }).click();
  await page.locator(".program-title", { hasText: "fresh/one" }).waitFor();
  await waitForImage(page);
  const tabs = await page.locator(".editor-pane").first().getByRole("tab").allTextContents();
  assert.deepEqual(tabs.slice(0, 4), ["Common", "Ray generation", "Closest hit", "Miss"]);
  await page.keyboard.press("Control+o");
  await page.getByLabel("Filter the programs").fill("fresh");
  await page.locator(".chooser-row", { hasText: "fresh/one" }).waitFor();
  assert.equal(await page.locator(".chooser-row").count(), 1);
});

test("the whole page is reachable with the keyboard, and controls have names", async () => {
  const page = await lab.open("#lesson=01_first_ray");
  await waitForImage(page);
  const seen = new Set();
  for (let i = 0; i < 5; ++i) {
    await page.keyboard.press("F6");
    seen.add(await page.evaluate(() => document.activeElement.closest("section.lessons, section.area")?.getAttribute("aria-label")));
  }
  assert.equal(seen.size, 5, [...seen].join(", "));
  const unnamed = await page.evaluate(() =>
    [...document.querySelectorAll("button, input, select, [role=separator], [role=tab], [role=application]")]
      .filter((element) => element.offsetParent !== null)
      .filter((element) => !(element.getAttribute("aria-label") || element.textContent.trim() || element.labels?.length))
      .map((element) => element.outerHTML.slice(0, 120)),
  );
  assert.deepEqual(unnamed, []);
});

test("themes and sizes of windows: nothing overflows", async () => {
  const page = await lab.open("#lesson=05_shadow");
  await waitForImage(page);
  for (const [width, height] of [[800, 600], [1024, 768], [1280, 800], [1440, 900], [3840, 2160]])
    for (const colorScheme of ["light", "dark"]) {
      await page.setViewportSize({ width, height });
      await page.emulateMedia({ colorScheme });
      await page.waitForFunction(([w, theme]) => innerWidth === w && document.documentElement.dataset.theme === theme, [width, colorScheme]);
      const overflow = await page.evaluate(() => document.documentElement.scrollWidth > innerWidth || document.documentElement.scrollHeight > innerHeight);
      assert.equal(overflow, false, `${width}x${height}`);
      if (process.env.SCREENSHOTS) await page.screenshot({ path: path.join(process.env.SCREENSHOTS, `lab_${width}x${height}_${colorScheme}.png`) });
    }
});

test("a wrong token is refused", async () => {
  const response = await lab.context.request.get(`${lab.server.origin}/?token=00000000000000000000000000000000`);
  assert.equal(response.status(), 403);
  const page = await lab.context.newPage();
  await page.goto(`${lab.server.origin}/?token=wrong`).catch(() => undefined);
  assert.equal(await page.locator(".image-view").count(), 0);
});

// ---- Users who do not wait

const chooseLesson = (page, name) => page.locator(".lessons select").selectOption(name);
const fileOf = (lesson) => path.join(lab.server.folder, `lessons/${lesson}/${lesson.slice(3)}.rt.glsl`);
const programRequests = /\/api\/program\?/;

test("the page can be used before it has an image, and the image has the edit", async () => {
  let socket;
  const page = await lab.open("#lesson=02_cameras", async (opened) => {
    socket = await watchSocket(opened);
    socket.held = true;
  });
  await showTab(page, "Miss");
  await replaceInEditor(page, "0.5 + 0.5 * gl_WorldRayDirectionEXT", "vec3(1.0, 0.0, 0.0)");
  await waitForSaved(page);
  await page.locator(".image-overlay", { hasText: "Starting…" }).waitFor();
  assert.match(readFileSync(fileOf("02_cameras"), "utf8"), /vec3\(1\.0, 0\.0, 0\.0\)/);
  socket.release();
  await waitForColor(page, 0.01, 0.01, ([r, g]) => r > 240 && g < 16);
});

test("controls without a program do nothing or say why", async () => {
  let programs;
  const page = await lab.open("#lesson=01_first_ray", async (opened) => (programs = await holdRequests(opened, programRequests)));
  await until(() => programs.count > 0);
  for (const item of ["Image PNG", "Image values", "Video", "Page with image", /^Program/, "Lecture file"]) await share(page, item);
  for (const name of ["Find", "Format", "Two editors", "Download the image"]) await page.getByRole("button", { name, exact: true }).first().click();
  await showTab(page, "View");
  await page.locator("#view-exposure").fill("1");
  await page.locator("#view-tonemap").selectOption("aces");
  await page.locator("input[aria-label='Scene files']").setInputFiles({ name: "early.glb", mimeType: "model/gltf-binary", buffer: Buffer.from("no glTF") });
  await page.locator(".toast.error", { hasText: "No program is open yet" }).waitFor();
  const messages = await page.locator(".toast").allTextContents();
  assert.doesNotMatch(messages.join("\n"), /undefined|null|TypeError|[Cc]annot read/);
  await programs.release();
  await waitForImage(page);
});

test("Ctrl+O twice opens one dialog", async () => {
  let lists;
  const page = await lab.open("#lesson=01_first_ray");
  await waitForImage(page);
  lists = await holdRequests(page, "**/api/programs");
  await page.keyboard.press("Control+o");
  await page.keyboard.press("Control+o");
  await until(() => lists.count > 0);
  await lists.release();
  await page.getByRole("dialog", { name: "Open a program" }).first().waitFor();
  await page.keyboard.press("Control+o");
  assert.equal(await page.getByRole("dialog").count(), 1);
  await page.keyboard.press("Escape");
  await page.getByRole("dialog").waitFor({ state: "detached" });
});

test("an edit while another lesson is being opened is saved", async () => {
  const page = await lab.open("#lesson=14_csg");
  await page.locator(".program-title", { hasText: "14_csg" }).waitFor();
  const programs = await holdRequests(page, programRequests);
  await chooseLesson(page, "01_first_ray");
  await until(() => programs.count > 0);
  await showTab(page, "Miss");
  await page.locator(".cm-line").last().click();
  await page.keyboard.press("Control+End");
  await page.keyboard.type(" // typed meanwhile");
  await programs.release();
  await page.locator(".program-title", { hasText: "01_first_ray" }).waitFor();
  assert.ok(existsSync(fileOf("14_csg")));
  assert.match(readFileSync(fileOf("14_csg"), "utf8"), /\/\/ typed meanwhile/);
});

test("edits that cannot be saved are not lost without a question", async () => {
  const page = await lab.open("#lesson=20_lambert");
  await page.locator(".program-title").filter({ hasText: "20_" }).waitFor();
  await page.route("**/api/files/**", (route) => (route.request().method() === "PUT" ? route.fulfill({ status: 400, contentType: "application/json", body: '{"error":"the disk is full"}' }) : route.continue()));
  await page.locator(".cm-line").last().click();
  await page.keyboard.type(" // unsaved");
  await page.locator(".save-state", { hasText: "Not saved" }).waitFor();
  await chooseLesson(page, "01_first_ray");
  const dialog = page.getByRole("dialog", { name: "Edits are not saved" });
  await dialog.getByText("the disk is full").waitFor();
  await dialog.getByRole("button", { name: "Stay here" }).click();
  await page.locator(".cm-line", { hasText: "// unsaved" }).waitFor();
  await page.waitForFunction(() => document.querySelector(".lessons select").value.startsWith("20_"));
  await page.route(programRequests, (route) => route.fulfill({ status: 500, contentType: "application/json", body: '{"error":"it cannot be read"}' }), { times: 1 });
  await chooseLesson(page, "01_first_ray");
  await dialog.getByRole("button", { name: "Discard the edits" }).click();
  await page.locator(".toast.error", { hasText: "it cannot be read" }).waitFor();
  await page.locator(".cm-line", { hasText: "// unsaved" }).waitFor({ state: "detached" });
  await waitForSaved(page);
  const copy = path.join(lab.server.folder, "lessons/20_lambert");
  for (const file of readdirSync(copy)) assert.doesNotMatch(readFileSync(path.join(copy, file), "utf8"), /unsaved/, file);
  await chooseLesson(page, "01_first_ray");
  await page.locator(".program-title", { hasText: "01_first_ray" }).waitFor();
});

test("the last of several lessons that are chosen quickly is shown", async () => {
  const page = await lab.open("#lesson=05_shadow");
  await waitForImage(page);
  for (const name of ["16_callable", "17_records", "19_dynamic", "08_refraction"]) await chooseLesson(page, name);
  await page.getByRole("heading", { name: "Lesson 08" }).waitFor();
  await page.locator(".program-title", { hasText: "08_refraction" }).waitFor();
  await waitForImage(page);
  assert.equal(await page.locator(".lessons select").inputValue(), "08_refraction");
  assert.equal(new URL(page.url()).hash, "#lesson=08_refraction");
  const [first] = await page.locator(".editor-pane").first().getByRole("tab").evaluateAll((tabs) => tabs.map((tab) => tab.title));
  assert.match(first, /08_refraction/);
});

test("going back while a lesson is being opened stays at the lesson that is shown", async () => {
  const page = await lab.open("#lesson=05_shadow");
  await page.getByRole("heading", { name: "Lesson 05" }).waitFor(); // has requested the lesson's program
  const programs = await holdRequests(page, programRequests);
  await page.evaluate(() => (location.hash = "#lesson=01_first_ray"));
  await until(() => programs.count > 0);
  let requests = 0;
  page.on("request", (request) => (requests += programRequests.test(request.url()) ? 1 : 0));
  await page.goBack();
  await page.waitForFunction(() => document.querySelector(".lessons select").value === "05_shadow");
  const answered = page.waitForResponse(programRequests);
  await programs.release();
  await (await answered).finished();
  // Answers to later requests arrive after everything that the page does with this one.
  await page.evaluate(async () => {
    for (let i = 0; i < 3; ++i) await (await fetch("/api/project")).json();
  });
  assert.equal(requests, 0, "the lesson is not opened again");
  assert.match(await page.locator(".program-title").textContent(), /05_shadow/);
  assert.equal(new URL(page.url()).hash, "#lesson=05_shadow");
});

test("images of the program before are not shown as those of the new one", async () => {
  let socket;
  const page = await lab.open("#lesson=05_shadow", async (opened) => (socket = await watchSocket(opened)));
  await waitForImage(page);
  socket.held = true;
  await chooseLesson(page, "01_first_ray");
  await page.locator(".program-title", { hasText: "01_first_ray" }).waitFor();
  // The session of lesson 05 still renders frames.
  const confirmed = socket.confirmed;
  await until(() => socket.confirmed >= confirmed + 5);
  assert.match(await page.locator(".image-overlay").textContent(), /Starting/);
  assert.equal(await page.locator(".image-facts").textContent(), "");
  assert.equal(await page.locator("[data-parameter]").count(), 0);
  // A command before the program is open is no error of the render.
  await showTab(page, "View");
  await page.locator("#view-exposure").fill("0.5");
  socket.release();
  await waitForImage(page);
  await showTab(page, "Parameters");
  await page.locator("[data-parameter=hitColor]").waitFor();
  await waitForColor(page, 0.02, 0.02, (color) => Math.max(...color) < 20); // lesson 05 has a blue sky
});

test("a check ends when another lesson is opened", async () => {
  let silent = false; // a check does not end before the page ends it
  const page = await lab.open("#lesson=14_csg", (opened) => opened.routeWebSocket(/\/ws$/, (socket) => void (silent || socket.connectToServer())));
  await waitForImage(page);
  const check = page.locator(".task").first().getByRole("button", { name: "Check" });
  silent = true;
  await check.click();
  await page.locator(".task-result", { hasText: "Rendering" }).waitFor();
  assert.ok(await page.locator(".task-check").evaluateAll((buttons) => buttons.every((button) => button.disabled)));
  silent = false;
  await chooseLesson(page, "01_first_ray");
  await page.locator(".tasks[data-lesson='01_first_ray']").waitFor();
  await check.click();
  await page.locator(".task-result", { hasText: /(of|from) the solution/ }).first().waitFor();
});

test("a tab that changes while it is pressed is selected", async () => {
  const page = await lab.open("#lesson=09_progressive");
  await page.locator(".program-title", { hasText: "09_progressive" }).waitFor();
  const saves = await holdRequests(page, "**/api/files/**");
  await showTab(page, "Miss");
  await page.locator(".cm-line").last().click();
  await page.keyboard.press("Control+End");
  await page.keyboard.type(" // x");
  await until(() => saves.count > 0);
  const box = await page.getByRole("tab", { name: "Common" }).boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await saves.release();
  await waitForSaved(page); // the mark of the tabs changes
  await page.mouse.up();
  await page.getByRole("tab", { name: "Common", selected: true }).waitFor();
});
