// SPDX-License-Identifier: Apache-2.0
// The dialog that opens a program: of the project, a lesson, a built-in one, a new one, or a file.
import { h, replace } from "./dom";
import { icon } from "./icons";
import type { Lesson, ProgramEntry, ProgramList } from "./protocol";

export type ProgramChoice =
  | { kind: "program"; name: string }
  | { kind: "lesson"; lesson: Lesson }
  | { kind: "new"; folder: string }
  | { kind: "import"; file: File };

// A folder of the project: letters, digits, "_", "-", "." and "/".
export function validFolder(name: string): boolean {
  return /^[A-Za-z0-9_][\w.-]*(\/[A-Za-z0-9_][\w.-]*)*$/.test(name);
}

export function chooseProgram(programs: ProgramList, lessons: readonly Lesson[], folder: string): Promise<ProgramChoice | undefined> {
  return new Promise((resolve) => {
    let choice: ProgramChoice | undefined;
    const finish = (value: ProgramChoice) => {
      choice = value;
      element.close();
    };
    const filter = h("input", { type: "search", placeholder: "Filter", "aria-label": "Filter the programs", autofocus: true });
    const listing = h("div", { class: "chooser-list" });
    const row = (title: string, description: string, open: () => void) =>
      h("button", { type: "button", class: "chooser-row", onclick: open }, h("b", {}, title), description && h("span", {}, description));
    const matches = (...texts: string[]) => texts.some((text) => text.toLowerCase().includes(filter.value.trim().toLowerCase()));
    const group = (title: string, rows: Node[]) => (rows.length > 0 ? [h("h3", {}, title), rows] : []);
    const programRow = (entry: ProgramEntry) => row(entry.title, entry.description, () => finish({ kind: "program", name: entry.name }));
    const show = () => {
      const isLesson = new Set(lessons.map((lesson) => lesson.program));
      const filtered = (entries: readonly ProgramEntry[]) => entries.filter((entry) => !isLesson.has(entry.name) && matches(entry.title, entry.description)).map(programRow);
      const course = lessons
        .filter((lesson) => matches(lesson.title, lesson.name))
        .map((lesson) => row(`${lesson.number} ${lesson.title}`, lesson.copied ? "started" : "", () => finish({ kind: "lesson", lesson })));
      const groups = [group(`In ${folder}`, filtered(programs.project)), group("Lessons", course), group("Built-in programs", filtered(programs.builtIn))];
      replace(listing, groups.every((part) => part.length === 0) ? h("p", { class: "empty" }, "No program has this text in its name or description.") : groups);
    };
    filter.addEventListener("input", show);
    filter.addEventListener("keydown", (event) => {
      if (event.key === "Enter") listing.querySelector<HTMLButtonElement>("button")?.click();
      else if (event.key === "ArrowDown") listing.querySelector<HTMLButtonElement>("button")?.focus();
      else return;
      event.preventDefault();
    });
    listing.addEventListener("keydown", (event) => {
      if (event.key !== "ArrowDown" && event.key !== "ArrowUp") return;
      const rows = [...listing.querySelectorAll<HTMLElement>("button")];
      const index = rows.indexOf(document.activeElement as HTMLElement) + (event.key === "ArrowDown" ? 1 : -1);
      (index < 0 ? filter : rows[Math.min(index, rows.length - 1)])?.focus();
      event.preventDefault();
    });
    const name = h("input", { type: "text", "aria-label": "Folder of the new program", placeholder: "folder", required: true, size: 14 });
    const create = h("form", {}, h("label", {}, "New program ", name), h("button", { type: "submit" }, "Create"));
    create.addEventListener("submit", (event) => {
      event.preventDefault();
      name.setCustomValidity(validFolder(name.value) ? "" : "Use letters, digits, '_', '-' and '/'");
      if (name.reportValidity()) finish({ kind: "new", folder: name.value });
    });
    name.addEventListener("input", () => name.setCustomValidity(""));
    const file = h("input", { type: "file", accept: ".zip,.glsl,.txt", hidden: true, "aria-label": "File to import" });
    file.addEventListener("change", () => {
      if (file.files?.[0]) finish({ kind: "import", file: file.files[0] });
    });
    const element = h(
      "dialog",
      { class: "dialog chooser", "aria-label": "Open a program" },
      h("div", { class: "chooser-head" }, h("h2", {}, "Open a program"), h("button", { type: "button", class: "icon", "aria-label": "Close", onclick: () => element.close() }, icon("close"))),
      filter,
      listing,
      h("div", { class: "chooser-foot" }, create, h("button", { type: "button", title: "A lecture file, a program of the GSN Composer, or a zip file that the lab exported", onclick: () => file.click() }, "Import…"), file),
    );
    element.addEventListener("close", () => {
      element.remove();
      resolve(choice);
    });
    show();
    document.body.append(element);
    element.showModal();
  });
}
