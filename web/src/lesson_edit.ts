// SPDX-License-Identifier: Apache-2.0
// Edits of the lesson pages: a block ```diff after a comment that names the file. The rules are those of
// tests/lessons/pages.

export interface LessonEdit {
  file: string; // of the copy: "mine.rt.glsl", "mine.scene.toml", "mine/program.toml"
  from: string; // the program that is copied first; empty: the copy of the edit before
}

// Of the comment "edit: mine.rt.glsl from lessons/05_shadow".
export function parseEdit(comment: string): LessonEdit | undefined {
  const [, file, from] = /^edit: (\S+)(?: from (\S+))?$/.exec(comment.trim()) ?? [];
  return file ? { file, from: from ?? "" } : undefined;
}

// The name in the folder of a lesson's program: that of its main file for "mine.rt.glsl", that of its scene for
// "mine.scene.toml", and the rest of the path for files of a folder.
export function editedFile(edit: LessonEdit, names: readonly string[], main: string): string | undefined {
  if (edit.file === "mine.rt.glsl") return main;
  if (edit.file === "mine.scene.toml") return names.find((name) => name.endsWith(".scene.toml"));
  const name = edit.file.replace(/^mine\//, "");
  return names.includes(name) ? name : undefined;
}

// The text after the edit. undefined: lines with '-' or ' ' are not exactly once in it, in one piece.
export function applyEdit(text: string, diff: string): string | undefined {
  let result = `\n${text.endsWith("\n") ? text : `${text}\n`}`;
  let before = "";
  let after = "";
  let added = false;
  const piece = () => {
    if (before === "" && after === "") return true;
    const at = result.indexOf(`\n${before}`);
    if (before === "" || at < 0 || result.indexOf(`\n${before}`, at + 1) >= 0) return false;
    result = result.slice(0, at + 1) + after + result.slice(at + 1 + before.length);
    before = after = "";
    added = false;
    return true;
  };
  for (const line of diff.split("\n")) {
    const rest = `${line.slice(1)}\n`;
    if (line.startsWith("-")) {
      if (added && !piece()) return undefined;
      before += rest;
    } else if (line.startsWith("+")) {
      after += rest;
      added = true;
    } else if (line.startsWith(" ")) {
      before += rest;
      after += rest;
    } else if (!piece()) return undefined;
  }
  return piece() ? result.slice(1) : undefined;
}
