// SPDX-License-Identifier: Apache-2.0
// The files of the open program and their editors: one per file, and one per stage of a lecture file. Saves edits after a
// pause, merges changes on disk, and copies a built-in program into the project at its first edit.
import { setDiagnostics, type Diagnostic as LintDiagnostic } from "@codemirror/lint";
import { Compartment, EditorState, type TransactionSpec } from "@codemirror/state";
import { EditorView, lineNumbers } from "@codemirror/view";
import { api, ApiError } from "./api";
import { glslCompletions } from "./completion";
import { type Diagnostic, rangeInLine } from "./diagnostic";
import { editorExtensions, type SourceLanguage } from "./editor_setup";
import type { GlslContext } from "./glsl_help";
import { type Segment, segmentTitles, splitLecture, stageOfFile } from "./lecture_segments";
import type { ParameterDescription, ProgramFile, ProgramText } from "./protocol";
import { formatDocument } from "./source_format";
import { mergeTexts, minimalChange } from "./text_merge";

// Text of a segment between blank lines, which the editor does not show.
interface Framed {
  prefix: string;
  body: string;
  suffix: string;
}

function frame(text: string): Framed {
  const prefix = /^(?:[ \t]*\r?\n)*/.exec(text)![0];
  if (prefix.length === text.length) return { prefix: "", body: text, suffix: "" };
  const rest = text.slice(prefix.length);
  const suffix = /(?:\r?\n[ \t]*)*$/.exec(rest)![0];
  return { prefix, body: rest.slice(0, rest.length - suffix.length), suffix };
}

const lineCount = (text: string) => text.split("\n").length - 1;

export interface EditorDocument {
  readonly id: string;
  title: string;
  readonly kind: Segment["kind"] | "toml" | "text";
  readonly file: SourceFile;
  prefix: string;
  suffix: string;
  state: EditorState;
  view: EditorView | undefined; // that shows it
  readonly numbers: Compartment;
  marks: Diagnostic["severity"] | undefined; // the worst problem in it
}

export function isGlsl(kind: EditorDocument["kind"]): kind is Segment["kind"] {
  return kind !== "toml" && kind !== "text";
}

// "missing": it was deleted on disk, and has no edit that would write it again.
export type FileStatus = "saved" | "changed" | "saving" | "conflict" | "failed" | "missing";

export interface SourceFile {
  path: string;
  readonly role: ProgramFile["role"];
  hash: string;
  base: string; // content on disk as far as known
  documents: EditorDocument[];
  status: FileStatus;
  message: string;
  modified: number; // time of the content on disk, 0 if unknown
  merging: boolean; // the content on disk is being merged, perhaps by a question to the user
}

export interface WorkspaceHandlers {
  onDocuments: () => void; // other documents exist
  onStatus: () => void;
  onSaved: (file: SourceFile) => void;
  // The program was copied to be edited.
  onRenamed: (program: string) => void;
  // Both the editor and the disk have changed the same lines.
  resolveConflict: (file: SourceFile, disk: string) => Promise<"mine" | "disk" | undefined>;
  // A folder for the copy of a built-in program; undefined if the user declines.
  chooseFolder: (proposal: string, message: string) => Promise<string | undefined>;
  explain: (id: string) => void;
  openLocation: (file: string, line: number, column: number) => void;
  notify: (message: string, kind: "info" | "error") => void;
  withdraw: (message: string) => void; // that no longer holds
}

const kSaveDelay = 300; // ms after the last edit
const kRetryDelays = [1, 2, 4, 8, 15, 30]; // seconds until a save that failed is repeated

let nextDocument = 1;

export class Workspace {
  program: ProgramText | undefined;
  files: SourceFile[] = [];
  parameters: readonly ParameterDescription[] = [];
  copyTo = ""; // folder for the copy of a built-in program
  private diagnostics: readonly Diagnostic[] = [];
  private timer: ReturnType<typeof setTimeout> | undefined;
  private saving: Promise<void> = Promise.resolve();
  private retry: ReturnType<typeof setTimeout> | undefined;
  private failures = 0; // since the last save that succeeded
  private quiet = false; // changes that do not come from the user
  private generation = 0;

  constructor(private readonly handlers: WorkspaceHandlers) {}

  get documents(): EditorDocument[] {
    return this.files.flatMap((file) => file.documents);
  }

  get status(): FileStatus {
    for (const status of ["conflict", "failed", "missing", "saving", "changed"] as const) if (this.files.some((file) => file.status === status)) return status;
    return "saved";
  }

  open(program: ProgramText): void {
    clearTimeout(this.timer);
    clearTimeout(this.retry);
    this.failures = 0;
    ++this.generation;
    this.program = program;
    this.diagnostics = [];
    this.copyTo = program.title.replace(/^.*\//, "");
    this.files = program.files.map((file) => {
      const source: SourceFile = { path: file.path, role: file.role, hash: file.hash, base: file.text, documents: [], status: "saved", message: "", modified: 0, merging: false };
      source.documents = this.createDocuments(source, file.text);
      return source;
    });
    this.handlers.onDocuments();
    this.handlers.onStatus();
  }

  textOf(file: SourceFile): string {
    return file.documents.map((document) => document.prefix + document.state.sliceDoc() + document.suffix).join("");
  }

  // Number of lines of the file above the editor's first line.
  lineOffset(document: EditorDocument): number {
    let lines = lineCount(document.prefix);
    for (const other of document.file.documents) {
      if (other === document) break;
      lines += lineCount(other.prefix) + other.state.doc.lines - 1 + lineCount(other.suffix);
    }
    return lines;
  }

  // The document and the line in it of a line of a file.
  locate(path: string, line: number): { document: EditorDocument; line: number } | undefined {
    const file = this.files.find((candidate) => candidate.path === path);
    if (!file) return undefined;
    for (const document of file.documents) {
      const local = Math.max(1, line) - this.lineOffset(document);
      if (local <= document.state.doc.lines + lineCount(document.suffix)) return { document, line: Math.min(Math.max(1, local), document.state.doc.lines) };
    }
    const last = file.documents[file.documents.length - 1];
    return last && { document: last, line: last.state.doc.lines };
  }

  // The document of a stage, as the linked program names it.
  locateStage(path: string, stage: string): EditorDocument | undefined {
    const file = this.files.find((candidate) => candidate.path === path);
    if (!file) return undefined;
    const kinds: Record<string, string> = { "ray generation": "rgen", "closest-hit": "rchit", "any-hit": "rahit", intersection: "rint", miss: "rmiss", callable: "rcall" };
    return file.documents.find((document) => document.kind === kinds[stage.replace(/ shader$/, "")]) ?? file.documents[0];
  }

  dispatch(document: EditorDocument, spec: TransactionSpec): void {
    if (document.view) document.view.dispatch(spec);
    else document.state = document.state.update(spec).state;
  }

  setDiagnostics(diagnostics: readonly Diagnostic[]): void {
    this.diagnostics = diagnostics;
    this.showDiagnostics();
    this.handlers.onStatus();
  }

  // Writes all edits to disk now, also those that could not be written before. `missing`: also files that were deleted.
  save({ missing = false } = {}): Promise<void> {
    clearTimeout(this.timer);
    clearTimeout(this.retry);
    for (const file of this.files)
      if (file.status === "failed" || (file.status === "conflict" && !file.merging) || (missing && file.status === "missing")) file.status = "changed";
    return this.afterSaving(async (generation) => {
      const copies = this.program?.builtIn === true && this.files.some((file) => file.status === "changed");
      if (copies && !(await this.makeCopy())) return;
      for (const file of this.files) if (file.status === "changed" && generation === this.generation) await this.saveFile(file);
      // The session opens the copy with the edits.
      if (copies && generation === this.generation) this.handlers.onRenamed(this.program!.name);
    });
  }

  // Saves until no edit is left, also not one that the user makes in the meantime. Returns false if an edit cannot be saved.
  async finish(): Promise<boolean> {
    do await this.save();
    while (this.status === "changed" || this.status === "saving");
    return this.status === "saved";
  }

  // Forgets all edits that are not saved: the editors show what is on disk, as far as known.
  discard(): void {
    clearTimeout(this.timer);
    clearTimeout(this.retry);
    for (const file of this.files) {
      if (file.status === "saved") continue;
      this.replaceText(file, file.base, true);
      file.status = "saved";
      file.message = "";
    }
    this.handlers.onStatus();
  }

  // Copies a built-in program into the project, so that files can be added to it. Returns false if it stays built-in.
  async ensureCopy(): Promise<boolean> {
    await this.afterSaving(async (generation) => {
      if (!this.program?.builtIn || !(await this.makeCopy())) return;
      if (generation === this.generation) this.handlers.onRenamed(this.program.name);
    });
    return this.program !== undefined && !this.program.builtIn;
  }

  // Runs `step` when all saves before have ended, unless another program was opened by then.
  private afterSaving(step: (generation: number) => Promise<void>): Promise<void> {
    const generation = this.generation;
    const run = async () => {
      if (generation === this.generation) await step(generation);
    };
    this.saving = this.saving.then(run, run);
    return this.saving;
  }

  // Reads the files that have changed on disk.
  async refresh(): Promise<void> {
    if (!this.program || this.program.builtIn) return;
    const generation = this.generation;
    let entries;
    try {
      entries = await api.files();
    } catch (error) {
      if ((error as ApiError).status !== 0 && generation === this.generation) this.reportMissing((error as ApiError).message); // else the connection reports it
      return;
    }
    if (generation !== this.generation) return;
    for (const file of this.files) {
      const entry = entries.find((candidate) => candidate.path === file.path);
      if (file.status === "saving" || file.status === "conflict") continue;
      if (entry ? entry.modified === file.modified && file.status !== "missing" : file.status === "missing") continue;
      file.modified = entry?.modified ?? 0;
      await this.reload(file); // the list can be incomplete
    }
  }

  // No file of the project can be read.
  private reportMissing(message: string): void {
    for (const file of this.files)
      if (file.status === "saved") {
        file.status = "missing";
        file.message = message;
        file.modified = 0;
      }
    this.handlers.onStatus();
  }

  // Replaces the content of a file, as one step of undo.
  setText(file: SourceFile, text: string): void {
    this.replaceText(file, text, false);
  }

  private sourceOf(document: EditorDocument): string {
    const own = this.textOf(document.file);
    if (this.program?.form === "lecture") return own;
    // Names of included files of the program count, too.
    const included = this.files.filter((file) => file !== document.file && file.role === "include" && own.includes(file.path.replace(/^.*\//, "")));
    return own + included.map((file) => `\n${this.textOf(file)}`).join("");
  }

  private contextOf(document: EditorDocument): GlslContext {
    const stage = document.kind === "common" || document.kind === "unknown" || document.kind === "toml" || document.kind === "text" ? undefined : document.kind;
    return { form: this.program?.form ?? "folder", stage, source: this.sourceOf(document), parameters: this.parameters };
  }

  private createDocuments(file: SourceFile, text: string): EditorDocument[] {
    if (file.role === "lecture") {
      const segments = splitLecture(text);
      const titles = segmentTitles(segments);
      return segments.map((segment, i) => this.createDocument(file, segment.kind, segments.length === 1 ? baseName(file.path) : titles[i]!, segment.text));
    }
    const kind = file.path.endsWith(".toml") ? "toml" : (stageOfFile(file.path) ?? (/\.(glsl|h)$/.test(file.path) ? "common" : "text"));
    return [this.createDocument(file, kind, baseName(file.path), text)];
  }

  private createDocument(file: SourceFile, kind: EditorDocument["kind"], title: string, text: string): EditorDocument {
    const { prefix, body, suffix } = file.role === "lecture" ? frame(text) : { prefix: "", body: text, suffix: "" };
    const document: EditorDocument = {
      id: `document${nextDocument++}`,
      title,
      kind,
      file,
      prefix,
      suffix,
      state: EditorState.create(),
      view: undefined,
      numbers: new Compartment(),
      marks: undefined,
    };
    const language: SourceLanguage = isGlsl(kind) ? "glsl" : kind;
    document.state = EditorState.create({
      doc: body,
      extensions: [
        text.includes("\r\n") ? EditorState.lineSeparator.of("\r\n") : [],
        document.numbers.of(this.numbersFor(document)),
        editorExtensions({
          language,
          label: title,
          context: () => this.contextOf(document),
          ...(language === "glsl" && { completions: glslCompletions(() => this.contextOf(document)) }),
          save: () => void this.save({ missing: true }),
          format: (view) => void formatDocument(view, language === "glsl"),
          extra: EditorView.updateListener.of((update) => {
            document.state = update.state;
            if (update.docChanged) this.edited(document, update.startState.doc.lines !== update.state.doc.lines);
          }),
        }),
      ],
    });
    return document;
  }

  private numbersFor(document: EditorDocument) {
    return lineNumbers({ formatNumber: (line) => String(line + this.lineOffset(document)) });
  }

  private edited(document: EditorDocument, linesMoved: boolean): void {
    if (linesMoved) this.renumber(document);
    if (this.quiet) return;
    document.file.status = "changed";
    this.handlers.onStatus();
    clearTimeout(this.timer);
    this.timer = setTimeout(() => void this.save(), kSaveDelay);
  }

  // The numbers of the lines below an edit.
  private renumber(document: EditorDocument): void {
    const documents = document.file.documents;
    for (const other of documents.slice(documents.indexOf(document) + 1))
      if (other.view) other.view.dispatch({ effects: other.numbers.reconfigure(this.numbersFor(other)) });
  }

  private async makeCopy(): Promise<boolean> {
    const program = this.program!;
    const generation = this.generation;
    let folder: string | undefined = this.copyTo;
    for (;;) {
      if (!folder) return false;
      try {
        await api.copyProgram(program.name, folder);
        break;
      } catch (error) {
        const failure = error as ApiError;
        if (failure.status !== 409) {
          this.fail(failure.message);
          return false;
        }
        folder = await this.handlers.chooseFolder(`${folder}_2`, failure.message);
        if (!folder) {
          this.fail("Built-in programs cannot be changed: the edits are not saved");
          return false;
        }
      }
    }
    let copy: ProgramText;
    try {
      copy = await api.program(folder);
    } catch (error) {
      this.fail((error as Error).message);
      return false;
    }
    if (generation !== this.generation) return false; // another program was opened
    const prefix = `${program.name}/`;
    for (const file of this.files) {
      const name = file.path.startsWith(prefix) ? file.path.slice(prefix.length) : baseName(file.path);
      const copied = copy.files.find((candidate) => candidate.path === `${folder}/${name}`);
      if (!copied) continue;
      // The session names the copy only from its next diagnostics on.
      this.diagnostics = this.diagnostics.map((diagnostic) => (diagnostic.file === file.path ? { ...diagnostic, file: copied.path } : diagnostic));
      file.path = copied.path;
      file.hash = copied.hash;
      file.base = copied.text;
    }
    this.program = { ...copy };
    this.handlers.notify(`The program was copied to ${folder}`, "info");
    return true;
  }

  private fail(message: string): void {
    const failed = this.files.filter((file) => file.status === "changed");
    // A repetition of the save is not reported again.
    if (failed.some((file) => file.message !== message)) this.handlers.notify(message, "error");
    for (const file of failed) {
      file.status = "failed";
      file.message = message;
    }
    this.handlers.onStatus();
    this.saveAgain();
  }

  private saveAgain(): void {
    clearTimeout(this.retry);
    const seconds = kRetryDelays[Math.min(this.failures++, kRetryDelays.length - 1)]!;
    this.retry = setTimeout(() => void this.save(), 1000 * seconds);
  }

  private async saveFile(file: SourceFile): Promise<void> {
    const text = this.textOf(file);
    if (text === file.base && file.hash !== "") {
      file.status = "saved";
      file.message = "";
      this.handlers.onStatus();
      return;
    }
    file.status = "saving";
    this.handlers.onStatus();
    try {
      const saved = await api.save(file.path, text, file.hash);
      file.hash = saved.hash;
      file.base = text;
      for (const message of file.message ? [`${file.path}: ${file.message}`, file.message] : []) this.handlers.withdraw(message);
      file.message = "";
      this.failures = 0;
      if (file.status === "saving") file.status = "saved";
      this.handlers.onStatus();
      this.handlers.onSaved(file);
    } catch (error) {
      const failure = error as ApiError;
      if (failure.status === 412) {
        file.status = "changed";
        await this.reload(file);
        return;
      }
      file.status = "failed";
      if (file.message !== failure.message) this.handlers.notify(`${file.path}: ${failure.message}`, "error");
      file.message = failure.message;
      this.handlers.onStatus();
      this.saveAgain();
    }
  }

  private async reload(file: SourceFile): Promise<void> {
    if (file.merging) return;
    file.merging = true;
    try {
      await this.mergeDisk(file);
    } finally {
      file.merging = false;
    }
  }

  // Merges the content on disk into the editor.
  private async mergeDisk(file: SourceFile): Promise<void> {
    let disk;
    try {
      disk = await api.file(file.path);
    } catch (error) {
      const failure = error as ApiError;
      if (failure.status === 404) {
        // It was deleted: the next edit writes it again.
        file.hash = "";
        if (file.status === "changed") await this.saveFile(file);
        else if (file.status === "saved") {
          file.status = "missing";
          file.message = `${file.path} was deleted on disk; the next edit or Ctrl+S writes it again`;
          this.handlers.onStatus();
        }
      }
      return;
    }
    if (file.status === "missing") {
      file.status = this.textOf(file) === file.base ? "saved" : "changed";
      file.message = "";
      this.handlers.onStatus();
    }
    if (disk.hash === file.hash) return;
    const ours = this.textOf(file);
    let merged = mergeTexts(file.base, ours, disk.text);
    if (merged === undefined) {
      file.status = "conflict";
      file.message = "The file was changed on disk, too";
      this.handlers.onStatus();
      const choice = await this.handlers.resolveConflict(file, disk.text);
      merged = choice === "disk" ? disk.text : choice === "mine" ? this.textOf(file) : undefined;
      if (merged === undefined) return; // stays a conflict until the next save
    }
    file.hash = disk.hash;
    file.base = disk.text;
    this.replaceText(file, merged, true);
    file.status = merged === disk.text ? "saved" : "changed";
    this.handlers.onStatus();
    if (file.status === "changed") await this.saveFile(file);
  }

  private replaceText(file: SourceFile, text: string, quiet: boolean): void {
    this.quiet = quiet;
    try {
      const segments = file.role === "lecture" ? splitLecture(text) : [{ kind: file.documents[0]!.kind, text }];
      const same = segments.length === file.documents.length && segments.every((segment, i) => segment.kind === file.documents[i]!.kind);
      if (same) {
        segments.forEach((segment, i) => {
          const document = file.documents[i]!;
          const framed = file.role === "lecture" ? frame(segment.text) : { prefix: "", body: segment.text, suffix: "" };
          const changed = document.prefix !== framed.prefix || document.suffix !== framed.suffix;
          document.prefix = framed.prefix;
          document.suffix = framed.suffix;
          const change = minimalChange(document.state.sliceDoc(), framed.body);
          if (change) this.applyChange(document, change);
          else if (changed) this.renumber(document);
        });
      } else {
        file.documents = this.createDocuments(file, text);
        this.handlers.onDocuments();
      }
    } finally {
      this.quiet = false;
    }
    if (!quiet) {
      file.status = "changed";
      this.handlers.onStatus();
      clearTimeout(this.timer);
      this.timer = setTimeout(() => void this.save(), 0);
    }
    this.showDiagnostics();
  }

  private applyChange(document: EditorDocument, change: { from: number; to: number; insert: string }): void {
    // Offsets count "\r\n" as one character in the editor.
    const text = document.state.sliceDoc();
    const shrink = (offset: number) => text.slice(0, offset).replaceAll("\r\n", "\n").length;
    this.dispatch(document, { changes: { from: shrink(change.from), to: shrink(change.to), insert: change.insert.replaceAll("\r\n", "\n") } });
  }

  private showDiagnostics(): void {
    const marks = new Map<EditorDocument, { lint: LintDiagnostic[]; worst: Diagnostic["severity"] | undefined }>();
    for (const document of this.documents) marks.set(document, { lint: [], worst: undefined });
    const rank = { error: 3, warning: 2, note: 1 };
    const add = (file: string, line: number, column: number, lint: Pick<LintDiagnostic, "severity" | "message" | "actions" | "source">, severity: Diagnostic["severity"] | undefined) => {
      const found = this.locate(file, line);
      if (!found) return;
      const entry = marks.get(found.document)!;
      const docLine = found.document.state.doc.line(found.line);
      const range = rangeInLine(docLine.text, column, lint.message);
      entry.lint.push({ ...lint, from: docLine.from + range.from, to: docLine.from + Math.max(range.to, range.from) });
      if (severity && (!entry.worst || rank[severity] > rank[entry.worst])) entry.worst = severity;
    };
    for (const diagnostic of this.diagnostics) {
      if (!diagnostic.file) continue;
      const severity = diagnostic.severity === "note" ? "info" : diagnostic.severity;
      const page = /^Q\d{3}$/.test(diagnostic.id);
      add(
        diagnostic.file,
        diagnostic.line,
        diagnostic.column,
        {
          severity,
          message: `${diagnostic.text}${diagnostic.id ? ` [${diagnostic.id}]` : ""}${diagnostic.fix ? `\nFix: ${diagnostic.fix}` : ""}`,
          actions: page ? [{ name: `Explain ${diagnostic.id}`, apply: () => this.handlers.explain(diagnostic.id) }] : [],
        },
        diagnostic.severity,
      );
      for (const related of diagnostic.related ?? [])
        add(
          related.file,
          related.line,
          related.column,
          {
            severity: "hint",
            message: `${related.text}\n${diagnostic.id}: ${diagnostic.text}`,
            actions: [{ name: "Go to the problem", apply: () => this.handlers.openLocation(diagnostic.file, diagnostic.line, diagnostic.column) }],
          },
          undefined,
        );
    }
    for (const [document, entry] of marks) {
      document.marks = entry.worst;
      this.dispatch(document, setDiagnostics(document.state, entry.lint));
    }
  }
}

export function baseName(path: string): string {
  return path.replace(/^.*\//, "");
}

