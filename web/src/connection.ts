// SPDX-License-Identifier: Apache-2.0
// A WebSocket connection to a session: sends commands, dispatches events, and connects again after a loss. Its owner
// sends `open` each time `onConnect` is called.
import { type Command, type EventName, type EventOf, type FilePart, type ImageMessage, parseFilePart, parseImage, type ServerEvent } from "./protocol";

export type ConnectionState = "connecting" | "open" | "lost" | "refused" | "full";

export interface ConnectionHandlers {
  onConnect: () => void;
  onState: (state: ConnectionState, message: string) => void;
  onEvent: (event: ServerEvent) => void;
  onImage: (image: ImageMessage) => void;
}

interface Pending {
  resolve: (event: ServerEvent) => void;
  reject: (error: Error) => void;
  wanted: EventName;
  answer?: ServerEvent;
}

// Seconds between attempts.
const kDelays = [0.25, 0.5, 1, 2, 4];

export class Connection {
  private socket: WebSocket | undefined;
  private attempts = 0;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private nextId = 1;
  private closed = false;
  private readonly pending = new Map<number | string, Pending>();
  private files: Promise<unknown> = Promise.resolve(); // the last request of a file
  private part: { resolve: (part: FilePart) => void; reject: (error: Error) => void } | undefined; // that is awaited

  constructor(private readonly handlers: ConnectionHandlers) {}

  connect(): void {
    clearTimeout(this.timer);
    this.closed = false;
    this.socket?.close();
    this.handlers.onState(this.attempts === 0 ? "connecting" : "lost", "");
    const socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/ws`);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onopen = () => {
      this.attempts = 0;
      this.handlers.onState("open", "");
      this.handlers.onConnect();
    };
    socket.onmessage = (message: MessageEvent<string | ArrayBuffer>) => {
      if (socket !== this.socket) return;
      if (typeof message.data === "string") this.receive(JSON.parse(message.data) as ServerEvent);
      else {
        const image = parseImage(message.data);
        const part = parseFilePart(message.data);
        if (image) this.handlers.onImage(image);
        else if (part) this.part?.resolve(part);
      }
    };
    socket.onclose = (event) => {
      if (socket === this.socket) void this.onClose(event.code);
    };
  }

  close(): void {
    this.closed = true;
    clearTimeout(this.timer);
    this.socket?.close();
    this.rejectAll("The connection was closed");
  }

  get isOpen(): boolean {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  // Commands without a connection are lost; the next `open` has the state.
  send(command: Command): void {
    if (this.isOpen) this.socket!.send(JSON.stringify(command));
  }

  // Sends a command and returns the event that answers it; rejects with the message of its error.
  request<K extends EventName>(command: Command, wanted: K): Promise<EventOf<K>> {
    return new Promise((resolve, reject) => {
      if (!this.isOpen) {
        reject(new Error("The server does not answer"));
        return;
      }
      const id = this.nextId++;
      this.pending.set(id, { resolve: (event) => resolve(event as EventOf<K>), reject, wanted });
      this.send({ ...command, id });
    });
  }

  // Sends a command that makes a file, such as a video, and reads that file. A file replaces the one before, so that a second
  // request waits for the first.
  requestFile(command: Command): Promise<{ name: string; content: Blob }> {
    const run = () => this.readFile(command);
    const file = this.files.then(run, run);
    this.files = file;
    return file;
  }

  private async readFile(command: Command): Promise<{ name: string; content: Blob }> {
    const { file, name, type, size } = await this.request(command, "file");
    const parts: Uint8Array<ArrayBuffer>[] = [];
    for (let offset = 0; offset < size; ) {
      const part = await new Promise<FilePart>((resolve, reject) => {
        this.part = { resolve, reject };
        this.request({ do: "read", file, offset }, "done").catch(reject);
      });
      if (part.bytes.length === 0) throw new Error(`${name}: the file is shorter than expected`);
      parts.push(part.bytes);
      offset += part.bytes.length;
    }
    return { name, content: new Blob(parts, { type }) };
  }

  private receive(event: ServerEvent): void {
    const pending = event.id === undefined ? undefined : this.pending.get(event.id);
    if (pending && event.id !== undefined) {
      if (event.event === "error") {
        this.pending.delete(event.id);
        pending.reject(new Error(event.message));
        return;
      }
      if (event.event === pending.wanted) {
        this.pending.delete(event.id);
        pending.resolve(event);
      } else if (event.event === "done") {
        this.pending.delete(event.id);
        pending.reject(new Error("The command has no result"));
      }
    }
    // The process that would answer has ended.
    if (event.event === "worker" && (event.state === "crashed" || event.state === "hung")) this.rejectAll(event.message);
    this.handlers.onEvent(event);
  }

  private rejectAll(message: string): void {
    for (const pending of this.pending.values()) pending.reject(new Error(message));
    this.part?.reject(new Error(message));
    this.part = undefined;
    this.pending.clear();
  }

  private async onClose(code: number): Promise<void> {
    this.rejectAll("The connection to the server was lost");
    if (this.closed) return;
    if (code === 1013) {
      this.handlers.onState("full", "Too many sessions are open. Close another tab, then connect again");
      return;
    }
    const delay = kDelays[Math.min(this.attempts, kDelays.length - 1)]!;
    ++this.attempts;
    this.handlers.onState("lost", "");
    // A WebSocket does not say why it was refused.
    try {
      const response = await fetch("/api/project", { credentials: "same-origin", cache: "no-store" });
      if (response.status === 403) {
        this.handlers.onState("refused", "The server was started again with a new token. Open the address that it printed");
        return;
      }
    } catch {
      // Not reachable: try again.
    }
    if (!this.closed) this.timer = setTimeout(() => this.connect(), delay * 1000);
  }
}
