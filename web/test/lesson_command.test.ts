// SPDX-License-Identifier: Apache-2.0
// Commands and edits of the lesson pages: the page of the lab can do each of them, or says that it belongs into a terminal.
import assert from "node:assert/strict";
import { existsSync, readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { commandLine, effectText, parameterValues, parseCommand, type RunCommand, valueOf } from "../src/lesson_command";
import { applyEdit, editedFile, parseEdit } from "../src/lesson_edit";

declare const REPOSITORY: string;

const kPages = readdirSync(`${REPOSITORY}/docs/lessons`).filter((name) => /^\d\d_.*\.md$/.test(name));
const pageText = (name: string) => readFileSync(`${REPOSITORY}/docs/lessons/${name}`, "utf8");
const folderOf = (program: string) => `${REPOSITORY}/programs/${program}`;

function programFiles(program: string): Map<string, string> {
  return new Map(readdirSync(folderOf(program)).map((name) => [name, readFileSync(`${folderOf(program)}/${name}`, "utf8")]));
}

test("options of a command become an action", () => {
  const run = parseCommand("quintet run lessons/05_shadow --set lampRadius=12 --set eye=-3,1,2 --frames 14 --size 90x30 --output free --spp 1 -o wide.png") as RunCommand;
  assert.deepEqual(run, { kind: "run", program: "lessons/05_shadow", parameters: { lampRadius: "12", eye: "-3,1,2" }, frames: 14, plays: false, size: [90, 30], output: "free", file: "wide.png" });
  assert.equal(effectText(run), "lampRadius = 12 · eye = -3, 1, 2 · output free · 14 frames · 90 × 30 pixels");
  assert.equal((parseCommand("quintet run mine -o mine.%04d.png --frames 40 --watch") as RunCommand).plays, true);
  assert.equal((parseCommand("quintet run mine.rt.glsl -o a.png") as RunCommand).program, "mine");
  assert.deepEqual(parseCommand("quintet check mine.rt.glsl", "status 1 Q502"), { kind: "problems", program: "mine", status: "status 1 Q502" });
  assert.deepEqual(parseCommand("quintet check lessons/17_records --graph pipeline.svg"), { kind: "pipeline", program: "lessons/17_records" });
  assert.deepEqual(parseCommand("quintet check mine.rt.glsl --instrument"), { kind: "instrument", program: "mine" });
  assert.deepEqual(parseCommand("quintet new mine --from lessons/01_first_ray"), { kind: "original", program: "lessons/01_first_ray" });
  assert.deepEqual(parseCommand("quintet compare a.png b.png --max 0.5"), { kind: "compare", files: ["a.png", "b.png"] });
  assert.deepEqual(parseCommand("quintet run lessons/05_shadow --help"), { kind: "parameters", program: "lessons/05_shadow" });
});

test("commands without an equivalent belong into a terminal", () => {
  for (const command of ["quintet bench mine --size 128x128", "quintet run mine --print 1,2 -o a.png", "quintet run", "quintet run a b", "quintet run mine --set x", "quintet info"])
    assert.deepEqual(parseCommand(command), { kind: "terminal" }, command);
  assert.equal(commandLine("h = tan(fov / 2)"), undefined);
  assert.equal(commandLine("quintet run mine --watch                         # render again"), "quintet run mine --watch");
});

test("values have the types of the protocol, and other parameters their defaults", () => {
  assert.deepEqual(["12", "-0.5,1,2", "true", "wood.png", ""].map(valueOf), [12, [-0.5, 1, 2], true, "wood.png", ""]);
  const parameter = (name: string, type: "bool" | "float", initial: number | boolean) => ({ name, type, default: initial, min: null, max: null, unit: "", help: "" });
  assert.deepEqual(parameterValues([parameter("a", "float", 2), parameter("b", "bool", false), parameter("c", "float", 3)], { a: "4", b: "1" }), { a: 4, b: true, c: 3 });
});

test("every command of the lessons names a program and parameters that exist", () => {
  const counts: Record<string, number> = {};
  for (const page of kPages) {
    let files: string[] = [];
    for (const line of pageText(page).split("\n")) {
      const text = line.startsWith("    ") ? commandLine(line) : undefined;
      if (!text) continue;
      const command = parseCommand(text);
      counts[command.kind] = (counts[command.kind] ?? 0) + 1;
      if ("program" in command && command.program !== "mine") assert.ok(existsSync(folderOf(command.program)), `${page}: ${text}`);
      if (command.kind === "run") {
        files.push(command.file);
        const program = command.program === "mine" ? (page.startsWith("00") ? "lessons/01_first_ray" : `lessons/${page.slice(0, -3)}`) : command.program;
        const sources = [...programFiles(program).values()].join("\n");
        // An exercise can add a uniform.
        const added = command.program === "mine" ? pageText(page) : "";
        for (const name of Object.keys(command.parameters)) assert.match(sources + added, new RegExp(`uniform \\w+ ${name}\\b|name = "${name}"|^\\[parameters\\.${name}\\]|^${name} =`, "m"), `${page}: ${text}`);
      }
      if (command.kind === "compare") for (const file of command.files) assert.ok(files.includes(file), `${page}: ${text}`);
    }
  }
  const total = Object.values(counts).reduce((sum, count) => sum + count, 0);
  assert.ok(total >= 190, `${total} commands`);
  assert.ok(counts["terminal"]! <= 6, JSON.stringify(counts));
});

test("every edit of the lessons can be applied, in the order of the page", () => {
  let count = 0;
  for (const page of kPages) {
    let files = new Map<string, string>();
    for (const [, comment, diff] of pageText(page).matchAll(/<!-- (edit: [^>]*?) -->\n+```diff\n([\s\S]*?)\n```/g)) {
      const edit = parseEdit(comment!)!;
      if (edit.from) files = programFiles(edit.from);
      const names = [...files.keys()];
      const name = editedFile(edit, names, names.find((file) => file.endsWith(".rt.glsl")) ?? "program.toml");
      assert.ok(name, `${page}: ${comment}`);
      const edited = applyEdit(files.get(name)!, diff!);
      assert.ok(edited !== undefined && edited !== files.get(name), `${page}: ${comment}\n${diff}`);
      files.set(name, edited);
      ++count;
    }
  }
  assert.ok(count >= 60, `${count} edits`);
});

test("an edit whose lines are missing or not unique is not applied", () => {
  const text = "one\ntwo\ntwo\n";
  assert.equal(applyEdit(text, "-one\n+1"), "1\ntwo\ntwo\n");
  assert.equal(applyEdit(text, " one\n-two\n+2"), "one\n2\ntwo\n");
  assert.equal(applyEdit(text, "-one\n+1\n-two\n-two\n+2"), "1\n2\n");
  assert.equal(applyEdit(text, "-three\n+3"), undefined);
  assert.equal(applyEdit(text, "-two\n+2"), undefined);
  assert.equal(applyEdit("one", "-one\n+1"), "1\n", "the last line has no line break");
});
