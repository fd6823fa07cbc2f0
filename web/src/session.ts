// SPDX-License-Identifier: Apache-2.0
// The session of this page: what is open, its latest state, and how it is opened again after a lost connection or a change
// of the scene file.
import { Connection, type ConnectionState } from "./connection";
import type { Diagnostic } from "./diagnostic";
import type { PipelineModel } from "./pipeline_model";
import type { Command, Commands, EventName, EventOf, ImageMessage, Opened, ParameterValue, PrintedLine, ServerEvent, SessionState, Statistics, WorkerState } from "./protocol";

export type OpenRequest = Commands["open"] & { program: string; scene: string; width: number; height: number };

export interface SessionHandlers {
  onStatus: () => void; // connection, worker, stage
  onOpened: (opened: Opened) => void;
  onState: (state: SessionState) => void;
  onDiagnostics: (diagnostics: readonly Diagnostic[], outdated: boolean) => void;
  onGraph: (graph: PipelineModel | null) => void;
  onImage: (image: ImageMessage) => void;
  onStatistics: (statistics: Statistics) => void;
  onRestarted: () => void;
  onReloaded: () => void;
  onPrinted: (lines: readonly PrintedLine[], omitted: number) => void;
  onMessage: (message: string, kind: "info" | "error") => void;
}

// Commands that are sent often, or that have no answer.
const kSilent: ReadonlySet<string> = new Set(["received", "restart", "orbit", "pan", "zoom", "fly", "endDrag"]);

// Events of a worker that has read the program: it no longer waits for a save.
const kOfRunningWorker: ReadonlySet<EventName> = new Set(["stage", "opened", "diagnostics", "reloaded"]);

// Events about the open program.
const kOfProgram: ReadonlySet<EventName> = new Set(["stage", "opened", "state", "diagnostics", "graph", "statistics", "restarted", "reloaded", "printed", "error"]);

export class Session {
  connection: ConnectionState = "connecting";
  connectionMessage = "";
  worker: { state: WorkerState; message: string; restarts: number } | undefined;
  // Why the worker waits.
  cause: { state: WorkerState; message: string } | undefined;
  stage = ""; // what the worker does before the first image
  failure = ""; // the render stopped
  opened: Opened | undefined;
  state: SessionState | undefined;
  hasImage = false; // of the open program
  private readonly link: Connection;
  private current: OpenRequest | undefined;
  private sets = new Map<string, ParameterValue>();
  private scheduled = false;
  private opens = 0; // number of the last `open`
  private opening = 0; // the one that the worker executes, or has executed
  private hidden = false; // the browser does not show the page
  private pausedWhileHidden = false; // the session continues when the page is shown

  constructor(private readonly handlers: SessionHandlers) {
    this.link = new Connection({
      onConnect: () => {
        if (this.current) void this.sendOpen(this.withState(this.current));
      },
      onState: (state, message) => {
        this.connection = state;
        this.connectionMessage = message;
        if (state !== "open") this.worker = undefined;
        handlers.onStatus();
      },
      onEvent: (event) => this.onEvent(event),
      onImage: (image) => {
        if (this.isStale) {
          this.send({ do: "received", image: image.number });
          return;
        }
        this.hasImage = true;
        this.stage = "";
        handlers.onImage(image);
      },
    });
  }

  connect(): void {
    this.link.connect();
  }

  // Opens a program with its defaults.
  open(request: OpenRequest): void {
    this.current = request;
    this.opened = undefined;
    this.state = undefined;
    this.hasImage = false;
    this.failure = "";
    this.stage = "starting";
    this.sets.clear();
    if (this.link.isOpen) void this.sendOpen(request);
    this.handlers.onStatus();
  }

  // Opens the same program again from its files, with the values that it shows now. Returns why that failed; undefined if
  // it succeeded.
  async reopen(changes: Partial<OpenRequest> = {}): Promise<string | undefined> {
    if (!this.current) return undefined;
    this.current = { ...this.current, ...changes };
    this.failure = "";
    return this.sendOpen({ ...this.withState(this.current), ...changes });
  }

  get request(): OpenRequest | undefined {
    return this.current;
  }

  // An error of the command becomes a message.
  send(command: Command): void {
    if (kSilent.has(command.do)) {
      this.link.send(command);
      return;
    }
    this.link.request(command, "done").catch((error: Error) => {
      // Otherwise the state of the session is shown already.
      if (this.link.isOpen && this.worker?.state === "started" && this.state) this.handlers.onMessage(error.message, "error");
    });
  }

  ask<K extends EventName>(command: Command, wanted: K): Promise<EventOf<K>> {
    return this.link.request(command, wanted);
  }

  askFile(command: Command): Promise<{ name: string; content: Blob }> {
    return this.link.requestFile(command);
  }

  // What `open` needs to show what this page shows; undefined before the first state.
  get currentRequest(): OpenRequest | undefined {
    return this.current && this.state && this.withState(this.current);
  }

  // Values of a slider that arrive within a frame of the screen become one command.
  setParameter(name: string, value: ParameterValue): void {
    if (this.state) this.state.parameters[name] = value;
    this.sets.set(name, value);
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame(() => {
      this.scheduled = false;
      for (const [parameter, latest] of this.sets) this.send({ do: "set", parameter, value: latest });
      this.sets.clear();
    });
  }

  // A hidden page does not render.
  setHidden(hidden: boolean): void {
    this.hidden = hidden;
    this.pauseIfHidden();
  }

  private pauseIfHidden(): void {
    if (!this.state || !this.link.isOpen) return;
    if (this.hidden && !this.state.paused && !this.state.still && !this.pausedWhileHidden) {
      this.pausedWhileHidden = true;
      this.send({ do: "pause", on: true });
    } else if (!this.hidden && this.pausedWhileHidden) {
      this.pausedWhileHidden = false;
      this.send({ do: "pause", on: false });
    }
  }

  private withState(request: OpenRequest): OpenRequest {
    const state = this.state;
    if (!state) return request;
    return {
      ...request,
      width: state.width,
      height: state.height,
      // A program that counts frames renders without end.
      ...(!state.frames && { samples: state.samples }),
      parameters: state.parameters,
      output: state.output,
      exposure: state.exposure,
      tonemap: state.tonemap,
      frame: state.frame,
      ...(state.camera && { camera: state.camera }),
    };
  }

  private async sendOpen(request: OpenRequest): Promise<string | undefined> {
    this.stage = "starting";
    this.handlers.onStatus();
    const generation = ++this.opens;
    try {
      await this.link.request({ do: "open", ...request, number: generation }, "done");
      return undefined;
    } catch (error) {
      if (generation !== this.opens) return undefined; // a later one replaces it
      // A lost connection and the end of the worker have states of their own.
      const running = this.link.isOpen && this.worker?.state !== "crashed" && this.worker?.state !== "hung";
      if (running) {
        this.failure = (error as Error).message;
        this.stage = "";
        this.handlers.onStatus();
      }
      return (error as Error).message;
    }
  }

  // What the worker sends is about a program that was open before.
  private get isStale(): boolean {
    return this.opening !== this.opens;
  }

  private onEvent(event: ServerEvent): void {
    const { handlers } = this;
    if (event.event === "opening") this.opening = event.number;
    if (this.worker?.state === "waiting" && kOfRunningWorker.has(event.event) && event.id === undefined) {
      this.worker = { ...this.worker, state: "started", message: "" };
      this.cause = undefined;
      handlers.onStatus();
    }
    if (this.isStale && kOfProgram.has(event.event) && event.id === undefined) return;
    switch (event.event) {
      case "worker":
        this.worker = { state: event.state, message: event.message, restarts: event.restarts };
        if (event.state === "crashed" || event.state === "hung") this.cause = { state: event.state, message: event.message };
        else if (event.state !== "waiting") this.cause = undefined;
        if (event.state === "started") {
          this.failure = "";
          this.pausedWhileHidden = false; // a new process
        }
        // It can start again before anyone sees the state.
        if (event.state === "crashed") handlers.onMessage(`The render process crashed: ${event.message}`, "error");
        handlers.onStatus();
        break;
      case "stage":
        this.stage = event.text;
        handlers.onStatus();
        break;
      case "opened":
        this.opened = event;
        this.failure = "";
        handlers.onOpened(event);
        break;
      case "state":
        this.state = event;
        handlers.onState(event);
        this.pauseIfHidden();
        break;
      case "diagnostics":
        handlers.onDiagnostics(event.diagnostics, event.outdated === true);
        break;
      case "graph":
        handlers.onGraph(event.graph);
        break;
      case "statistics":
        handlers.onStatistics(event);
        break;
      case "restarted":
        this.failure = "";
        handlers.onRestarted();
        break;
      case "reloaded":
        this.failure = "";
        handlers.onReloaded();
        break;
      case "printed":
        handlers.onPrinted(event.lines, event.omitted);
        break;
      case "deviceReplaced":
        handlers.onMessage(`The device was lost and opened again: ${event.message}`, "error");
        break;
      case "note":
        handlers.onMessage(event.message, "info");
        break;
      case "warning":
        handlers.onMessage(event.message, "error");
        break;
      case "error":
        if (event.id === undefined) {
          this.failure = event.message;
          handlers.onStatus();
        }
        break;
      default:
        break;
    }
  }
}
