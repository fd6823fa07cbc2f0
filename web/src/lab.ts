// SPDX-License-Identifier: Apache-2.0
// The page: creates its parts, connects them with the session, opens programs and lessons, and keeps the address of the page
// up to date.
import { api, type ApiError } from "./api";
import { CameraControl } from "./camera_control";
import { type Diagnostic, isRunFinding } from "./diagnostic";
import { ask, menuButton, notify, withdraw } from "./dialog";
import { h, replace } from "./dom";
import { Downloads } from "./downloads";
import { EditorArea } from "./editor_pane";
import { showHelp } from "./help";
import { ImageBar } from "./image_bar";
import { ImageView } from "./image_view";
import { type LessonCommand, parameterValues, type RunCommand } from "./lesson_command";
import { LessonPanel } from "./lesson_panel";
import { connectDrops, connectKeys } from "./page_keys";
import { ParametersPanel, sameValue } from "./parameters_panel";
import { PipelineView } from "./pipeline_view";
import { PixelExplorer } from "./pixel_explorer";
import { PixelPanel } from "./pixel_panel";
import { ProblemsPanel } from "./problems_panel";
import { chooseProgram } from "./program_chooser";
import type { Lesson, Opened, ProgramList, Project } from "./protocol";
import { Session } from "./session";
import { SessionStatus } from "./session_status";
import { SourceViewer } from "./source_viewer";
import { split } from "./splitter";
import { TabList } from "./tabs";
import { setThemeChoice, type Theme, themeChoice } from "./theme";
import { Uploads } from "./uploads";
import { ViewPanel } from "./view_panel";
import { baseName, type SourceFile, Workspace } from "./workspace";
import { askForFolder, askForVersion } from "./workspace_dialogs";

const kPollInterval = 2000; // ms between looks at files that other programs may have changed
const kRetryInterval = 1500; // ms between attempts to reach the server at the start
const kSideTabs = [{ id: "parameters", title: "Parameters" }, { id: "view", title: "View" }, { id: "pixel", title: "Pixel" }];

export class Lab {
  private project: Project | undefined;
  private programs: ProgramList = { builtIn: [], project: [], scenes: [] };
  private lessons: readonly Lesson[] = [];
  private projectImages: string[] = [];
  private diagnostics: readonly Diagnostic[] = [];
  private outdated = false;
  private toldCamera = false;
  private wasConnected = false;
  private openings = 0; // the last one counts
  private choosing = false; // the dialog is open, or about to be
  private afterOpened: (() => void) | undefined; // once the program that is being opened runs
  private sizedByCommand = false; // a command of a lesson has changed the size of the image

  private readonly session: Session;
  private readonly workspace: Workspace;
  private readonly editors: EditorArea;
  private readonly image: ImageView;
  private readonly imageBar: ImageBar;
  private readonly status: SessionStatus;
  private readonly sources: SourceViewer;
  private readonly pixels: PixelExplorer;
  private readonly uploads: Uploads;
  private readonly downloads: Downloads;
  private readonly parameters: ParametersPanel;
  private readonly view: ViewPanel;
  private readonly pixelPanel: PixelPanel;
  private readonly problems: ProblemsPanel;
  private readonly pipeline: PipelineView;
  private readonly lesson: LessonPanel;

  private readonly runTimeButton: HTMLButtonElement = h(
    "button",
    { type: "button", class: "small", title: "A short render with checks in the shaders: values that are not finite, rays that hit where they start, wrong records", onclick: () => void this.checkAtRunTime() },
    "Run-time checks",
  );
  private readonly findings = h("button", { type: "button", class: "image-findings", hidden: true, title: "Show the problems", onclick: () => this.showDock("problems") });
  private readonly dockBody = h("div", { class: "panel-body" });
  private readonly dock: TabList;
  private readonly sideBody = h("div", { class: "panel-body" });
  private readonly side: TabList;
  private readonly outer;
  private readonly title = h("button", { type: "button", class: "program-title", title: "Open a program (Ctrl+O)", onclick: () => void this.choose() });
  private readonly saveState = h("span", { class: "save-state", role: "status" });
  private readonly lessonButton = h("button", { type: "button", "aria-pressed": "false", onclick: () => this.toggleLessons() }, "Lessons");

  constructor() {
    this.session = this.createSession();
    this.workspace = new Workspace({
      onDocuments: () => this.editors.refresh(),
      onStatus: () => {
        this.showSaveState();
        this.lesson?.showVersion();
      },
      onSaved: (file) => this.onSaved(file),
      onRenamed: (program) => void this.onCopied(program),
      resolveConflict: askForVersion,
      chooseFolder: askForFolder,
      explain: (id) => void this.sources.explain(id),
      openLocation: (file, line, column) => void this.sources.open(file, line, column),
      notify,
      withdraw,
    });
    this.editors = new EditorArea(this.workspace);
    this.sources = new SourceViewer(this.workspace, this.editors);
    this.image = new ImageView((image) => this.session.send({ do: "received", image }));
    this.imageBar = new ImageBar(this.session, () => void this.downloads.saveImage());
    this.status = new SessionStatus(this.session, this.image);
    this.downloads = new Downloads(this.session, this.workspace, this.image, { version: () => this.project?.version ?? "", samples: () => this.imageBar.samples });
    this.uploads = new Uploads({
      workspace: this.workspace,
      openProgram: (name) => this.openProgram(name),
      setScene: (path) => this.setScene(path),
      setEnvironment: (path) => this.setEnvironment(path),
      changed: () => void this.loadLists().catch(() => undefined), // the next list is newer
    });
    this.parameters = new ParametersPanel({
      set: (name, value) => this.session.setParameter(name, value),
      end: () => this.session.send({ do: "endDrag" }),
      upload: (file) => this.uploads.uploadImage(file),
      images: () => this.projectImages,
    });
    this.view = new ViewPanel({
      send: (command) => this.session.send(command),
      scene: (name) => void this.setScene(name),
      upload: (files) => void this.uploads.upload(files),
    });
    this.pixelPanel = new PixelPanel({
      explain: (x, y, sample) => void this.pixels.explain(x, y, sample),
      openSource: (file, line) => void this.sources.open(file, line, 0),
      hasSource: (file) => this.workspace.locate(file, 1) !== undefined || file.startsWith("quintet/"),
      print: (on) => this.pixels.print(on),
    });
    this.pixels = new PixelExplorer(this.session, this.image, this.pixelPanel, {
      usesCamera: () => this.usesCamera(),
      shownFrames: () => this.imageBar.samples,
      showPanel: () => this.selectSide("pixel"),
    });
    this.pipeline = this.createPipeline();
    this.problems = this.createProblems();
    this.lesson = new LessonPanel({
      openLesson: (lesson) => void this.openLesson(lesson),
      openFile: (name) => {
        const document = this.workspace.documents.find((candidate) => baseName(candidate.file.path) === name);
        if (document) this.editors.openDocument(document);
      },
      explain: (id) => void this.sources.explain(id),
      workspace: this.workspace,
      projectFolder: () => this.project?.folder ?? "",
      run: (command) => this.runCommand(command),
      openOwnProgram: (lesson) => this.openProgramOf(lesson, "mine"),
      restoreFiles: (lesson) => this.restoreFiles(lesson),
      close: () => void this.closeLesson(),
    });

    this.dock = new TabList("Problems and pipeline", this.dockBody, () => this.showDock());
    this.side = new TabList("Parameters, view and pixel", this.sideBody, () => this.showSide());
    this.side.show(kSideTabs, "parameters");
    this.outer = this.createLayout();
    this.outer.setHidden(true, false);
    replace(document.body, this.header(), h("main", {}, this.outer.element));
    this.connectCamera();
    this.connectPage();
    this.parameters.clear();
    this.showDock();
    this.showSide();
    this.showSaveState();
    this.showStatus();
  }

  async start(): Promise<void> {
    try {
      this.project = await api.project();
      await this.loadLists();
    } catch (error) {
      const failure = error as ApiError;
      this.image.setOverlay(failure.status === 403 ? "The token of this page is wrong. Open the address that the server printed." : failure.message, true);
      if (failure.status !== 403) setTimeout(() => void this.start(), kRetryInterval);
      return;
    }
    this.session.connect();
    await this.openFromAddress();
  }

  // Parts of the page

  private createSession(): Session {
    return new Session({
      onStatus: () => {
        const connected = this.session.connection === "open";
        if (connected && !this.wasConnected) void this.workspace.save();
        this.wasConnected = connected;
        this.showStatus();
      },
      onOpened: (opened) => this.onOpened(opened),
      onState: () => this.showState(),
      onDiagnostics: (diagnostics, outdated) => {
        this.diagnostics = diagnostics;
        this.outdated = outdated;
        this.workspace.setDiagnostics(diagnostics);
        this.problems.show(diagnostics, true);
        this.editors.refresh();
        this.showDock();
        this.showStatus();
      },
      onGraph: (graph) => this.pipeline.show(graph ?? undefined, "The diagram appears when the program compiles."),
      onImage: (image) => {
        this.imageBar.samples = image.samples;
        void this.image.show(image).then(() => this.imageBar.showFacts());
        this.showStatus();
      },
      onStatistics: (statistics) => {
        this.imageBar.statistics = statistics;
        this.imageBar.showFacts();
      },
      onRestarted: () => {
        this.imageBar.statistics = undefined;
        this.pixelPanel.showPrinted([], 0);
      },
      onReloaded: () => {
        void this.workspace.refresh();
        this.showStatus();
      },
      onPrinted: (lines, omitted) => this.pixelPanel.showPrinted(lines, omitted),
      onMessage: (message, kind) => notify(message, kind),
    });
  }

  private createPipeline(): PipelineView {
    return new PipelineView({
      openSource: (node) => {
        if (node.location) void this.sources.open(node.location.file, node.location.line, node.location.column);
        else if (node.stage) this.sources.openStage(node.stage.file, node.stage.kind);
      },
      openDiagnostic: (index) => {
        this.pipeline.select(index);
        const diagnostic = this.pipeline.diagnostics[index];
        if (diagnostic) void this.sources.open(diagnostic.file, diagnostic.line, diagnostic.column);
      },
    });
  }

  private createProblems(): ProblemsPanel {
    return new ProblemsPanel({
      open: (file, line, column) => void this.sources.open(file, line, column),
      explain: (id) => void this.sources.explain(id),
      showPixel: (x, y) => void this.pixels.select(x, y),
      inDiagram: (diagnostic) => {
        this.showDock("pipeline");
        const index = this.pipeline.diagnostics.findIndex((other) => other.id === diagnostic.id && other.file === diagnostic.file && other.line === diagnostic.line);
        this.pipeline.select(index < 0 ? undefined : index);
      },
    });
  }

  private createLayout() {
    const middle = split(
      h("section", { class: "area", id: "editors", "aria-label": "Editors" }, this.editors.element),
      h("section", { class: "area panel", id: "dock", "aria-label": "Problems and pipeline" }, h("div", { class: "bar" }, this.dock.element, h("div", { class: "actions" }, this.runTimeButton)), this.dockBody),
      { name: "middle", label: "Height of the editors", vertical: true, share: 0.7, minFirst: 120, minSecond: 90 },
    );
    const facts = h("div", { class: "image-status" }, this.imageBar.facts, this.pixels.hover);
    const right = split(
      h("section", { class: "area image-area", id: "image", "aria-label": "Image" }, this.imageBar.element, this.image.element, this.findings, facts),
      h("section", { class: "area panel", id: "side", "aria-label": "Parameters, view and pixel" }, h("div", { class: "bar" }, this.side.element), this.sideBody),
      { name: "right", label: "Height of the image", vertical: true, share: 0.6, minFirst: 160, minSecond: 110 },
    );
    const work = split(middle.element, right.element, { name: "work", label: "Width of the editors", vertical: false, share: 0.52, minFirst: 260, minSecond: 280 });
    return split(this.lesson.element, work.element, { name: "lesson", label: "Width of the lesson", vertical: false, share: 0.26, minFirst: 230, minSecond: 560 });
  }

  private header(): HTMLElement {
    const themes: [Theme | "system", string][] = [["system", "As the system"], ["light", "Light"], ["dark", "Dark"]];
    return h(
      "header",
      { class: "top" },
      h("span", { class: "brand" }, "Quintet", h("span", {}, "Lab")),
      this.title,
      this.saveState,
      h("span", { class: "space" }),
      this.status.link,
      this.lessonButton,
      menuButton(["Share"], "Share", () => [
        { label: "Image", hint: "PNG, as displayed", run: () => void this.downloads.saveImage() },
        { label: "Image values", hint: "OpenEXR, 32-bit floats", run: () => void this.downloads.saveExr() },
        { label: "Video…", hint: "MP4, WebM or GIF", run: () => void this.downloads.saveVideo() },
        { label: "Page with image and sources", hint: "HTML", run: () => void this.downloads.savePage() },
        { label: "Program", hint: "zip", run: () => void this.downloads.saveProgram("zip") },
        { label: "Lecture file", hint: ".rt.glsl", run: () => void this.downloads.saveProgram("lecture") },
      ]),
      menuButton(["Theme"], "Theme", () => themes.map(([value, label]) => ({ label, hint: themeChoice() === value ? "✓" : "", run: () => setThemeChoice(value) }))),
      h("button", { type: "button", class: "icon", title: "Keys and help (F1)", "aria-label": "Keys and help", onclick: () => showHelp(this.project) }, "?"),
    );
  }

  private connectCamera(): void {
    const { image, session } = this;
    new CameraControl(image.stage, {
      send: (command) => session.send(command),
      scale: () => image.scale,
      usesCamera: () => this.usesCamera(),
      eye: () => this.eyeParameter(),
      setParameter: (name, value) => session.setParameter(name, value),
      pixelAt: (event) => image.pixelAt(event),
      pick: (x, y) => void this.pixels.select(x, y),
      focusAt: (x, y) => void this.pixels.focusAt(x, y),
      cannotMove: () => {
        if (this.toldCamera) return;
        this.toldCamera = true;
        notify("The program has a camera of its own: dragging does not move it. A parameter 'eye' (vec3) would.");
      },
    });
  }

  private connectPage(): void {
    const byId = (id: string) => document.getElementById(id)!;
    const upload = (files: readonly File[]) => void this.uploads.upload(files);
    connectKeys({ choose: () => void this.choose(), save: () => void this.workspace.save({ missing: true }), help: () => showHelp(this.project), upload }, () => [
      [this.lesson.element, "select"],
      [byId("editors"), ".cm-content"],
      [byId("dock"), "[role=tab][aria-selected=true]"],
      [byId("image"), ".image-stage"],
      [byId("side"), "[role=tab][aria-selected=true]"],
    ]);
    connectDrops(upload);
    addEventListener("focus", () => {
      void this.workspace.refresh();
      // The user may have opened the new address in another tab.
      if (this.session.connection === "refused" || this.session.connection === "full") this.session.connect();
    });
    document.addEventListener("visibilitychange", () => {
      const hidden = document.visibilityState === "hidden";
      this.session.setHidden(hidden);
      if (!hidden) void this.workspace.refresh();
    });
    this.session.setHidden(document.visibilityState === "hidden");
    setInterval(() => {
      if (document.visibilityState === "visible" && this.session.connection === "open") void this.workspace.refresh();
    }, kPollInterval);
    addEventListener("beforeunload", (event) => {
      if (this.workspace.status === "saved") return;
      void this.workspace.save();
      event.preventDefault();
    });
    addEventListener("hashchange", () => void this.openFromAddress());
  }

  // Opening programs

  private async loadLists(): Promise<void> {
    const [programs, lessons, files] = await Promise.all([api.programs(), api.lessons(), api.files()]);
    this.programs = programs;
    this.lessons = lessons;
    this.projectImages = files.map((file) => file.path).filter((path) => /\.(png|jpe?g|webp|ktx2|hdr|exr)$/i.test(path));
    this.lesson.setLessons(lessons);
    this.showScenes();
  }

  private async openFromAddress(): Promise<void> {
    if (!this.project) return; // start() does it
    const address = new URLSearchParams(location.hash.slice(1));
    const name = address.get("lesson");
    const lesson = name ? this.lesson.find(name) : undefined;
    if (lesson) {
      if (this.lesson.lesson?.name !== lesson.name) await this.openLesson(lesson);
      else this.stay();
      return;
    }
    const program = address.get("program") ?? this.project!.program;
    if (this.workspace.program?.name === program && !this.lesson.lesson) return this.stay();
    const ofCourse = this.lesson.findProgram(program);
    if (ofCourse && !address.get("program")) await this.openLesson(ofCourse);
    else await this.openProgram(program, address.get("program") ? "" : this.project!.scene);
  }

  // What is being opened will not be shown.
  private stay(): void {
    ++this.openings;
    this.lesson.choose(undefined);
  }

  private setAddress(name: string, value: string): void {
    const text = `#${name}=${encodeURIComponent(value).replaceAll("%2F", "/")}`;
    if (location.hash !== text) history.pushState(null, "", text);
  }

  private async openProgram(name: string, scene = ""): Promise<void> {
    const opening = ++this.openings;
    await this.showLesson(undefined);
    if (await this.load(name, scene, opening)) this.setAddress("program", this.workspace.program!.name);
  }

  private async openLesson(lesson: Lesson): Promise<void> {
    const opening = ++this.openings;
    this.lesson.choose(lesson);
    await this.workspace.save();
    // The list may be older than the copy.
    try {
      this.lessons = await api.lessons();
      this.lesson.setLessons(this.lessons);
    } catch {
      // The connection reports it.
    }
    const current = this.lesson.find(lesson.name) ?? lesson;
    if (!(await this.load(current.copied ? current.copy : current.program, "", opening))) {
      if (opening === this.openings) this.lesson.choose(undefined);
      return;
    }
    this.workspace.copyTo = current.copy;
    this.setAddress("lesson", current.name);
    await this.showLesson(current);
  }

  private async showLesson(lesson: Lesson | undefined): Promise<void> {
    this.outer.setHidden(lesson === undefined, false);
    this.lessonButton.setAttribute("aria-pressed", String(lesson !== undefined));
    await this.lesson.show(lesson);
  }

  private toggleLessons(): void {
    if (this.lesson.lesson) void this.closeLesson();
    else {
      const lesson = this.lesson.findProgram(this.workspace.program?.name ?? "") ?? this.lessons[0];
      if (lesson) void this.openLesson(lesson);
    }
  }

  // The program stays open.
  private async closeLesson(): Promise<void> {
    await this.showLesson(undefined);
    if (this.workspace.program) this.setAddress("program", this.workspace.program.name);
  }

  private async restoreFiles(lesson: Lesson): Promise<void> {
    try {
      await this.workspace.save();
      await api.copyProgram(lesson.program, lesson.copy, true);
      this.workspace.discard();
      await this.load(lesson.copy, "", ++this.openings);
    } catch (error) {
      notify((error as Error).message, "error");
    }
  }

  // Opens a program that the page of a lesson names, beside this page: "mine" is the lesson's program as the user has
  // changed it. Returns false if that failed.
  private async openProgramOf(lesson: Lesson, name: string): Promise<boolean> {
    const builtIn = `<programs/${name}>`;
    const isOwn = name === "mine" || builtIn === lesson.program;
    const shown = this.workspace.program?.name;
    if (isOwn ? shown === lesson.copy || shown === lesson.program : shown === builtIn) return true;
    let current = lesson;
    try {
      this.lessons = await api.lessons();
      this.lesson.setLessons(this.lessons);
      current = this.lesson.find(lesson.name) ?? lesson;
    } catch {
      // The connection reports it.
    }
    if (!(await this.load(isOwn ? (current.copied ? current.copy : current.program) : builtIn, "", ++this.openings))) return false;
    if (isOwn) this.workspace.copyTo = current.copy;
    this.lesson.showVersion();
    return true;
  }

  // Does what a command of a lesson does in a terminal.
  private async runCommand(command: LessonCommand): Promise<void> {
    const lesson = this.lesson.lesson;
    if (!lesson || !("program" in command)) return;
    if (!(await this.openProgramOf(lesson, command.program)) || this.lesson.lesson !== lesson) return;
    const act = () => {
      if (command.kind === "run") this.showRun(command);
      else if (command.kind === "instrument") void this.checkAtRunTime();
    };
    if (command.kind === "problems" || command.kind === "instrument") this.showDock("problems");
    else if (command.kind === "pipeline") this.showDock("pipeline");
    else if (command.kind === "parameters") this.selectSide("parameters");
    else if (command.kind === "original") await this.lesson.startAgain(lesson);
    await this.workspace.save();
    if (command.kind === "run" && this.diagnostics.some((diagnostic) => diagnostic.severity === "error")) {
      this.showDock("problems");
      notify("The program has errors, which Problems lists", "error");
    } else if (this.session.opened && this.session.state) act();
    else this.afterOpened = act;
  }

  // The parameters, the output and the frame that a command shows. Whatever it does not set has its default.
  private showRun(run: RunCommand): void {
    const { session } = this;
    const { opened, state } = session;
    if (!opened || !state) return;
    for (const [parameter, value] of Object.entries(parameterValues(opened.description.parameters, run.parameters)))
      if (!sameValue(value, state.parameters[parameter]!)) session.send({ do: "set", parameter, value });
    const unknown = Object.keys(run.parameters).filter((name) => !opened.description.parameters.some((parameter) => parameter.name === name));
    if (unknown.length > 0) notify(`Your program has no parameter '${unknown[0]}'`, "error");
    const output = run.output ?? opened.description.outputs[0]?.name;
    if (output && state.output !== output) session.send({ do: "output", name: output });
    if (run.size || this.sizedByCommand) {
      const [width, height] = run.size ?? this.project!.size;
      session.send({ do: "size", width, height });
      this.sizedByCommand = run.size !== undefined;
    }
    if (state.frames && !state.still && !run.plays) {
      session.send({ do: "pause", on: true });
      session.send({ do: "rewind" });
      session.send({ do: "advance", until: run.frames });
      return;
    }
    if (state.frames && !state.still) session.send({ do: "rewind" });
    session.send({ do: "pause", on: false });
  }

  private async checkAtRunTime(): Promise<void> {
    this.runTimeButton.disabled = true;
    this.runTimeButton.textContent = "Checking…";
    this.showDock("problems");
    try {
      const before = this.diagnostics.length;
      await this.session.ask({ do: "instrument" }, "done");
      if (this.diagnostics.length <= before && !this.diagnostics.some((diagnostic) => /^Q00/.test(diagnostic.id))) notify("The run-time checks have found no problem");
    } catch (error) {
      notify((error as Error).message, "error");
    } finally {
      this.runTimeButton.disabled = false;
      this.runTimeButton.textContent = "Run-time checks";
    }
  }

  // Saves all edits, and asks whether those that cannot be saved are discarded. Returns false if they are not.
  private async mayLeave(opening: number): Promise<boolean> {
    const { workspace } = this;
    if (await workspace.finish()) return true;
    if (opening !== this.openings) return false; // the program that is opened instead asks
    const unsaved = workspace.files.filter((file) => file.status !== "saved");
    const answer = await ask(
      "Edits are not saved",
      unsaved.map((file) => h("p", {}, `${file.path}${file.message && `: ${file.message}`}`)),
      [
        { label: "Discard the edits", value: true },
        { label: "Stay here", value: false, primary: true },
      ],
    );
    if (answer) workspace.discard();
    return answer === true;
  }

  // Returns false if that failed, or if the user has opened something else in the meantime.
  private async load(name: string, scene: string, opening: number): Promise<boolean> {
    let program;
    do {
      // The user can edit while the program is read.
      if (!(await this.mayLeave(opening))) return false;
      try {
        program = await api.program(name);
      } catch (error) {
        notify(`${name}: ${(error as Error).message}`, "error");
        return false;
      }
      if (opening !== this.openings) return false;
    } while (this.workspace.status !== "saved");
    this.afterOpened = undefined;
    this.diagnostics = program.diagnostics;
    this.outdated = false;
    this.toldCamera = false;
    this.pixels.clear();
    this.pipeline.show(undefined, "The diagram appears when the program compiles.");
    this.workspace.parameters = [];
    this.parameters.clear();
    this.imageBar.clear();
    this.workspace.open(program);
    this.workspace.setDiagnostics(program.diagnostics);
    this.problems.show(program.diagnostics, program.diagnostics.length > 0);
    this.showDock();
    this.showTitle(program.title);
    const [width, height] = this.session.state ? [this.session.state.width, this.session.state.height] : this.project!.size;
    this.session.open({ program: program.name, scene, width, height });
    return true;
  }

  private showTitle(title: string): void {
    this.title.textContent = title;
    document.title = `${title} – Quintet Lab`;
  }

  private async choose(): Promise<void> {
    if (this.choosing) return;
    this.choosing = true;
    let choice;
    try {
      await this.loadLists();
      choice = await chooseProgram(this.programs, this.lessons, baseName(this.project?.folder ?? "the project"));
    } catch (error) {
      notify((error as Error).message, "error");
    } finally {
      this.choosing = false;
    }
    if (!choice) return;
    if (choice.kind === "program") await this.openProgram(choice.name);
    else if (choice.kind === "lesson") await this.openLesson(choice.lesson);
    else if (choice.kind === "import") await this.uploads.importProgram(choice.file);
    else {
      try {
        const copy = await api.copyProgram("", choice.folder);
        await this.openProgram(copy.name);
      } catch (error) {
        notify((error as Error).message, "error");
      }
    }
  }

  private async onCopied(program: string): Promise<void> {
    this.showTitle(program);
    if (!this.lesson.lesson) this.setAddress("program", program);
    await this.session.reopen({ program });
    try {
      await this.loadLists();
    } catch {
      // The next list is newer.
    }
  }

  private onSaved(file: SourceFile): void {
    // The session watches the files of the program, but not its scene.
    if (file.role === "scene") void this.session.reopen();
  }

  private async setScene(scene: string): Promise<void> {
    if (!this.session.request) {
      notify("No program is open yet", "error");
      return;
    }
    const before = this.session.request.scene;
    const message = await this.session.reopen({ scene, camera: undefined });
    if (message !== undefined) {
      notify(`${scene || "Scene of the program"}: ${message}`, "error");
      // Unless the user has chosen another one in the meantime.
      if (scene !== before && this.session.request?.scene === scene) await this.session.reopen({ scene: before, camera: undefined });
    }
    this.showScenes();
  }

  private async setEnvironment(source: string): Promise<void> {
    try {
      await this.session.ask({ do: "environment", source }, "done");
    } catch (error) {
      notify((error as Error).message, "error");
    }
  }

  // The camera

  private usesCamera(): boolean {
    if (!this.session.state || this.session.state.camera === null) return false;
    return this.workspace.files.some((file) => /\bcameraRay\s*\(|\bframe\s*\.\s*camera\b/.test(this.workspace.textOf(file)));
  }

  private eyeParameter(): { name: string; value: [number, number, number] } | undefined {
    const parameter = this.session.opened?.description.parameters.find((candidate) => candidate.name === "eye" && candidate.type === "vec3");
    const value = parameter && this.session.state?.parameters["eye"];
    return Array.isArray(value) && value.length === 3 ? { name: "eye", value: value as [number, number, number] } : undefined;
  }

  // Display of states

  private onOpened(opened: Opened): void {
    this.workspace.parameters = opened.description.parameters;
    this.image.reset();
    this.view.showOpened(opened);
    this.imageBar.showOutputs(opened.description.outputs);
    this.showScenes();
    this.showStatus();
  }

  private showState(): void {
    const state = this.session.state!;
    const opened = this.session.opened;
    if (opened) this.parameters.show(opened.description.parameters, state.parameters, this.workspace.program?.form === "folder");
    this.image.setSize(state.width, state.height);
    this.view.showState(state, this.usesCamera());
    this.pixelPanel.setSession(state.frames, state.prints);
    this.imageBar.showState(state);
    const act = this.afterOpened;
    this.afterOpened = undefined;
    act?.();
  }

  private showScenes(): void {
    this.view.showScenes(this.programs.scenes, this.session.request?.scene ?? "", this.workspace.program?.scene ?? "");
  }

  private showSaveState(): void {
    const status = this.workspace.status;
    const texts = { saved: this.workspace.program?.builtIn ? "Built-in: the first edit makes a copy" : "Saved", changed: "Edited", saving: "Saving…", conflict: "Also changed on disk", failed: "Not saved: trying again", missing: "Deleted on disk" };
    this.saveState.textContent = this.workspace.program ? texts[status] : "";
    this.saveState.className = `save-state ${status}`;
    const failed = this.workspace.files.find((file) => file.status === status && file.message);
    this.saveState.title = failed?.message ?? "";
    this.editors?.refresh();
  }

  private showDock(selected = this.dock.selected || "problems"): void {
    const errors = this.diagnostics.filter((diagnostic) => diagnostic.severity === "error").length;
    const shown = this.diagnostics.length;
    const mark = errors > 0 ? ("error" as const) : this.diagnostics.some((diagnostic) => diagnostic.severity === "warning") ? ("warning" as const) : undefined;
    this.dock.show([{ id: "problems", title: "Problems", ...(shown > 0 && { badge: String(shown) }), ...(mark && { mark }) }, { id: "pipeline", title: "Pipeline" }], selected);
    const content = selected === "pipeline" ? this.pipeline.element : this.problems.element;
    if (this.dockBody.firstChild !== content) this.dockBody.replaceChildren(content);
  }

  private showSide(): void {
    const panels: Record<string, HTMLElement> = { parameters: this.parameters.element, view: this.view.element, pixel: this.pixelPanel.element };
    this.sideBody.replaceChildren(panels[this.side.selected]!);
  }

  private selectSide(id: string): void {
    if (this.side.selected === id) return;
    this.side.show(kSideTabs, id);
    this.showSide();
  }

  // What the image shows is named below it, because the program has no errors.
  private showFindings(): void {
    const [first, ...others] = this.diagnostics.filter(isRunFinding);
    this.findings.hidden = !first;
    // Problems has the rest of the text.
    if (first) this.findings.textContent = `⚠ ${first.text.replace(/;.*$/, "")}${others.length > 0 ? `, and ${others.length} more` : ""}`;
  }

  private showStatus(): void {
    this.showFindings();
    this.status.show(this.diagnostics, this.outdated);
    this.imageBar.showFacts();
  }
}
