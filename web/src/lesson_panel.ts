// SPDX-License-Identifier: Apache-2.0
// The course: the text of a lesson, its tasks with checks, and the progress that this browser keeps.
import { api } from "./api";
import { ask, notify } from "./dialog";
import { h, replace, setOptions } from "./dom";
import { type CheckResult, checkTask } from "./lesson_check";
import { icon } from "./icons";
import { kLessonTasks, type LessonTask, solutionFiles } from "./lesson_tasks";
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
  reset: (lesson: Lesson) => Promise<void>;
  close: () => void;
}

type Progress = Record<string, string[]>;

const filesOf = (program: ProgramText) => new Map(program.files.map((file) => [baseName(file.path), file.text]));

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
      h("code", {}, language === "glsl" ? colored(text, "glsl").map(([part, name]) => (name ? h("span", { class: `code-${name}` }, part) : part)) : text),
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
  private running: AbortController | undefined; // of the check of a task

  constructor(private readonly host: LessonHost) {
    this.select.addEventListener("change", () => {
      const lesson = this.lessons.find((candidate) => candidate.name === this.select.value);
      if (lesson) host.openLesson(lesson);
    });
    replace(
      this.element,
      h("div", { class: "bar" }, this.select, this.summary, h("button", { type: "button", class: "icon", "aria-label": "Close the lesson", title: "Close the lesson", onclick: () => host.close() }, icon("close"))),
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
    this.running?.abort();
    this.showList();
    if (!lesson) return;
    replace(this.body, h("p", { class: "empty" }, "Loading…"));
    let text: string;
    try {
      text = await api.docs(lesson.page);
    } catch (error) {
      replace(this.body, h("p", { class: "empty" }, (error as Error).message));
      return;
    }
    if (this.current !== lesson) return;
    const tasks = kLessonTasks[lesson.name] ?? [];
    replace(this.body, renderMarkdown(this.withoutFooter(text), this.options(lesson)), this.taskSection(lesson, tasks), this.footer(lesson));
    this.body.scrollTop = 0;
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

  // The buttons below the tasks replace the links to other lessons.
  private withoutFooter(text: string): string {
    return text.replace(/\nPrograms?: [\s\S]*$/, "\n");
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
    return h("section", { class: "tasks", "aria-label": "Tasks", dataset: { lesson: lesson.name } }, h("h3", {}, tasks.length === 1 ? "Task" : "Tasks"), tasks.map((task, i) => this.task(lesson, task, i + 1)));
  }

  private task(lesson: Lesson, task: LessonTask, number: number): Node {
    const result = h("div", { class: "task-result", role: "status" });
    const hint = h("p", { class: "task-hint", hidden: true }, inlineMarkdown(task.hint));
    const element = h("div", { class: "task", dataset: { task: task.id } });
    const setDone = () => element.classList.toggle("done", this.doneTasks(lesson).has(task.id));
    const check = h("button", { type: "button", class: "primary task-check" }, "Check");
    check.addEventListener("click", async () => {
      const running = (this.running = new AbortController());
      this.enableChecks(false);
      replace(result, h("p", {}, "Rendering your program and the solution…"));
      const outcome = await this.check(lesson, task, running.signal);
      if (running.signal.aborted) return; // another lesson is shown
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
    const solution = h("button", { type: "button", class: "small", onclick: () => void this.showSolution(lesson, task) }, "Solution");
    const reset = h("button", { type: "button", class: "small", title: "Start again with the lesson's program", onclick: () => void this.reset(lesson) }, "Reset");
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
      return await checkTask(task, mine, filesOf(original), baseName(original.main), signal);
    } catch (error) {
      return { passed: false, message: (error as Error).message };
    }
  }

  private showResult(element: HTMLElement, result: CheckResult): void {
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
      !result.passed && yours && h("div", { class: "task-images" }, figure(yours, "Yours"), figure(result.expected, "Solution"), map),
    );
  }

  private async showSolution(lesson: Lesson, task: LessonTask): Promise<void> {
    const { workspace } = this.host;
    const answer = await ask(
      "Show the solution?",
      [h("p", {}, "The solution replaces the program in the editors. Undo (Ctrl+Z) in each editor returns to your version.")],
      [
        { label: "Cancel", value: false },
        { label: "Show the solution", value: true, primary: true },
      ],
    );
    if (!answer) return;
    try {
      const original = await api.program(lesson.program);
      if (this.current !== lesson) return; // another one was opened
      const originals = filesOf(original);
      const solution = solutionFiles(originals, baseName(original.main), task);
      for (const file of workspace.files) {
        const text = solution.get(baseName(file.path));
        if (text !== undefined && text !== workspace.textOf(file)) workspace.setText(file, text);
      }
    } catch (error) {
      notify((error as Error).message, "error");
    }
  }

  private async reset(lesson: Lesson): Promise<void> {
    const answer = await ask(
      "Reset the lesson?",
      [h("p", {}, `The files of the lesson in ${lesson.copy} are replaced by the original ones.`)],
      [
        { label: "Cancel", value: false },
        { label: "Reset", value: true, primary: true },
      ],
    );
    if (answer) await this.host.reset(lesson);
  }

  private footer(lesson: Lesson): Node {
    const index = this.lessons.indexOf(lesson);
    const button = (other: Lesson | undefined, label: string) =>
      other && h("button", { type: "button", onclick: () => this.host.openLesson(other) }, `${label}: ${other.title}`);
    return h("div", { class: "lesson-footer" }, button(this.lessons[index - 1], "Previous"), button(this.lessons[index + 1], "Next"));
  }
}
