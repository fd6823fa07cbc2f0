// SPDX-License-Identifier: Apache-2.0
// The course: the text of a lesson, its tasks with checks, and the progress that this browser keeps.
import { api } from "./api";
import { ask, menuButton, type MenuItem, notify } from "./dialog";
import { h, replace, setOptions } from "./dom";
import { type CheckResult, checkTask, type ComparedRun, compareRuns } from "./lesson_check";
import { icon } from "./icons";
import { commandLine, effectText, type LessonCommand, parseCommand, type RunCommand, valueOf } from "./lesson_command";
import { applyEdit, editedFile, parseEdit } from "./lesson_edit";
import { labText, withoutFooter } from "./lesson_text";
import { kLessonTasks, type LessonTask, solutionFiles } from "./lesson_tasks";
import { type Files, LessonVersions, sameFiles } from "./lesson_versions";
import { inlineMarkdown, type MarkdownOptions, renderMarkdown } from "./markdown";
import type { Lesson, ProgramText } from "./protocol";
import { colored } from "./share";
import { stored } from "./stored";
import { baseName, type Workspace } from "./workspace";

export interface LessonHost {
  openLesson: (lesson: Lesson) => void;
  openFile: (name: string) => void; // of the lesson's program, by its last part
  explain: (id: string) => void;
  workspace: Workspace;
  projectFolder: () => string;
  // Does what a command of the page does in a terminal.
  run: (command: LessonCommand) => Promise<void>;
  // Opens the program of the lesson, if a command has opened a different one. Returns false if that failed.
  openOwnProgram: (lesson: Lesson) => Promise<boolean>;
  // Writes the files of the lesson's program again, as they are at its start.
  restoreFiles: (lesson: Lesson) => Promise<void>;
  close: () => void;
}

type Progress = Record<string, string[]>;

const filesOf = (program: ProgramText) => new Map(program.files.map((file) => [baseName(file.path), file.text]));

const timeText = (time: number) => new Date(time).toLocaleString(undefined, { month: "short", day: "numeric", hour: "2-digit", minute: "2-digit" });

// Colored lines that wrap.
function codeLines(text: string, language: string): Node[] {
  const lines: Node[][] = [[]];
  const add = (part: string, name: string) => {
    part.split("\n").forEach((piece, i) => {
      if (i > 0) lines.push([]);
      if (piece) lines[lines.length - 1]!.push(name ? h("span", { class: `code-${name}` }, piece) : document.createTextNode(piece));
    });
  };
  if (language === "glsl") for (const [part, name] of colored(text, "glsl")) add(part, name);
  else add(text, "");
  return lines.map((line) => h("span", { class: "line" }, line.length > 0 ? line : " "));
}

// Lines that wrap, with the part of a diff that they are.
function diffLines(text: string): Node[] {
  const kinds: Record<string, string> = { "-": "removed", "+": "added" };
  const lines = text.split("\n");
  // The indentation that all lines have would take half of a narrow column.
  const indents = lines.filter((line) => line.trim().length > 1).map((line) => /^.?(\s*)/.exec(line)![1]!.length);
  const indent = Math.min(...indents);
  return lines.map((line) => h("span", { class: `line ${kinds[line[0] ?? ""] ?? ""}` }, `${line.slice(0, 1) || " "} ${line.slice(1 + indent)}`));
}

// Address of a page or figure relative to a page, below docs/; undefined if it leaves the folder.
export function resolveDocs(page: string, target: string): string | undefined {
  const parts = page.split("/").slice(0, -1);
  for (const part of target.replace(/#.*$/, "").split("/")) {
    if (part === "..") {
      if (parts.length === 0) return undefined;
      parts.pop();
    } else if (part !== "." && part !== "") parts.push(part);
  }
  return parts.join("/");
}

export function docsOptions(page: string, open: (page: string) => void, explain: (id: string) => void): MarkdownOptions {
  return {
    image: (target) => {
      const path = resolveDocs(page, target);
      return path && api.docsAddress(path);
    },
    link: (target, content) => {
      const path = /^[a-z]+:/.test(target) ? undefined : resolveDocs(page, target);
      if (!path) return undefined;
      const id = /diagnostics\/(Q\d{3})\.md$/.exec(path)?.[1];
      return h("button", { type: "button", class: "link", onclick: () => (id ? explain(id) : open(path)) }, content);
    },
    code: (text, language) =>
      language === "glsl" || language === "toml" || language === "c" ? h("code", {}, codeLines(text, language)) : h("code", {}, text),
  };
}

export class LessonPanel {
  readonly element = h("section", { class: "lessons", "aria-label": "Lesson" });
  private readonly body = h("div", { class: "lesson-body prose" });
  private readonly select = h("select", { "aria-label": "Lesson" });
  private readonly summary = h("span", { class: "progress-text" });
  private readonly progress = stored<Progress>("progress", {});
  private lessons: readonly Lesson[] = [];
  private current: Lesson | undefined;
  private chosen: Lesson | undefined; // that is being opened
  private leaving = new AbortController(); // aborts checks and comparisons when another lesson is shown
  private original: ProgramText | undefined; // the program of the lesson
  private versions = new LessonVersions("");
  private readonly versionLabel = h("span", { class: "version-label", role: "status" });
  private readonly versionRow = h(
    "div",
    { class: "version-row" },
    this.versionLabel,
    h("button", { type: "button", class: "small", hidden: true, title: "Open the lesson's program again", onclick: () => void this.backToProgram() }, "Back to the lesson"),
    menuButton(["Versions"], "Versions of the program", () => this.versionItems()),
  );
  private runs = new Map<string, RunCommand>(); // of the page, by the file that they write

  constructor(private readonly host: LessonHost) {
    this.select.addEventListener("change", () => {
      const lesson = this.lessons.find((candidate) => candidate.name === this.select.value);
      if (lesson) host.openLesson(lesson);
    });
    replace(
      this.element,
      h("div", { class: "bar" }, this.select, this.summary, h("button", { type: "button", class: "icon", "aria-label": "Close the lesson", title: "Close the lesson", onclick: () => host.close() }, icon("close"))),
      this.versionRow,
      this.body,
    );
  }

  get lesson(): Lesson | undefined {
    return this.current;
  }

  setLessons(lessons: readonly Lesson[]): void {
    this.lessons = lessons;
    this.showList();
  }

  find(name: string): Lesson | undefined {
    return this.lessons.find((lesson) => lesson.name === name);
  }

  // The lesson of a program: of the user's copy, or of the built-in program.
  findProgram(program: string): Lesson | undefined {
    const ofProgram = this.lessons.filter((lesson) => lesson.copy === program || lesson.program === program);
    // A lesson without a program of its own shares one.
    return ofProgram.find((lesson) => lesson.program.endsWith(`/${lesson.name}>`)) ?? ofProgram[0];
  }

  // The list shows the lesson that is being opened; undefined: the open one.
  choose(lesson: Lesson | undefined): void {
    this.chosen = lesson;
    this.showList();
  }

  async show(lesson: Lesson | undefined): Promise<void> {
    this.current = lesson;
    this.chosen = undefined;
    this.leaving.abort();
    this.leaving = new AbortController();
    this.showList();
    if (!lesson) return;
    replace(this.body, h("p", { class: "empty" }, "Loading…"));
    let text: string;
    this.original = undefined;
    this.versions = new LessonVersions(lesson.name);
    this.runs = new Map();
    try {
      text = await api.docs(lesson.page);
      const original = await api.program(lesson.program);
      if (this.current === lesson) this.original = original;
    } catch (error) {
      if (this.current === lesson) replace(this.body, h("p", { class: "empty" }, (error as Error).message));
      return;
    }
    if (this.current !== lesson) return;
    const tasks = kLessonTasks[lesson.name] ?? [];
    replace(this.body, renderMarkdown(labText(withoutFooter(text)), this.options(lesson)), this.taskSection(lesson, tasks), this.footer(lesson));
    this.body.scrollTop = 0;
    this.showVersion();
  }

  // Versions

  // The program in the editors, if it is that of the lesson.
  private get ownFiles(): Files | undefined {
    const { workspace } = this.host;
    const name = workspace.program?.name;
    if (!this.current || (name !== this.current.copy && name !== this.current.program)) return undefined;
    return Object.fromEntries(workspace.files.map((file) => [baseName(file.path), workspace.textOf(file)]));
  }

  private solutions(): { label: string; files: Files }[] {
    const { original, current } = this;
    if (!original || !current) return [];
    const files = filesOf(original);
    const main = baseName(original.main);
    return (kLessonTasks[current.name] ?? []).map((task, i) => ({ label: `Solution of task ${i + 1}`, files: Object.fromEntries(solutionFiles(files, main, task)) }));
  }

  // Call it when the text of the program changes: the label names the version in the editors.
  showVersion(): void {
    const own = this.ownFiles;
    this.versionRow.hidden = !this.original;
    (this.versionRow.querySelector(":scope > button") as HTMLElement).hidden = own !== undefined;
    if (!this.original) return;
    if (!own) {
      this.versionLabel.textContent = this.versionLabel.title = this.host.workspace.program?.title ?? "";
      return;
    }
    const solution = this.solutions().find(({ files }) => sameFiles(files, own));
    const kept = this.versions.find(own);
    const label = sameFiles(Object.fromEntries(filesOf(this.original)), own) ? "Original" : (solution?.label ?? (kept ? `Your version, ${timeText(kept.time)}` : "Your version"));
    if (this.versionLabel.textContent !== label) this.versionLabel.textContent = this.versionLabel.title = label;
  }

  private versionItems(): MenuItem[] {
    const { original, current } = this;
    if (!original || !current) return [];
    const item = (label: string, hint: string, files: Files): MenuItem => ({ label, hint, run: () => void this.showFiles(files, "before a version was shown") });
    const own = this.ownFiles;
    return [
      { label: "Keep this version", disabled: !own || this.isKept(own), run: () => own && this.keep("kept") },
      item("Original", "the lesson's program", Object.fromEntries(filesOf(original))),
      ...this.versions.list.map((version) => item(timeText(version.time), version.label, version.files)),
    ];
  }

  private isKept(files: Files): boolean {
    const original = this.original && Object.fromEntries(filesOf(this.original));
    return (original !== undefined && sameFiles(original, files)) || this.solutions().some((solution) => sameFiles(solution.files, files)) || this.versions.find(files) !== undefined;
  }

  // Keeps the program in the editors, unless it is the lesson's, a solution or kept already.
  private keep(label: string): void {
    const own = this.ownFiles;
    if (!own || this.isKept(own)) return;
    this.versions.keep(label, own);
    this.showVersion();
  }

  private async backToProgram(): Promise<void> {
    if (this.current) await this.host.openOwnProgram(this.current);
  }

  // Shows other texts in the editors, as one step of undo each. The version before is kept. Returns false if that failed.
  private async showFiles(files: Files, why: string): Promise<boolean> {
    const { workspace } = this.host;
    const lesson = this.current;
    if (!lesson || !(await this.host.openOwnProgram(lesson)) || this.current !== lesson) return false;
    this.keep(why);
    const names = workspace.files.map((file) => baseName(file.path));
    if (Object.keys(files).some((name) => !names.includes(name))) {
      await this.host.restoreFiles(lesson); // one was deleted
      if (this.current !== lesson) return false;
    }
    for (const file of workspace.files) {
      const text = files[baseName(file.path)];
      if (text !== undefined && text !== workspace.textOf(file)) workspace.setText(file, text);
    }
    this.showVersion();
    return true;
  }

  // Commands and edits of the page

  private block(text: string, language: string, comments: readonly string[]): Node | undefined {
    if (language === "diff") return this.edit(text, comments);
    const lines = text.split("\n").filter((line) => line.trim() !== "");
    if (language !== "" || lines.length === 0 || !lines.every((line) => commandLine(line))) return undefined;
    const expected = comments.map((comment) => /^expect: (status .*)$/.exec(comment)?.[1]).find(Boolean) ?? "";
    return h("div", { class: "commands" }, lines.map((line) => this.command(commandLine(line)!, expected)));
  }

  private command(line: string, expected: string): Node {
    const command = parseCommand(line, expected);
    if (command.kind === "run" && command.file) this.runs.set(command.file, command);
    const forTerminal = this.terminalText(line);
    const copy = h("button", { type: "button", class: "icon copy", title: `Copy for a terminal: ${forTerminal}`, "aria-label": "Copy the command" }, icon("copy"));
    copy.addEventListener("click", () => {
      navigator.clipboard.writeText(forTerminal).then(
        () => notify("The command was copied"),
        () => notify("The browser does not allow copying", "error"),
      );
    });
    if (command.kind === "terminal") return h("div", { class: "command terminal" }, h("code", {}, forTerminal), h("span", { class: "where" }, "In a terminal"), copy);
    const result = h("div", { class: "task-result command-result", role: "status" });
    const run = h("button", { type: "button", class: "small run", title: line }, icon("play"), this.actionText(command));
    run.addEventListener("click", async () => {
      for (const shown of this.body.querySelectorAll(".command.shown")) shown.classList.remove("shown");
      run.disabled = true;
      if (command.kind === "compare") await this.compare(command.files, result);
      else await this.host.run(command);
      run.disabled = false;
      run.closest(".command")!.classList.add("shown");
    });
    return h("div", {}, h("div", { class: "command" }, run, h("span", { class: "effect" }, this.effect(command)), copy), result);
  }

  // The user's copy has its folder instead of the name "mine".
  private terminalText(line: string): string {
    const path = `${this.host.projectFolder()}/${this.current?.copy ?? ""}`;
    const word = /^[\w./~-]+$/.test(path) ? path : `'${path.replaceAll("'", "'\\''")}'`;
    return line.replace(/ mine(?:\.rt\.glsl)?(?= |$)/, ` ${word}`);
  }

  private actionText(command: LessonCommand): string {
    switch (command.kind) {
      case "problems":
        return "Problems";
      case "instrument":
        return "Run-time checks";
      case "pipeline":
        return "Pipeline";
      case "original":
        return "Start from the original";
      case "parameters":
        return "Parameters";
      case "compare":
        return "Compare";
      default:
        return "Run";
    }
  }

  private effect(command: LessonCommand): string {
    if (command.kind === "compare") return "the two images above";
    if (!("program" in command)) return "";
    const own = command.program === "mine" ? "your program" : `<programs/${command.program}>` === this.current?.program ? "" : command.program;
    const effect = command.kind === "run" ? effectText(command) : "";
    return [own, effect].filter(Boolean).join(" · ") || (command.kind === "run" ? "with the defaults" : "");
  }

  private async compare(files: readonly string[], result: HTMLElement): Promise<void> {
    const { signal } = this.leaving;
    replace(result, h("p", {}, "Rendering both images…"));
    try {
      const runs = await Promise.all(files.map((file) => this.comparedRun(file)));
      const outcome = await compareRuns(runs[0]!, runs[1]!, signal);
      if (!signal.aborted) this.showResult(result, outcome, ["First", "Second"], true);
    } catch (error) {
      replace(result, h("p", { class: "failed" }, (error as Error).message));
    }
  }

  private async comparedRun(file: string): Promise<ComparedRun> {
    const run = this.runs.get(file);
    if (!run) throw new Error(`No command above makes ${file}`);
    const own = run.program === "mine" ? this.ownFiles : undefined;
    if (run.program === "mine" && !own) throw new Error("Another program is open. Go back to the lesson first.");
    const sources = own ? new Map(Object.entries(own)) : filesOf(await api.program(`<programs/${run.program}>`));
    return { files: sources, samples: run.frames, parameters: Object.fromEntries(Object.entries(run.parameters).map(([name, text]) => [name, valueOf(text)])) };
  }

  // A change of the program, which a button can make.
  private edit(diff: string, comments: readonly string[]): Node {
    const lines = h("pre", { class: "diff", tabindex: 0 }, h("code", {}, diffLines(diff)));
    const edit = comments.map(parseEdit).find(Boolean);
    if (!edit) return lines;
    const where = edit.file === "mine.rt.glsl" ? "" : edit.file === "mine.scene.toml" ? "in the scene" : `in ${baseName(edit.file)}`;
    const apply = h("button", { type: "button", class: "small", title: edit.from ? "Change the lesson's program in this way. Your version is kept" : "Make this change, too" }, edit.from ? "Apply to the lesson's program" : "Apply this, too");
    apply.addEventListener("click", async () => {
      const original = this.original;
      if (!original) return;
      const files = new Map(edit.from ? filesOf(original) : Object.entries(this.ownFiles ?? Object.fromEntries(filesOf(original))));
      const name = editedFile(edit, [...files.keys()], baseName(original.main));
      const text = name && applyEdit(files.get(name)!, diff);
      if (!name || text === undefined) {
        notify("The lines to replace are not in your program. Start with the change before, or with the lesson's program.", "error");
        return;
      }
      files.set(name, text);
      if (await this.showFiles(Object.fromEntries(files), "before a change of the page")) notify("The change is in the editors. Versions has the program before it.");
    });
    return h("div", { class: "edit" }, lines, h("div", { class: "edit-actions" }, apply, where && h("span", { class: "effect" }, where)));
  }

  private options(lesson: Lesson): MarkdownOptions {
    const options = docsOptions(
      lesson.page,
      (path) => {
        const other = this.lessons.find((candidate) => candidate.page === path);
        if (other) this.host.openLesson(other);
      },
      (id) => this.host.explain(id),
    );
    return {
      ...options,
      firstHeading: 2,
      block: (text, language, comments) => this.block(text, language, comments),
      link: (target, content) => {
        const name = /(?:^|\/)programs\/lessons\/[^/]+\/([^/]+)$/.exec(target)?.[1];
        if (name) return h("button", { type: "button", class: "link", onclick: () => this.host.openFile(name) }, content);
        const path = resolveDocs(lesson.page, target);
        // Other pages of the documentation are not part of the course.
        if (path && !this.lessons.some((candidate) => candidate.page === path) && !path.startsWith("diagnostics/")) return h("em", {}, content);
        return options.link!(target, content);
      },
    };
  }

  private doneTasks(lesson: Lesson): Set<string> {
    return new Set(this.progress.value[lesson.name] ?? []);
  }

  private markDone(lesson: Lesson, task: LessonTask): void {
    const done = this.doneTasks(lesson);
    done.add(task.id);
    this.progress.value = { ...this.progress.value, [lesson.name]: [...done] };
    this.showList();
  }

  private showList(): void {
    const state = (lesson: Lesson) => {
      const tasks = kLessonTasks[lesson.name] ?? [];
      const done = this.doneTasks(lesson);
      return { count: tasks.length, done: tasks.filter((task) => done.has(task.id)).length };
    };
    let all = 0;
    let finished = 0;
    setOptions(
      this.select,
      this.lessons.map((lesson) => {
        const { count, done } = state(lesson);
        all += count;
        finished += done;
        const mark = count > 0 && done === count ? " ✓" : done > 0 ? ` ${done}/${count}` : "";
        return [lesson.name, `${lesson.number} ${lesson.title}${mark}`];
      }),
    );
    const shown = this.chosen ?? this.current;
    if (shown) this.select.value = shown.name;
    this.summary.textContent = `${finished} of ${all} tasks`;
    this.summary.title = "Tasks that are done in this browser";
  }

  private taskSection(lesson: Lesson, tasks: readonly LessonTask[]): Node | undefined {
    if (tasks.length === 0) return undefined;
    return h("section", { class: "tasks", "aria-label": "Tasks", dataset: { lesson: lesson.name } }, h("h3", {}, tasks.length === 1 ? "Task" : "Tasks"), tasks.length > 1 && h("p", {}, "Each task starts from the lesson's program. The tasks that you have done may stay in it."), tasks.map((task, i) => this.task(lesson, task, i + 1)));
  }

  private task(lesson: Lesson, task: LessonTask, number: number): Node {
    const result = h("div", { class: "task-result", role: "status" });
    const hint = h("p", { class: "task-hint", hidden: true }, inlineMarkdown(task.hint));
    const element = h("div", { class: "task", dataset: { task: task.id } });
    const setDone = () => element.classList.toggle("done", this.doneTasks(lesson).has(task.id));
    const check = h("button", { type: "button", class: "primary task-check" }, "Check");
    check.addEventListener("click", async () => {
      const { signal } = this.leaving;
      this.enableChecks(false);
      replace(result, h("p", {}, "Rendering your program and the solution…"));
      const outcome = await this.check(lesson, task, signal);
      if (signal.aborted) return; // another lesson is shown
      this.enableChecks(true);
      if (outcome.passed) this.markDone(lesson, task);
      setDone();
      this.showResult(result, outcome);
    });
    const hintButton = h("button", { type: "button", class: "small", "aria-expanded": "false" }, "Hint");
    hintButton.addEventListener("click", () => {
      hint.hidden = !hint.hidden;
      hintButton.setAttribute("aria-expanded", String(!hint.hidden));
    });
    const solution = h("button", { type: "button", class: "small", onclick: () => void this.showSolution(lesson, task, number) }, "Solution");
    const reset = h("button", { type: "button", class: "small", title: "Start again with the lesson's program. Your version is kept", onclick: () => void this.reset(lesson) }, "Reset");
    replace(
      element,
      h("p", { class: "task-text" }, h("b", {}, `${number}. `), inlineMarkdown(task.text), h("span", { class: "task-mark", role: "img", "aria-label": "done" }, "✓")),
      h("div", { class: "task-actions" }, check, hintButton, solution, reset),
      hint,
      result,
    );
    setDone();
    return element;
  }

  // One check runs at a time.
  private enableChecks(on: boolean): void {
    for (const button of this.body.querySelectorAll<HTMLButtonElement>(".task-check")) button.disabled = !on;
  }

  private async check(lesson: Lesson, task: LessonTask, signal: AbortSignal): Promise<CheckResult> {
    const { workspace } = this.host;
    const program = workspace.program;
    if (!program || (program.name !== lesson.copy && program.name !== lesson.program)) return { passed: false, message: "Another program is open. Choose the lesson again." };
    try {
      const original = await api.program(lesson.program);
      const mine = new Map(workspace.files.map((file) => [baseName(file.path), workspace.textOf(file)]));
      return await checkTask(task, kLessonTasks[lesson.name] ?? [task], mine, filesOf(original), baseName(original.main), signal);
    } catch (error) {
      return { passed: false, message: (error as Error).message };
    }
  }

  private showResult(element: HTMLElement, result: CheckResult, labels: readonly [string, string] = ["Yours", "Solution"], always = false): void {
    const figure = (image: ImageBitmap | undefined, label: string) => {
      if (!image) return undefined;
      const canvas = h("canvas", { width: image.width, height: image.height, role: "img", "aria-label": label });
      canvas.getContext("2d")!.drawImage(image, 0, 0);
      return h("figure", {}, canvas, h("figcaption", {}, label));
    };
    const { difference, yours } = result;
    let map: Node | undefined;
    if (difference && yours && !result.passed) {
      const canvas = h("canvas", { width: yours.width, height: yours.height, role: "img", "aria-label": "Pixels that differ, in red" });
      canvas.getContext("2d")!.putImageData(new ImageData(difference.map, yours.width, yours.height), 0, 0);
      map = h("figure", {}, canvas, h("figcaption", {}, "Difference"));
    }
    replace(
      element,
      h("p", { class: result.passed ? "passed" : "failed" }, result.message),
      (always || !result.passed) && yours && h("div", { class: "task-images" }, figure(yours, labels[0]), figure(result.expected, labels[1]), map),
      !result.passed && !always && yours && h("p", { class: "note" }, "The solution is the lesson's program with this change. Other changes count as differences: Reset starts again, and keeps your version."),
    );
  }

  private async showSolution(lesson: Lesson, task: LessonTask, number: number): Promise<void> {
    const answer = await ask(
      "Show the solution?",
      [h("p", {}, "The solution replaces the program in the editors. Versions, above the text of the lesson, keeps yours; undo (Ctrl+Z) in each editor returns to it, too.")],
      [
        { label: "Cancel", value: false },
        { label: "Show the solution", value: true, primary: true },
      ],
    );
    if (!answer) return;
    try {
      const original = await api.program(lesson.program);
      if (this.current !== lesson) return; // another one was opened
      const solution = solutionFiles(filesOf(original), baseName(original.main), task);
      await this.showFiles(Object.fromEntries(solution), `before the solution of task ${number}`);
    } catch (error) {
      notify((error as Error).message, "error");
    }
  }

  private async reset(lesson: Lesson): Promise<void> {
    const answer = await ask(
      "Reset the lesson?",
      [h("p", {}, `The files of the lesson in ${lesson.copy} are replaced by the original ones. Versions, above the text of the lesson, keeps yours; undo (Ctrl+Z) in each editor returns to it, too.`)],
      [
        { label: "Cancel", value: false },
        { label: "Reset", value: true, primary: true },
      ],
    );
    if (answer) await this.startAgain(lesson);
  }

  // The lesson's program in the editors.
  async startAgain(lesson: Lesson): Promise<void> {
    try {
      const original = await api.program(lesson.program);
      if (this.current !== lesson || !(await this.showFiles(Object.fromEntries(filesOf(original)), "before a reset"))) return;
      await this.host.workspace.save({ missing: true });
    } catch (error) {
      notify((error as Error).message, "error");
    }
  }

  private footer(lesson: Lesson): Node {
    const index = this.lessons.indexOf(lesson);
    const button = (other: Lesson | undefined, label: string) =>
      other && h("button", { type: "button", onclick: () => this.host.openLesson(other) }, `${label}: ${other.title}`);
    return h("div", { class: "lesson-footer" }, button(this.lessons[index - 1], "Previous"), button(this.lessons[index + 1], "Next"));
  }
}
