// SPDX-License-Identifier: Apache-2.0
// The page: creates its parts, connects them with the session, and keeps the address of the page up to date.
import { api, ApiError } from "./api";
import { CameraControl } from "./camera_control";
import { countText, type Diagnostic } from "./diagnostic";
import { ask, menuButton, notify, openSheet } from "./dialog";
import { h, replace } from "./dom";
import { EditorArea } from "./editor_pane";
import { icon } from "./icons";
import { ImageView } from "./image_view";
import { docsOptions, LessonPanel } from "./lesson_panel";
import { renderMarkdown } from "./markdown";
import { ParametersPanel } from "./parameters_panel";
import { PipelineView } from "./pipeline_view";
import { PixelPanel } from "./pixel_panel";
import { ProblemsPanel } from "./problems_panel";
import { chooseProgram, validFolder } from "./program_chooser";
import type { Lesson, Picked, ProgramList, Project, Statistics } from "./protocol";
import { formatValue } from "./ray_tree";
import { Session } from "./session";
import { colored, download, languageOf, sharedPage } from "./share";
import { split } from "./splitter";
import { stored } from "./stored";
import { TabList } from "./tabs";
import { setThemeChoice, type Theme, themeChoice } from "./theme";
import { ViewPanel } from "./view_panel";
import { baseName, type EditorDocument, type SourceFile, Workspace } from "./workspace";

const kExplainedFrames = 300; // an explanation of a later frame has to be asked for
const kPollInterval = 2000; // ms between looks at files that other programs may have changed
const kHoverDelay = 180; // ms of rest after which the surface under the pointer is read

export class Lab {
  private project: Project | undefined;
  private programs: ProgramList = { builtIn: [], project: [], scenes: [] };
  private lessons: readonly Lesson[] = [];
  private projectImages: string[] = [];
  private library: Map<string, string> | undefined;
  private diagnostics: readonly Diagnostic[] = [];
  private outdated = false;
  private checked = false;
  private statistics: Statistics | undefined;
  private shownSamples = 0;
  private pixel: { x: number; y: number } | undefined;
  private pixelRequest = 0;
  private hoverTimer: ReturnType<typeof setTimeout> | undefined;
  private toldCamera = false;
  private wasConnected = false;
  private readonly hadLesson = stored("lesson.open", false);

  private readonly session: Session;
  private readonly workspace: Workspace;
  private readonly editors: EditorArea;
  private readonly image: ImageView;
  private readonly parameters: ParametersPanel;
  private readonly view: ViewPanel;
  private readonly pixelPanel: PixelPanel;
  private readonly problems: ProblemsPanel;
  private readonly pipeline: PipelineView;
  private readonly lesson: LessonPanel;

  private readonly dockBody = h("div", { class: "panel-body" });
  private readonly dock: TabList;
  private readonly sideBody = h("div", { class: "panel-body" });
  private readonly side: TabList;
  private readonly outer;

  private readonly title = h("button", { type: "button", class: "program-title", title: "Open a program (Ctrl+O)", onclick: () => void this.choose() });
  private readonly saveState = h("span", { class: "save-state", role: "status" });
  private readonly lessonButton = h("button", { type: "button", "aria-pressed": "false", onclick: () => this.toggleLessons() }, "Lessons");
  private readonly linkState = h("span", { class: "link-state", role: "status" });
  private readonly output = h("select", { "aria-label": "Output", title: "Output or heat map" });
  private readonly play = h("button", { type: "button", class: "icon", onclick: () => this.togglePlay() });
  private readonly step = h("button", { type: "button", class: "icon", title: "Next frame", "aria-label": "Next frame", onclick: () => this.stepFrame() }, icon("next"));
  private readonly first = h("button", { type: "button", class: "icon", title: "First frame", "aria-label": "First frame", onclick: () => this.session.send({ do: "restart" }) }, icon("first"));
  private readonly undoButton = h("button", { type: "button", class: "icon", title: "Undo a change of camera or parameters", "aria-label": "Undo a change of camera or parameters", onclick: () => this.session.send({ do: "undo" }) }, icon("undo"));
  private readonly redoButton = h("button", { type: "button", class: "icon", title: "Redo", "aria-label": "Redo a change of camera or parameters", onclick: () => this.session.send({ do: "redo" }) }, icon("redo"));
  private readonly facts = h("div", { class: "image-facts" });
  private readonly hover = h("div", { class: "image-hover" });

  constructor() {
    this.session = new Session({
      onStatus: () => {
        const connected = this.session.connection === "open";
        if (connected && !this.wasConnected) void this.workspace.save();
        this.wasConnected = connected;
        this.showStatus();
      },
      onOpened: (opened) => {
        this.workspace.parameters = opened.description.parameters;
        this.image.reset();
        this.view.showOpened(opened);
        replace(this.output, opened.description.outputs.map((output) => h("option", { value: output.name, title: output.help }, output.kind === "heat" ? `${output.name} (heat map)` : output.name)));
        this.showScenes();
        this.showStatus();
      },
      onState: () => this.showState(),
      onDiagnostics: (diagnostics, outdated) => {
        this.diagnostics = diagnostics;
        this.outdated = outdated;
        this.checked = true;
        this.workspace.setDiagnostics(diagnostics);
        this.problems.show(diagnostics, true);
        this.editors.refresh();
        this.showDock();
        this.showStatus();
      },
      onGraph: (graph) => this.pipeline.show(graph ?? undefined, "The diagram appears when the program compiles."),
      onImage: (image) => {
        this.shownSamples = image.samples;
        void this.image.show(image).then(() => this.showFacts());
        this.showStatus();
      },
      onStatistics: (statistics) => {
        this.statistics = statistics;
        this.showFacts();
      },
      onRestarted: () => {
        this.statistics = undefined;
        this.pixelPanel.showPrinted([], 0);
      },
      onReloaded: () => {
        void this.workspace.refresh();
        this.showStatus();
      },
      onPrinted: (lines, omitted) => this.pixelPanel.showPrinted(lines, omitted),
      onMessage: (message, kind) => notify(message, kind),
    });

    this.workspace = new Workspace({
      onDocuments: () => this.editors.refresh(),
      onStatus: () => this.showSaveState(),
      onSaved: (file) => this.onSaved(file),
      onRenamed: (program) => void this.onCopied(program),
      resolveConflict: (file, disk) => this.resolveConflict(file, disk),
      chooseFolder: (proposal, message) => this.chooseFolder(proposal, message),
      explain: (id) => void this.explain(id),
      openLocation: (file, line, column) => void this.openLocation(file, line, column),
      notify,
    });
    this.editors = new EditorArea(this.workspace);
    this.image = new ImageView((image) => this.session.send({ do: "received", image }));
    this.parameters = new ParametersPanel({
      set: (name, value) => this.session.setParameter(name, value),
      end: () => this.session.send({ do: "endDrag" }),
      upload: (file) => this.uploadImage(file),
      images: () => this.projectImages,
    });
    this.view = new ViewPanel({
      send: (command) => this.session.send(command),
      scene: (name) => void this.setScene(name),
      upload: (files) => void this.upload(files),
    });
    this.pixelPanel = new PixelPanel({
      explain: (x, y, sample) => void this.explainPixel(x, y, sample),
      openSource: (file, line) => void this.openLocation(file, line, 0),
      hasSource: (file) => this.workspace.locate(file, 1) !== undefined || file.startsWith("quintet/"),
      print: (on) => this.setPrint(on),
    });
    this.problems = new ProblemsPanel({
      open: (file, line, column) => void this.openLocation(file, line, column),
      explain: (id) => void this.explain(id),
      inDiagram: (diagnostic) => {
        this.selectDock("pipeline");
        const index = this.pipeline.diagnostics.findIndex((other) => other.id === diagnostic.id && other.file === diagnostic.file && other.line === diagnostic.line);
        this.pipeline.select(index < 0 ? undefined : index);
      },
    });
    this.pipeline = new PipelineView({
      openSource: (node) => {
        if (node.location) void this.openLocation(node.location.file, node.location.line, node.location.column);
        else if (node.stage) this.openStage(node.stage.file, node.stage.kind);
      },
      openDiagnostic: (index) => {
        this.pipeline.select(index);
        const diagnostic = this.pipeline.diagnostics[index];
        if (diagnostic) void this.openLocation(diagnostic.file, diagnostic.line, diagnostic.column);
      },
    });
    this.lesson = new LessonPanel({
      openLesson: (lesson) => void this.openLesson(lesson),
      openFile: (name) => {
        const document = this.workspace.documents.find((candidate) => baseName(candidate.file.path) === name);
        if (document) this.editors.openDocument(document);
      },
      explain: (id) => void this.explain(id),
      workspace: this.workspace,
      reset: (lesson) => this.resetLesson(lesson),
      close: () => void this.closeLesson(),
    });

    this.dock = new TabList("Problems and pipeline", this.dockBody, () => this.showDock());
    this.side = new TabList("Parameters, view and pixel", this.sideBody, () => this.showSide());
    this.dock.show([{ id: "problems", title: "Problems" }, { id: "pipeline", title: "Pipeline" }], "problems");
    this.side.show([{ id: "parameters", title: "Parameters" }, { id: "view", title: "View" }, { id: "pixel", title: "Pixel" }], "parameters");

    const middle = split(
      h("section", { class: "area", id: "editors", "aria-label": "Editors" }, this.editors.element),
      h("section", { class: "area panel", id: "dock", "aria-label": "Problems and pipeline" }, h("div", { class: "bar" }, this.dock.element), this.dockBody),
      { name: "middle", label: "Height of the editors", vertical: true, share: 0.7, minFirst: 120, minSecond: 90 },
    );
    const right = split(
      h("section", { class: "area image-area", id: "image", "aria-label": "Image" }, this.imageBar(), this.image.element, h("div", { class: "image-status" }, this.facts, this.hover)),
      h("section", { class: "area panel", id: "side", "aria-label": "Parameters, view and pixel" }, h("div", { class: "bar" }, this.side.element), this.sideBody),
      { name: "right", label: "Height of the image", vertical: true, share: 0.6, minFirst: 160, minSecond: 110 },
    );
    const work = split(middle.element, right.element, { name: "work", label: "Width of the editors", vertical: false, share: 0.52, minFirst: 260, minSecond: 280 });
    this.outer = split(this.lesson.element, work.element, { name: "lesson", label: "Width of the lesson", vertical: false, share: 0.26, minFirst: 230, minSecond: 560 });
    this.outer.setHidden(true, false);
    replace(document.body, this.header(), h("main", {}, this.outer.element));
    this.connectCamera();
    this.connectPage();
    this.parameters.clear();
    this.undoButton.disabled = this.redoButton.disabled = true;
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
      if (failure.status !== 403) setTimeout(() => void this.start(), 1500);
      return;
    }
    this.session.connect();
    await this.openFromAddress();
  }

  // Parts of the page

  private header(): HTMLElement {
    const themes: [Theme | "system", string][] = [["system", "As the system"], ["light", "Light"], ["dark", "Dark"]];
    return h(
      "header",
      { class: "top" },
      h("span", { class: "brand" }, "Quintet", h("span", {}, "Lab")),
      this.title,
      this.saveState,
      h("span", { class: "space" }),
      this.linkState,
      this.lessonButton,
      menuButton(["Share"], "Share", () => [
        { label: "Image", hint: "PNG, as displayed", run: () => void this.downloadImage() },
        { label: "Page with image and sources", hint: "HTML", run: () => void this.downloadPage() },
        { label: "Program", hint: "zip", run: () => void this.exportProgram("zip") },
        { label: "Lecture file", hint: ".rt.glsl", disabled: this.workspace.program?.form !== "lecture", run: () => void this.exportProgram("lecture") },
      ]),
      menuButton(["Theme"], "Theme", () => themes.map(([value, label]) => ({ label, hint: themeChoice() === value ? "✓" : "", run: () => setThemeChoice(value) }))),
      h("button", { type: "button", class: "icon", title: "Keys and help (F1)", "aria-label": "Keys and help", onclick: () => this.help() }, "?"),
    );
  }

  private imageBar(): HTMLElement {
    this.output.addEventListener("change", () => this.session.send({ do: "output", name: this.output.value }));
    return h(
      "div",
      { class: "bar image-bar" },
      h("div", { class: "actions" }, this.output, this.first, this.play, this.step),
      h(
        "div",
        { class: "actions" },
        this.undoButton,
        this.redoButton,
        h("button", { type: "button", class: "icon", title: "Download the image (PNG)", "aria-label": "Download the image", onclick: () => void this.downloadImage() }, icon("download")),
      ),
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
      pick: (x, y) => void this.selectPixel(x, y),
      focusAt: (x, y) => void this.focusAt(x, y),
      cannotMove: () => {
        if (this.toldCamera) return;
        this.toldCamera = true;
        notify("The program has a camera of its own: dragging does not move it. A parameter 'eye' (vec3) would.");
      },
    });
    image.stage.addEventListener("pointermove", (event) => this.onHover(event));
    image.stage.addEventListener("pointerleave", () => this.onLeave());
    image.stage.addEventListener("keydown", (event) => {
      const state = session.state;
      if (event.key !== "Enter" || !state) return;
      event.preventDefault();
      const at = this.pixel ?? { x: Math.floor(state.width / 2), y: Math.floor(state.height / 2) };
      void this.selectPixel(at.x, at.y);
    });
  }

  private connectPage(): void {
    document.addEventListener("keydown", (event) => {
      if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "o") {
        event.preventDefault();
        void this.choose();
      } else if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "s") {
        event.preventDefault();
        void this.workspace.save();
      } else if (event.key === "F1") {
        event.preventDefault();
        this.help();
      } else if (event.key === "F6") {
        event.preventDefault();
        this.nextArea(event.shiftKey);
      }
    });
    // Files that are dropped anywhere are uploaded.
    let depth = 0;
    const isFile = (event: DragEvent) => event.dataTransfer?.types.includes("Files") === true;
    document.addEventListener("dragenter", (event) => {
      if (isFile(event) && ++depth === 1) document.body.classList.add("dropping");
    });
    document.addEventListener("dragleave", (event) => {
      if (isFile(event) && --depth <= 0) document.body.classList.remove("dropping");
    });
    document.addEventListener("dragover", (event) => {
      if (isFile(event)) event.preventDefault();
    });
    document.addEventListener("drop", (event) => {
      depth = 0;
      document.body.classList.remove("dropping");
      if (!isFile(event)) return;
      event.preventDefault();
      void this.upload([...event.dataTransfer!.files]);
    });
    addEventListener("focus", () => {
      void this.workspace.refresh();
      // The user may have opened the new address in another tab.
      if (this.session.connection === "refused" || this.session.connection === "full") this.session.connect();
    });
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

  // F6 moves the focus between the areas of the page.
  private nextArea(back: boolean): void {
    const areas: [HTMLElement, string][] = [
      [this.lesson.element, "select"],
      [document.getElementById("editors")!, ".cm-content"],
      [document.getElementById("dock")!, "[role=tab][aria-selected=true]"],
      [document.getElementById("image")!, ".image-stage"],
      [document.getElementById("side")!, "[role=tab][aria-selected=true]"],
    ];
    const shown = areas.filter(([area]) => area.offsetParent !== null);
    const index = shown.findIndex(([area]) => area.contains(document.activeElement));
    const [area, target] = shown[(index + (back ? -1 : 1) + shown.length) % shown.length]!;
    area.querySelector<HTMLElement>(target)?.focus();
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
    const address = new URLSearchParams(location.hash.slice(1));
    const name = address.get("lesson");
    const lesson = name ? this.lesson.find(name) : undefined;
    if (lesson) {
      if (this.lesson.lesson !== lesson) await this.openLesson(lesson);
      return;
    }
    const program = address.get("program") ?? this.project!.program;
    if (this.workspace.program?.name === program && !this.lesson.lesson) return;
    const ofCourse = this.lesson.find(program);
    if (ofCourse && !address.get("program")) await this.openLesson(ofCourse);
    else await this.openProgram(program, address.get("program") ? "" : this.project!.scene);
  }

  private setAddress(name: string, value: string): void {
    const text = `#${name}=${encodeURIComponent(value).replaceAll("%2F", "/")}`;
    if (location.hash !== text) history.pushState(null, "", text);
  }

  private async openProgram(name: string, scene = ""): Promise<void> {
    await this.showLesson(undefined);
    if (await this.load(name, scene)) this.setAddress("program", this.workspace.program!.name);
  }

  private async openLesson(lesson: Lesson): Promise<void> {
    await this.workspace.save();
    // The list may be older than the copy.
    try {
      this.lessons = await api.lessons();
      this.lesson.setLessons(this.lessons);
    } catch {
      // The connection reports it.
    }
    const current = this.lesson.find(lesson.name) ?? lesson;
    if (!(await this.load(current.copied ? current.copy : current.name, ""))) return;
    this.workspace.copyTo = current.copy;
    this.setAddress("lesson", baseName(current.name).replace(/>$/, ""));
    await this.showLesson(current);
  }

  private async showLesson(lesson: Lesson | undefined): Promise<void> {
    this.outer.setHidden(lesson === undefined, false);
    this.lessonButton.setAttribute("aria-pressed", String(lesson !== undefined));
    this.hadLesson.value = lesson !== undefined;
    await this.lesson.show(lesson);
  }

  private toggleLessons(): void {
    if (this.lesson.lesson) void this.closeLesson();
    else {
      const name = this.workspace.program?.name;
      const lesson = this.lessons.find((candidate) => candidate.name === name || candidate.copy === name) ?? this.lessons[0];
      if (lesson) void this.openLesson(lesson);
    }
  }

  // The program stays open.
  private async closeLesson(): Promise<void> {
    await this.showLesson(undefined);
    if (this.workspace.program) this.setAddress("program", this.workspace.program.name);
  }

  private async resetLesson(lesson: Lesson): Promise<void> {
    try {
      await this.workspace.save();
      await api.copyProgram(lesson.name, lesson.copy, true);
      await this.openLesson(lesson);
    } catch (error) {
      notify((error as Error).message, "error");
    }
  }

  private async load(name: string, scene: string): Promise<boolean> {
    await this.workspace.save();
    let program;
    try {
      program = await api.program(name);
    } catch (error) {
      notify(`${name}: ${(error as Error).message}`, "error");
      return false;
    }
    this.diagnostics = program.diagnostics;
    this.checked = program.diagnostics.length > 0;
    this.outdated = false;
    this.statistics = undefined;
    this.shownSamples = 0;
    this.toldCamera = false;
    this.pixel = undefined;
    this.image.mark(undefined);
    this.pixelPanel.clear();
    this.pipeline.show(undefined, "The diagram appears when the program compiles.");
    this.workspace.parameters = [];
    this.parameters.clear();
    this.undoButton.disabled = this.redoButton.disabled = true;
    replace(this.output);
    this.workspace.open(program);
    this.workspace.setDiagnostics(program.diagnostics);
    this.problems.show(program.diagnostics, this.checked);
    this.showDock();
    this.title.textContent = program.title;
    document.title = `${program.title} – Quintet Lab`;
    const [width, height] = this.session.state ? [this.session.state.width, this.session.state.height] : this.project!.size;
    this.session.open({ program: program.name, scene, width, height });
    return true;
  }

  private async choose(): Promise<void> {
    try {
      await this.loadLists();
    } catch (error) {
      notify((error as Error).message, "error");
      return;
    }
    const choice = await chooseProgram(this.programs, this.lessons, baseName(this.project?.folder ?? "the project"));
    if (!choice) return;
    if (choice.kind === "program") await this.openProgram(choice.name);
    else if (choice.kind === "lesson") await this.openLesson(choice.lesson);
    else if (choice.kind === "import") await this.importProgram(choice.file);
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
    this.title.textContent = program;
    const lesson = this.lesson.lesson;
    if (!lesson) this.setAddress("program", program);
    await this.session.reopen({ program });
    try {
      await this.loadLists();
    } catch {
      // The next list is newer.
    }
  }

  // Files

  private onSaved(file: SourceFile): void {
    // The session watches the files of the program, but not its scene.
    if (file.role === "scene") void this.session.reopen();
  }

  private async resolveConflict(file: SourceFile, disk: string): Promise<"mine" | "disk" | undefined> {
    return ask<"mine" | "disk">(
      `${file.path} was changed on disk`,
      [
        h("p", {}, "The same lines were changed here and by another program. Which version counts?"),
        h("details", {}, h("summary", {}, "Version on disk"), h("pre", { class: "conflict", tabindex: 0 }, disk)),
      ],
      [
        { label: "Load the version on disk", value: "disk" },
        { label: "Keep my version", value: "mine", primary: true },
      ],
    );
  }

  private async chooseFolder(proposal: string, message: string): Promise<string | undefined> {
    const input = h("input", { type: "text", value: proposal, "aria-label": "Folder" });
    const answer = await ask(
      "Copy the built-in program",
      [h("p", {}, `${message.charAt(0).toUpperCase()}${message.slice(1)}. Choose a different folder for your copy.`), h("label", {}, "Folder ", input)],
      [
        { label: "Cancel", value: false },
        { label: "Copy", value: true, primary: true },
      ],
    );
    if (!answer) return undefined;
    if (validFolder(input.value)) return input.value;
    return this.chooseFolder(proposal, "The name must consist of letters, digits, '_', '-' and '/'");
  }

  private async importProgram(file: File): Promise<void> {
    const zip = /\.zip$/i.test(file.name);
    const name = file.name.replace(/(\.rt)?\.(glsl|txt|zip)$/i, "").replace(/[^\w-]+/g, "_") || "imported";
    await this.importTo(file, name, zip, false);
  }

  private async importTo(file: File, folder: string, zip: boolean, replaceFiles: boolean): Promise<void> {
    try {
      const copy = await api.import(folder, zip ? file : await file.text(), zip ? "application/zip" : "text/plain", replaceFiles);
      await this.openProgram(copy.name);
      void this.loadLists();
    } catch (error) {
      const failure = error as ApiError;
      if (failure.status !== 409) {
        notify(`${file.name}: ${failure.message}`, "error");
        return;
      }
      const answer = await ask<"replace" | "other">(
        `${folder} exists`,
        [h("p", {}, failure.message)],
        [
          { label: "Import as a copy", value: "other", primary: true },
          { label: "Replace its files", value: "replace" },
        ],
      );
      if (answer === "replace") await this.importTo(file, folder, zip, true);
      else if (answer === "other") await this.importTo(file, `${folder}_2`, zip, false);
    }
  }

  // Scenes become the scene of the session, environment maps its environment; programs are opened.
  private async upload(files: readonly File[]): Promise<void> {
    const program = files.find((file) => /\.(rt\.glsl|zip)$/i.test(file.name));
    if (program) {
      await this.importProgram(program);
      return;
    }
    const paths = new Map<File, string>();
    for (const file of files) {
      const path = `uploads/${file.name.replace(/[^\w.-]+/g, "_").replace(/^\.+/, "")}`;
      if (await this.put(path, file)) paths.set(file, path);
    }
    if (paths.size === 0) return;
    void this.loadLists();
    const find = (pattern: RegExp) => [...paths.values()].find((path) => pattern.test(path));
    const scene = find(/\.(glb|gltf|scene\.toml)$/i);
    const environment = find(/\.(hdr|exr)$/i);
    if (scene) await this.setScene(scene);
    else if (environment) {
      try {
        await this.session.ask({ do: "environment", source: environment }, "done");
      } catch (error) {
        notify((error as Error).message, "error");
      }
    } else notify(`Uploaded: ${[...paths.values()].join(", ")}`);
  }

  private async put(path: string, file: File): Promise<boolean> {
    try {
      await api.save(path, file, "");
      return true;
    } catch (error) {
      const failure = error as ApiError;
      if (failure.status !== 412) {
        notify(`${file.name}: ${failure.message}`, "error");
        return false;
      }
    }
    const answer = await ask(
      `${path} exists`,
      [h("p", {}, "Replace the file in the project?")],
      [
        { label: "Keep the old file", value: false },
        { label: "Replace", value: true, primary: true },
      ],
    );
    if (!answer) return answer === false;
    try {
      await api.save(path, file, "*");
      return true;
    } catch (error) {
      notify(`${file.name}: ${(error as Error).message}`, "error");
      return false;
    }
  }

  private async uploadImage(file: File): Promise<string | undefined> {
    if (!(await this.workspace.ensureCopy())) return undefined;
    const folder = this.workspace.program!.main.replace(/[^/]*$/, "");
    const path = folder + file.name.replace(/[^\w.-]+/g, "_").replace(/^\.+/, "");
    if (!(await this.put(path, file))) return undefined;
    void this.loadLists();
    return path;
  }

  private async setScene(scene: string): Promise<void> {
    const before = this.session.request?.scene ?? "";
    const message = await this.session.reopen({ scene, camera: undefined });
    if (message === undefined) {
      this.showScenes();
      return;
    }
    notify(`${scene || "Scene of the program"}: ${message}`, "error");
    if (scene !== before) await this.session.reopen({ scene: before, camera: undefined });
    this.showScenes();
  }

  // Image

  private usesCamera(): boolean {
    if (!this.session.state || this.session.state.camera === null) return false;
    return this.workspace.files.some((file) => /\bcameraRay\s*\(|\bframe\s*\.\s*camera\b/.test(this.workspace.textOf(file)));
  }

  private eyeParameter(): { name: string; value: [number, number, number] } | undefined {
    const parameter = this.session.opened?.description.parameters.find((candidate) => candidate.name === "eye" && candidate.type === "vec3");
    const value = parameter && this.session.state?.parameters["eye"];
    return Array.isArray(value) && value.length === 3 ? { name: "eye", value: value as [number, number, number] } : undefined;
  }

  private async selectPixel(x: number, y: number): Promise<void> {
    this.pixel = { x, y };
    this.image.mark(this.pixel);
    // The frame that is shown, unless rendering all frames before it takes long.
    if (this.session.state?.frames) this.pixelPanel.sampleNumber = this.shownSamples <= kExplainedFrames ? Math.max(0, this.shownSamples - 1) : 0;
    if (this.side.selected !== "pixel") this.selectSide("pixel");
    if (this.pixelPanel.printing) this.setPrint(true);
    const request = ++this.pixelRequest;
    const facts: { x: number; y: number; value?: readonly (number | string)[]; picked?: Picked; displayed?: readonly number[] } = { x, y };
    const displayed = this.image.displayedColor(x, y);
    if (displayed) facts.displayed = displayed;
    const show = () => {
      if (request === this.pixelRequest) this.pixelPanel.showFacts(facts);
    };
    show();
    const value = this.session.ask({ do: "value", x, y }, "value").then((event) => ((facts.value = event.value), show()), () => undefined);
    const picked = this.usesCamera() ? this.session.ask({ do: "pick", x, y }, "picked").then((event) => ((facts.picked = event), show()), () => undefined) : undefined;
    await Promise.all([value, picked, this.explainPixel(x, y, this.pixelPanel.sampleNumber)]);
  }

  private async explainPixel(x: number, y: number, sample: number): Promise<void> {
    const request = this.pixelRequest;
    this.pixelPanel.say("Tracing the sample…");
    try {
      const event = await this.session.ask({ do: "explain", x, y, sample }, "explained");
      if (request === this.pixelRequest) this.pixelPanel.showExplanation(event.explanation);
    } catch (error) {
      if (request === this.pixelRequest) this.pixelPanel.say((error as Error).message);
    }
  }

  private async focusAt(x: number, y: number): Promise<void> {
    try {
      const event = await this.session.ask({ do: "pick", x, y }, "picked");
      if (event.position) this.session.send({ do: "orbitCenter", point: event.position });
    } catch (error) {
      notify((error as Error).message, "error");
    }
  }

  private setPrint(on: boolean): void {
    if (on && this.pixel) this.session.send({ do: "print", x: this.pixel.x, y: this.pixel.y });
    else this.session.send({ do: "print", on: false });
  }

  private onHover(event: PointerEvent): void {
    clearTimeout(this.hoverTimer);
    if (event.buttons !== 0 || !this.session.hasImage) return;
    const at = this.image.pixelAt(event);
    if (!at) {
      this.onLeave();
      return;
    }
    const color = this.image.displayedColor(at.x, at.y);
    const text = `${at.x}, ${at.y}${color ? ` · ${color.join(" ")}` : ""}`;
    this.hover.textContent = text;
    if (!this.usesCamera() || this.session.worker?.state !== "started") return;
    this.hoverTimer = setTimeout(async () => {
      try {
        const picked = await this.session.ask({ do: "pick", ...at }, "picked");
        if (this.hover.textContent === text && picked.instance !== null)
          this.hover.textContent = `${text} · ${picked.instance} · depth ${formatValue(picked.distance)} m · normal ${formatValue((picked.normal ?? []).map((value) => Math.round(value * 1000) / 1000))}`;
      } catch {
        // The position and the color remain.
      }
    }, kHoverDelay);
  }

  private onLeave(): void {
    clearTimeout(this.hoverTimer);
    this.hover.textContent = "";
  }

  private get playing(): boolean {
    return this.session.state?.paused === false;
  }

  private togglePlay(): void {
    const state = this.session.state;
    if (state) this.session.send({ do: "pause", on: !state.paused });
  }

  private stepFrame(): void {
    this.session.send({ do: "advance", frames: 1 });
  }

  // Display of states

  private showState(): void {
    const state = this.session.state!;
    const opened = this.session.opened;
    if (opened) this.parameters.show(opened.description.parameters, state.parameters, this.workspace.program?.form === "folder");
    if (document.activeElement !== this.output) this.output.value = state.output;
    this.image.setSize(state.width, state.height);
    this.view.showState(state, this.usesCamera());
    this.pixelPanel.setSession(state.frames, state.prints);
    this.undoButton.disabled = !state.canUndo;
    this.redoButton.disabled = !state.canRedo;
    this.showFacts();
  }

  private showScenes(): void {
    this.view.showScenes(this.programs.scenes, this.session.request?.scene ?? "", this.workspace.program?.scene ?? "");
  }

  private showFacts(): void {
    const state = this.session.state;
    this.step.hidden = this.first.hidden = !state?.frames;
    this.output.hidden = this.output.options.length === 0;
    this.play.hidden = !state;
    const playing = this.playing;
    if (this.play.dataset["icon"] !== String(playing)) {
      this.play.dataset["icon"] = String(playing);
      replace(this.play, icon(playing ? "pause" : "play"));
    }
    this.play.title = state?.frames ? (playing ? "Pause at this frame" : "Play frames") : playing ? "Pause refinement" : "Continue refinement";
    this.play.setAttribute("aria-label", this.play.title);
    if (!state || !this.session.hasImage) {
      replace(this.facts);
      return;
    }
    const parts: string[] = [];
    if (state.frames) parts.push(`Frame ${Math.max(0, this.shownSamples - 1)}`);
    else parts.push(`${this.shownSamples} of ${state.samples} samples`);
    const statistics = this.statistics;
    if (statistics && statistics.raysPerSecond > 0) parts.push(`${raysText(statistics.raysPerSecond)} rays/s`);
    if (statistics && statistics.error !== null && !state.frames) parts.push(`error ≤ ${percentText(statistics.error)}`);
    parts.push(`${state.width} × ${state.height}`);
    if (state.paused) parts.push("paused");
    replace(this.facts, parts.join(" · "));
    if (!state.frames) this.facts.style.setProperty("--progress", String(Math.min(1, this.shownSamples / Math.max(1, state.samples))));
    else this.facts.style.removeProperty("--progress");
  }

  private showSaveState(): void {
    const status = this.workspace.status;
    const texts = { saved: this.workspace.program?.builtIn ? "Built-in: the first edit makes a copy" : "Saved", changed: "Edited", saving: "Saving…", conflict: "Changed on disk, too", failed: "Not saved" };
    this.saveState.textContent = this.workspace.program ? texts[status] : "";
    this.saveState.className = `save-state ${status}`;
    const failed = this.workspace.files.find((file) => file.status === status && file.message);
    this.saveState.title = failed?.message ?? "";
    this.editors?.refresh();
  }

  private showDock(): void {
    const errors = this.diagnostics.filter((diagnostic) => diagnostic.severity === "error").length;
    const shown = this.diagnostics.length;
    const mark = errors > 0 ? ("error" as const) : this.diagnostics.some((diagnostic) => diagnostic.severity === "warning") ? ("warning" as const) : undefined;
    this.dock.show([{ id: "problems", title: "Problems", ...(shown > 0 && { badge: String(shown) }), ...(mark && { mark }) }, { id: "pipeline", title: "Pipeline" }], this.dock.selected || "problems");
    const content = this.dock.selected === "pipeline" ? this.pipeline.element : this.problems.element;
    if (this.dockBody.firstChild !== content) this.dockBody.replaceChildren(content);
  }

  private selectDock(id: string): void {
    this.dock.show([{ id: "problems", title: "Problems" }, { id: "pipeline", title: "Pipeline" }], id);
    this.showDock();
  }

  private showSide(): void {
    const panels: Record<string, HTMLElement> = { parameters: this.parameters.element, view: this.view.element, pixel: this.pixelPanel.element };
    this.sideBody.replaceChildren(panels[this.side.selected]!);
  }

  private selectSide(id: string): void {
    this.side.show([{ id: "parameters", title: "Parameters" }, { id: "view", title: "View" }, { id: "pixel", title: "Pixel" }], id);
    this.showSide();
  }

  private showStatus(): void {
    const { session } = this;
    const worker = session.worker;
    const errors = this.diagnostics.filter((diagnostic) => diagnostic.severity === "error");
    const button = (label: string, run: () => void) => h("button", { type: "button", onclick: run }, label);
    const message = (title: string, text: string, ...actions: Node[]) => h("div", { class: "message" }, h("b", {}, title), text && h("span", {}, text), actions.length > 0 && h("div", { class: "message-actions" }, actions));
    const restart = () => button("Start again", () => session.send({ do: "restart" }));
    const connect = () => button("Connect now", () => session.connect());

    let dot = "good";
    let label = session.opened?.device ?? "Connected";
    if (session.connection !== "open") {
      dot = session.connection === "connecting" ? "busy" : "bad";
      label = session.connection === "connecting" ? "Connecting" : "No connection";
    } else if (worker && worker.state !== "started") {
      dot = worker.state === "idle" ? "busy" : "bad";
      label = { started: "", waiting: "Stopped", crashed: "Crashed", hung: "Stopped: too slow", idle: "Idle" }[worker.state];
    }
    replace(this.linkState, h("span", { class: `dot ${dot}`, "aria-hidden": "true" }), label);

    if (session.connection === "refused" || session.connection === "full") this.image.setOverlay(message("No connection", session.connectionMessage, connect()), true, !session.hasImage);
    else if (session.connection === "lost") this.image.setOverlay(message("The server does not answer", "The page connects again as soon as it runs. Edits stay here until they can be saved.", connect()), true, !session.hasImage);
    else if (worker?.state === "crashed" || worker?.state === "hung" || worker?.state === "waiting") {
      const cause = session.cause;
      const title = cause?.state === "hung" ? "The shader takes too long" : cause ? "The render process crashed" : "The render process has stopped";
      const sentences = [cause?.message, worker.state === "waiting" ? worker.message : ""].filter(Boolean).map((text) => `${text!.charAt(0).toUpperCase()}${text!.slice(1)}.`);
      this.image.setOverlay(message(title, sentences.join(" "), restart()), true, !session.hasImage);
    }
    else if (worker?.state === "idle") this.image.setOverlay(message("The render process has ended after a pause", "The next change starts it again.", restart()), false);
    else if (errors.length > 0 && !session.hasImage) this.image.setOverlay(message("The program has errors", countText(this.diagnostics)), true, !session.hasImage);
    else if (errors.length > 0) this.image.setOverlay(message("", `${countText(errors)}: the image shows the last version without errors`), this.outdated);
    else if (session.failure) this.image.setOverlay(message("The render stopped", session.failure, restart()), true, !session.hasImage);
    else if (!session.hasImage) this.image.setOverlay(message("", session.connection === "connecting" ? "Connecting…" : session.stage ? `${session.stage.charAt(0).toUpperCase()}${session.stage.slice(1)}…` : "Rendering…"), true, !session.hasImage);
    else this.image.setOverlay("", false);
    this.showFacts();
  }

  // Help and sources

  private async explain(id: string): Promise<void> {
    try {
      const page = `diagnostics/${id}.md`;
      const text = await api.docs(page);
      const options = docsOptions(page, () => undefined, (other) => void this.explain(other));
      openSheet(id, renderMarkdown(text, { ...options, firstHeading: 3 }));
    } catch (error) {
      notify((error as Error).message, "error");
    }
  }

  private async openLocation(file: string, line: number, column: number): Promise<void> {
    if (this.editors.open(file, line, column)) return;
    if (!file.startsWith("quintet/")) {
      notify(`${file} is not a file of the open program`);
      return;
    }
    try {
      this.library ??= new Map((await api.library()).map((entry) => [entry.path, entry.text]));
    } catch (error) {
      notify((error as Error).message, "error");
      return;
    }
    const text = this.library.get(file);
    if (text === undefined) notify(`${file} is not a file of the shader library`);
    else openSheet(`${file}, read only`, sourceListing(file, text, line));
  }

  private openStage(file: string, kind: string): void {
    const found: EditorDocument | undefined = this.workspace.locateStage(file, kind);
    if (found) this.editors.openDocument(found);
    else void this.openLocation(file, 1, 0);
  }

  private help(): void {
    const keys: [string, [string, string][]][] = [
      ["Page", [["Ctrl+O", "Open a program"], ["Ctrl+S", "Save now; edits are saved by themselves after a moment"], ["F6, Shift+F6", "Next or previous area"], ["F1", "This help"]]],
      [
        "Editor",
        [
          ["Ctrl+Space", "Complete a name"],
          ["Ctrl+F", "Find and replace"],
          ["F8", "Next problem"],
          ["Ctrl+/", "Comment or uncomment lines"],
          ["Shift+Alt+F", "Format"],
          ["Ctrl+Z, Ctrl+Y", "Undo, redo"],
          ["Escape, then Tab", "Leave the editor"],
        ],
      ],
      [
        "Image",
        [
          ["Drag", "Turn the camera"],
          ["Shift + drag, middle button", "Move the camera sideways"],
          ["Wheel, right button", "Zoom"],
          ["Double click", "Turn around this point"],
          ["Click, Enter", "Explain the pixel: rays, payloads, source lines"],
          ["Arrow keys, + and −", "Turn and zoom"],
          ["W A S D E Q", "Fly; with Shift, faster"],
          ["Home", "Show the whole scene"],
        ],
      ],
    ];
    openSheet(
      "Keys",
      h(
        "div",
        {},
        keys.map(([title, rows]) => [h("h3", {}, title), h("table", { class: "keys" }, h("tbody", {}, rows.map(([key, text]) => h("tr", {}, h("th", { scope: "row" }, key), h("td", {}, text)))))]),
        h("p", {}, `Quintet ${this.project?.version ?? ""}. Files are in ${this.project?.folder ?? ""}. They are plain files: the commands quintet run and quintet check work with them, too.`),
      ),
    );
  }

  // Sharing

  private fileName(): string {
    return (this.workspace.program?.title ?? "image").replace(/^.*\//, "").replace(/\.rt\.glsl$/, "");
  }

  private async imageFile(): Promise<Blob | undefined> {
    if (!this.session.hasImage) return undefined;
    const latest = this.image.latest;
    // The file of the worker has the exact pixels.
    if (latest?.mime === "image/png") return new Blob([latest.file], { type: latest.mime });
    return new Promise((resolve) => this.image.canvas.toBlob((blob) => resolve(blob ?? undefined), "image/png"));
  }

  private async downloadImage(): Promise<void> {
    const file = await this.imageFile();
    if (file) download(file, `${this.fileName()}.png`);
    else notify("There is no image yet", "error");
  }

  private async downloadPage(): Promise<void> {
    const { session, workspace } = this;
    const state = session.state;
    const file = await this.imageFile();
    const image = file ? await dataAddress(file) : "";
    const program = workspace.program;
    if (!program) return;
    const text = sharedPage({
      title: program.title,
      version: this.project?.version ?? "",
      scene: session.opened?.scene ?? "",
      device: session.opened?.device ?? "",
      output: state?.output ?? "",
      samples: state?.frames ? `${this.shownSamples} frames` : `${this.shownSamples} samples per pixel`,
      parameters: state?.parameters ?? {},
      image,
      width: state?.width ?? 0,
      height: state?.height ?? 0,
      files: workspace.files.map((source) => ({ path: source.path, text: workspace.textOf(source) })),
    });
    download(new Blob([text], { type: "text/html" }), `${this.fileName()}.html`);
  }

  private async exportProgram(form: "zip" | "lecture"): Promise<void> {
    try {
      await this.workspace.save();
      const file = await api.export(this.workspace.program!.name, form);
      download(file, form === "zip" ? `${this.fileName()}.zip` : `${this.fileName()}.rt.glsl`);
    } catch (error) {
      notify((error as Error).message, "error");
    }
  }
}

function raysText(rate: number): string {
  for (const [factor, unit] of [[1e9, "G"], [1e6, "M"], [1e3, "k"]] as const) if (rate >= factor) return `${(rate / factor).toPrecision(3)} ${unit}`;
  return rate.toFixed(0);
}

function percentText(value: number): string {
  const percent = 100 * value;
  return `${percent >= 10 ? percent.toFixed(0) : percent.toPrecision(2)} %`;
}

function sourceListing(file: string, text: string, line: number): Node {
  const listing = h("pre", { class: "listing", tabindex: 0 });
  const lines: [string, string][][] = [[]];
  for (const [part, name] of colored(text, languageOf(file)))
    part.split("\n").forEach((piece, i) => {
      if (i > 0) lines.push([]);
      if (piece) lines[lines.length - 1]!.push([piece, name]);
    });
  replace(
    listing,
    lines.map((parts, i) => h("div", { class: i + 1 === line ? "current" : undefined }, h("span", { class: "line-number" }, i + 1), parts.map(([part, name]) => (name ? h("span", { class: `code-${name}` }, part) : part)))),
  );
  requestAnimationFrame(() => listing.querySelector(".current")?.scrollIntoView({ block: "center" }));
  return listing;
}

function dataAddress(file: Blob): Promise<string> {
  return new Promise((resolve, reject) => {
    const reader = new FileReader();
    reader.onload = () => resolve(reader.result as string);
    reader.onerror = () => reject(reader.error ?? new Error("The image cannot be read"));
    reader.readAsDataURL(file);
  });
}

