// SPDX-License-Identifier: Apache-2.0
// All tasks of all lessons in the page: the check rejects the unmodified lesson and shows what differs, and accepts the
// solution. LESSONS, if set, is a pattern of the lessons to run.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { kPatience, openPage, Server, startBrowser, waitForSaved } from "./harness.mjs";

let browser;
let server;
let page;

before(async () => {
  browser = await startBrowser();
  server = await Server.start();
  page = await openPage(await browser.newContext({ viewport: { width: 1440, height: 900 } }), server.url);
});
after(async () => {
  await browser?.close();
  await server?.stop();
});

async function check(task) {
  await task.getByRole("button", { name: "Check" }).click();
  await task.locator(".passed, .failed").waitFor({ timeout: 2 * kPatience });
  return { passed: (await task.locator(".passed").count()) > 0, text: await task.locator(".task-result").textContent() };
}

test("the checks of all tasks reject the lesson and accept the solution", { timeout: 1_800_000 }, async (t) => {
  const lessons = await page.evaluate(async () => (await fetch("/api/lessons")).json());
  assert.equal(lessons.length, 28);
  let count = 0;
  for (const lesson of lessons.filter(({ name }) => new RegExp(process.env.LESSONS ?? "").test(name)))
    await t.test(lesson.name, async () => {
      await page.goto(`${server.origin}/#lesson=${lesson.name}`);
      await page.locator(`.lessons select option[value="${lesson.name}"]`).waitFor({ state: "attached" });
      // The list shows the lesson while the tasks are still those of the one before.
      await page.locator(`.tasks[data-lesson="${lesson.name}"]`).waitFor();
      const tasks = await page.locator(".task").all();
      assert.ok(tasks.length > 0);
      for (const task of tasks) {
        const { passed, text } = await check(task);
        assert.ok(!passed, `the unmodified lesson passes: ${text}`);
        assert.doesNotMatch(text, /does not render|does not answer|took too long/);
        assert.match(text, /solution/, `the message does not compare with the solution: ${text}`);
        // Far from the limit of 0.4 %, so that noise cannot decide.
        const percent = /([\d.]+) % of the pixels differ/.exec(text)?.[1];
        if (percent) assert.ok(Number(percent) > 1.6, `only ${percent} % of the pixels differ`);
      }
      for (const task of tasks) {
        await task.getByRole("button", { name: "Solution" }).click();
        const saved = page.waitForResponse((response) => response.request().method() === "PUT" && response.ok());
        await page.getByRole("button", { name: "Show the solution" }).click();
        await saved;
        await waitForSaved(page);
        const { passed, text } = await check(task);
        assert.ok(passed, `the solution does not pass: ${text}`);
        ++count;
      }
    });
  console.log(`# ${count} tasks`);
  assert.deepEqual(page.problems, []);
});
