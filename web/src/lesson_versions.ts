// SPDX-License-Identifier: Apache-2.0
// Versions of a lesson's program that this browser keeps, so that a solution, a reset or an exercise never destroys work.
import { stored, type Stored } from "./stored";

export type Files = Readonly<Record<string, string>>; // text by name in the folder

export interface Version {
  label: string; // why it was kept: "before the solution of task 1"
  time: number; // ms since 1970
  files: Files;
}

const kMaxVersions = 20; // of a lesson; the oldest ones are dropped

export function sameFiles(a: Files, b: Files): boolean {
  const names = Object.keys(a);
  return names.length === Object.keys(b).length && names.every((name) => a[name] === b[name]);
}

export class LessonVersions {
  private readonly kept: Stored<Version[]>;

  constructor(lesson: string, store: Stored<Version[]> = stored<Version[]>(`versions.${lesson}`, [])) {
    this.kept = store;
  }

  // The newest one first.
  get list(): readonly Version[] {
    return this.kept.value;
  }

  find(files: Files): Version | undefined {
    return this.kept.value.find((version) => sameFiles(version.files, files));
  }

  // Keeps a version unless an equal one is kept already.
  keep(label: string, files: Files, now = Date.now()): void {
    if (this.find(files)) return;
    this.kept.value = [{ label, time: now, files: { ...files } }, ...this.kept.value].slice(0, kMaxVersions);
  }
}
