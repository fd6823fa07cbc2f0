// SPDX-License-Identifier: Apache-2.0
// The tasks of the lessons against the lessons. With QUINTET, the path of the command line program, each solution is
// rendered, too, and the lesson itself must not pass the check.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { test } from "node:test";
import { compareImages, kAllowedShare } from "../src/image_difference";
import { kCheckSize } from "../src/lesson_check";
import { kLessonTasks, type LessonTask, solutionFiles } from "../src/lesson_tasks";
import { decodePng } from "./png";

declare const REPOSITORY: string;

const folder = `${REPOSITORY}/programs/lessons`;
const quintet = process.env["QUINTET"];

function lessonFiles(name: string): { files: Map<string, string>; main: string } {
  const names = readdirSync(`${folder}/${name}`);
  const main = names.find((file) => file.endsWith(".rt.glsl")) ?? "program.toml";
  return { files: new Map(names.map((file) => [file, readFileSync(`${folder}/${name}/${file}`, "utf8")])), main };
}

const kWithoutTasks = ["00_pipeline", "23_monte_carlo", "24_cosine_sampling", "25_next_event", "26_mis", "27_roulette"];

test("every other lesson of the course has a task", () => {
  const pages = readdirSync(`${REPOSITORY}/docs/lessons`).filter((file) => /^\d/.test(file)).map((file) => file.replace(/\.md$/, ""));
  assert.deepEqual([...Object.keys(kLessonTasks), ...kWithoutTasks].sort(), pages.sort());
});

for (const [name, tasks] of Object.entries(kLessonTasks)) {
  test(`the solutions of ${name} fit its program`, () => {
    assert.equal(new Set(tasks.map((task) => task.id)).size, tasks.length);
    const { files, main } = lessonFiles(name);
    for (const task of tasks) {
      const solution = solutionFiles(files, main, task);
      assert.ok([...solution].some(([file, text]) => text !== files.get(file)), task.id);
    }
  });
}

function render(files: ReadonlyMap<string, string>, task: LessonTask): Uint8ClampedArray {
  const where = mkdtempSync(`${tmpdir()}/quintet-lab-task-`);
  try {
    mkdirSync(`${where}/program`);
    for (const [name, text] of files) writeFileSync(`${where}/program/${name}`, text);
    const sets = Object.entries(task.parameters ?? {}).flatMap(([name, value]) => ["--set", `${name}=${String(value)}`]);
    const size = `${kCheckSize.width}x${kCheckSize.height}`;
    execFileSync(quintet!, ["run", `${where}/program`, "--size", size, "--spp", String(task.samples ?? 1), ...sets, "-o", `${where}/image.png`], { stdio: "pipe" });
    return decodePng(readFileSync(`${where}/image.png`)).rgba;
  } finally {
    rmSync(where, { recursive: true, force: true });
  }
}

for (const [name, tasks] of quintet ? Object.entries(kLessonTasks) : [])
  for (const task of tasks)
    test(`the check of ${name}, ${task.id}, rejects the lesson`, () => {
      const { files, main } = lessonFiles(name);
      const solution = render(solutionFiles(files, main, task), task);
      const { differing } = compareImages(render(files, task), solution, kCheckSize.width);
      assert.ok(differing > 4 * kAllowedShare, `only ${differing} of the pixels differ`);
    });
