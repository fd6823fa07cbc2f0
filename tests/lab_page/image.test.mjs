// SPDX-License-Identifier: Apache-2.0
// The page of the lab in Chromium: the image, camera, parameters, frames, pixels, scenes, and files of the image.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { copyFileSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { test } from "node:test";
import { downloadOf, frameOf, imageOf, kSmall, openPage, pauseFrames, Server, share, showTab, until, useBrowser, waitForChange, waitForColor, waitForComplete, waitForImage } from "./harness.mjs";

const lab = useBrowser();
const kNormals = `#program=${encodeURIComponent("<programs/normals>")}`;

test("dragging turns the camera while the button is pressed, and undo restores the image", async () => {
  const page = await lab.open(kNormals);
  await waitForComplete(page);
  const before = await imageOf(page);
  const box = await page.locator(".image-stage").boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  let shown = before;
  for (let i = 1; i <= 5; ++i) {
    await page.mouse.move(x + 20 * i, y + 5 * i);
    shown = await waitForChange(page, shown);
  }
  await page.mouse.up();
  await waitForComplete(page);
  assert.notEqual(await imageOf(page), before);
  await page.getByRole("button", { name: "Undo a change of camera or parameters" }).click();
  await until(async () => (await imageOf(page)) === before);
});

test("the keyboard turns the camera and zooms", async () => {
  const page = await lab.open(kNormals);
  await waitForComplete(page);
  await page.locator(".image-stage").focus();
  const seen = new Set([await imageOf(page)]);
  for (const key of ["ArrowLeft", "+"]) {
    const before = await imageOf(page);
    await page.keyboard.press(key);
    await waitForChange(page, before);
    await waitForComplete(page);
    seen.add(await imageOf(page));
  }
  assert.equal(seen.size, 3);
});

test("parameters change the image", async () => {
  const page = await lab.open("#lesson=01_first_ray");
  await waitForImage(page);
  await page.locator("[data-parameter=hitColor] input[type=color]").fill("#0000ff");
  await waitForColor(page, 0.37, 0.55, ([r, , b]) => r < 20 && b > 240);
  await page.locator("[data-parameter=hitColor] .reset").click();
  await waitForColor(page, 0.37, 0.55, ([r]) => r > 240);
  await page.locator("[data-parameter=fieldOfView] input[type=range]").focus();
  const before = await imageOf(page);
  for (let i = 0; i < 10; ++i) await page.keyboard.press("ArrowRight");
  await waitForChange(page, before);
});

test("frames can be paused and stepped", async () => {
  const page = await lab.open("#lesson=05_shadow");
  await waitForImage(page);
  const at = await pauseFrames(page);
  for (let frame = at + 1; frame <= at + 2; ++frame) {
    await page.getByRole("button", { name: "Next frame" }).click();
    await page.waitForFunction((count) => Number(document.querySelector("canvas.image").dataset.samples) >= count, frame + 1);
    assert.equal(await frameOf(page), frame, "exactly one more");
  }
  await page.getByRole("button", { name: "Play frames" }).click();
  await until(async () => (await frameOf(page)) > at + 3);

  await pauseFrames(page);
  const workers = lab.server.workers();
  await page.getByRole("button", { name: "First frame" }).click();
  await until(async () => (await frameOf(page)) === 0);
  await page.locator(".image-facts", { hasText: /Frame 0 .*paused/ }).waitFor();
  assert.deepEqual(lab.server.workers(), workers, "the same process renders");
});

test("a click explains the pixel: rays, payload and source lines", async () => {
  const page = await lab.open("#lesson=05_shadow");
  await waitForImage(page);
  await pauseFrames(page);
  const box = await page.locator(".image-stage").boundingBox();
  await page.mouse.click(box.x + box.width * 0.5, box.y + box.height * 0.9);
  await page.locator(".tree .event.ray").nth(1).waitFor(); // a camera ray and a shadow ray
  await page.locator(".tree-detail dt", { hasText: "payload.color" }).first().waitFor();
  await page.locator(".tree button.location", { hasText: /shadow\.rt\.glsl:\d+/ }).first().click();
  await page.locator(".cm-activeLine", { hasText: "traceRayEXT" }).waitFor();
});

test("a broken scene is refused with a message, and the image stays", async () => {
  const page = await lab.open(kNormals);
  await waitForImage(page);
  await showTab(page, "View");
  await page.locator("input[aria-label='Scene files']").setInputFiles({ name: "broken.glb", mimeType: "model/gltf-binary", buffer: Buffer.from("no glTF") });
  await page.locator(".toast.error", { hasText: "broken.glb" }).waitFor();
  await waitForImage(page);
});

test("an uploaded scene is shown", async () => {
  const page = await lab.open(kNormals);
  await waitForComplete(page);
  const before = await imageOf(page);
  await showTab(page, "View");
  const scene = readFileSync(path.join(process.env.REPOSITORY, "examples/scenes/spheres.scene.toml"));
  await page.locator("input[aria-label='Scene files']").setInputFiles({ name: "spheres.scene.toml", mimeType: "text/plain", buffer: scene });
  await waitForChange(page, before);
  await page.waitForFunction(() => document.querySelector("#view-scene").value === "uploads/spheres.scene.toml");
});

test("the last of several scenes that are chosen quickly is shown, also if an earlier one is broken", async () => {
  copyFileSync(path.join(process.env.REPOSITORY, "examples/scenes/spheres.scene.toml"), path.join(lab.server.folder, "good.scene.toml"));
  writeFileSync(path.join(lab.server.folder, "bad.scene.toml"), "[[mesh]]\nshape = 'none'\n");
  const page = await lab.open(kNormals);
  await waitForComplete(page);
  const before = await imageOf(page);
  await showTab(page, "View");
  await page.locator("#view-scene").selectOption("bad.scene.toml");
  await page.locator("#view-scene").selectOption("good.scene.toml");
  await waitForChange(page, before);
  await waitForComplete(page);
  assert.equal(await page.locator("#view-scene").inputValue(), "good.scene.toml");
  assert.notEqual(await imageOf(page), before);
});

test("the image is downloaded with its values as OpenEXR, also twice at a time", async () => {
  const page = await lab.open(kNormals);
  await waitForComplete(page);
  const downloads = [];
  page.on("download", (download) => downloads.push(download));
  for (let i = 0; i < 2; ++i) await share(page, "Image values");
  await until(() => downloads.length === 2);
  const contents = [];
  for (const download of downloads) {
    assert.equal(download.suggestedFilename(), "normals.exr");
    contents.push(readFileSync(await download.path()));
  }
  assert.deepEqual([...contents[0].subarray(0, 4)], [0x76, 0x2f, 0x31, 0x01], "the magic number of OpenEXR");
  assert.match(contents[0].subarray(0, 4096).toString("latin1"), /channels\0chlist/);
  assert.equal(contents[1].length, contents[0].length);
});

// A script stands for ffmpeg: the video is what it gets.
test("a video is rendered with progress, can be canceled, and reports that ffmpeg is missing", async () => {
  const bin = mkdtempSync(path.join(tmpdir(), "quintet-lab-bin-"));
  const own = await Server.start({ env: { PATH: bin }, args: kSmall });
  try {
    const page = (lab.page = await openPage(lab.context, own.url + "#lesson=19_dynamic"));
    await waitForImage(page);
    await share(page, "Video");
    const dialog = page.getByRole("dialog", { name: "Video" });
    await dialog.getByLabel("Frames", { exact: true }).fill("3");
    await dialog.getByRole("button", { name: "Render" }).click();
    await dialog.locator(".video-message.failed", { hasText: "require the program ffmpeg" }).waitFor();

    writeFileSync(path.join(bin, "ffmpeg"), '#!/bin/sh\nfor file; do :; done\n/bin/cat > "$file"\n', { mode: 0o755 });
    const { name, content } = await downloadOf(page, () => dialog.getByRole("button", { name: "Render" }).click());
    assert.equal(name, "19_dynamic.mp4");
    const frame = 320 * 180 * 3;
    assert.equal(content.length, 3 * frame);
    assert.notDeepEqual(content.subarray(0, frame), content.subarray(frame, 2 * frame));

    await dialog.getByLabel("Frames", { exact: true }).fill("9999");
    await dialog.getByRole("button", { name: "Render" }).click();
    await dialog.locator(".video-message", { hasText: "of 9999 frames" }).waitFor();
    await dialog.getByRole("button", { name: "Cancel" }).click();
    await dialog.waitFor({ state: "detached" });
    await until(() => own.workers().length === 1); // the process that rendered has ended
    await waitForImage(page);
  } finally {
    await own.stop();
    rmSync(bin, { recursive: true, force: true });
  }
});

// Frame k of the first three has channel k of the color only.
const kColors = "void main() { /**** RAY GENERATION SHADER ****/\n  gsnSetPixel(vec4(equal(ivec3(frameID), ivec3(0, 1, 2)), 1.0));\n}\n";

test("a video of ffmpeg can be decoded, and has the frames of the program", { skip: process.env.FFMPEG ? false : "ffmpeg is not installed" }, async () => {
  mkdirSync(path.join(lab.server.folder, "colors"));
  writeFileSync(path.join(lab.server.folder, "colors/colors.rt.glsl"), kColors);
  const page = await lab.open("#program=colors");
  await waitForImage(page);
  await share(page, "Video");
  const dialog = page.getByRole("dialog", { name: "Video" });
  await dialog.getByLabel("Frames", { exact: true }).fill("3");
  for (const [format, magic] of [["mp4", /^....ftyp/s], ["webm", /^\x1a\x45\xdf\xa3/], ["gif", /^GIF89a/]]) {
    await dialog.getByLabel("Format").selectOption(format);
    const { name, content } = await downloadOf(page, () => dialog.getByRole("button", { name: "Render" }).click());
    assert.equal(name, `colors.${format}`);
    assert.match(content.toString("latin1", 0, 12), magic);
    const file = path.join(lab.server.folder, name);
    writeFileSync(file, content);
    const decoded = spawnSync(process.env.FFMPEG, ["-v", "error", "-i", file, "-fps_mode", "passthrough", "-pix_fmt", "rgb24", "-f", "rawvideo", "-"], { maxBuffer: 1 << 26 });
    assert.equal(decoded.status, 0, decoded.stderr.toString());
    const frame = 320 * 180 * 3;
    assert.equal(decoded.stdout.length, 3 * frame, format);
    for (let k = 0; k < 3; ++k) {
      const middle = k * frame + frame / 2 + (320 / 2) * 3;
      const color = [...decoded.stdout.subarray(middle, middle + 3)];
      assert.ok(color.every((value, channel) => (channel === k ? value > 220 : value < 35)), `frame ${k} of ${name}: ${color}`);
    }
  }
});
