// SPDX-License-Identifier: Apache-2.0
// The tasks of the lessons against the texts of the lessons. tests/lab_page/lessons.test.mjs runs them.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { acceptedTasks, kLessonTasks, solutionFiles } from "../src/lesson_tasks";

declare const REPOSITORY: string;

const folder = `${REPOSITORY}/programs/lessons`;
const kPrograms: Record<string, string> = { "00_pipeline": "01_first_ray" }; // of lessons without a program of their own

function lessonFiles(lesson: string): { files: Map<string, string>; main: string } {
  const name = kPrograms[lesson] ?? lesson;
  const names = readdirSync(`${folder}/${name}`);
  const main = names.find((file) => file.endsWith(".rt.glsl")) ?? "program.toml";
  return { files: new Map(names.map((file) => [file, readFileSync(`${folder}/${name}/${file}`, "utf8")])), main };
}

test("every lesson of the course has a task", () => {
  const overview = readFileSync(`${REPOSITORY}/docs/lessons/README.md`, "utf8");
  const lessons = [...overview.matchAll(/\| \[\d\d · [^\]]*\]\((\w+)\.md\)/g)].map((cell) => cell[1]!);
  assert.equal(lessons.length, 28);
  assert.deepEqual(Object.keys(kLessonTasks).sort(), lessons.sort());
});

for (const [name, tasks] of Object.entries(kLessonTasks)) {
  test(`the solutions of ${name} fit its program`, () => {
    assert.ok(tasks.length > 0);
    assert.equal(new Set(tasks.map((task) => task.id)).size, tasks.length);
    const { files, main } = lessonFiles(name);
    for (const task of tasks) {
      const solution = solutionFiles(files, main, task);
      assert.ok([...solution].some(([file, text]) => text !== files.get(file)), task.id);
    }
  });
}

test("the tasks of a lesson can be done in any order, and stay done", () => {
  let several = 0;
  for (const [name, tasks] of Object.entries(kLessonTasks)) {
    const { files, main } = lessonFiles(name);
    for (const task of tasks) {
      const accepted = acceptedTasks(tasks, task);
      assert.equal(accepted.length, 2 ** (tasks.length - 1));
      assert.deepEqual(accepted[0], [task], "the task alone comes first");
      // Whatever was done before, the program has the changes of all tasks.
      const texts = accepted.map((done) => JSON.stringify([...solutionFiles(files, main, ...done)]));
      assert.equal(new Set(texts).size, accepted.length, `${name}: ${task.id}`);
      several += accepted.length > 1 ? 1 : 0;
    }
    const forward = solutionFiles(files, main, ...tasks);
    const backward = solutionFiles(files, main, ...[...tasks].reverse());
    assert.deepEqual([...forward], [...backward], name);
  }
  assert.ok(several >= 14);
});
