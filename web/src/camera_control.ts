// SPDX-License-Identifier: Apache-2.0
// Turns pointer, wheel and keys over the image into commands of navigation: orbit, pan, zoom and fly, as in the window. For
// a program with a camera of its own that has a parameter `eye`, dragging turns this point around the origin.
import type { Command, ParameterValue } from "./protocol";

export interface CameraHost {
  send: (command: Command) => void;
  // Pixels of the image per pixel of the screen.
  scale: () => number;
  // The scene's camera moves the image.
  usesCamera: () => boolean;
  // A parameter that is the position of the camera.
  eye: () => { name: string; value: [number, number, number] } | undefined;
  setParameter: (name: string, value: ParameterValue) => void;
  // Where in the image a pointer is, in pixels of the session.
  pixelAt: (event: MouseEvent) => { x: number; y: number } | undefined;
  pick: (x: number, y: number) => void; // a click
  focusAt: (x: number, y: number) => void; // a double click
  cannotMove: () => void;
}

const kDegreesPerPixel = 0.35;
const kClickDistance = 4; // pixels that a click may move
const kKeyDegrees = 4;
const kFlySpeed = 1.5; // meters per second
const kFlyKeys = new Set(["w", "a", "s", "d", "q", "e"]);

// Turns a point around the vertical axis through the origin, and up or down to 5 degrees from the poles.
export function orbitPoint(point: readonly [number, number, number], dx: number, dy: number): [number, number, number] {
  const [x, y, z] = point;
  const radius = Math.hypot(x, y, z);
  if (radius === 0) return [x, y, z];
  const limit = Math.PI / 2 - (5 * Math.PI) / 180;
  const turn = Math.atan2(x, z) + (dx * Math.PI) / 180;
  const lift = Math.asin(Math.max(-1, Math.min(1, y / radius))) + (dy * Math.PI) / 180;
  const up = Math.max(-limit, Math.min(limit, lift));
  const round = (value: number) => Math.round(value * 1e4) / 1e4;
  return [round(radius * Math.cos(up) * Math.sin(turn)), round(radius * Math.sin(up)), round(radius * Math.cos(up) * Math.cos(turn))];
}

export class CameraControl {
  private readonly pointers = new Map<number, { x: number; y: number }>();
  private mode: "orbit" | "pan" | "zoom" = "orbit";
  private moved = 0;
  private pending: Command | undefined; // sums of movements until the next frame
  private scheduled = false;
  private readonly keys = new Set<string>();
  private flying = false;
  private wheelEnd: ReturnType<typeof setTimeout> | undefined;
  private eyeNow: [number, number, number] | undefined;

  constructor(
    element: HTMLElement,
    private readonly host: CameraHost,
  ) {
    element.addEventListener("pointerdown", (event) => this.onDown(element, event));
    element.addEventListener("pointermove", (event) => this.onMove(event));
    const end = (event: PointerEvent) => this.onUp(event);
    element.addEventListener("pointerup", end);
    element.addEventListener("pointercancel", end);
    element.addEventListener("contextmenu", (event) => event.preventDefault());
    element.addEventListener("wheel", (event) => this.onWheel(event), { passive: false });
    element.addEventListener("dblclick", (event) => {
      const at = host.pixelAt(event);
      if (at && host.usesCamera()) host.focusAt(at.x, at.y);
    });
    element.addEventListener("keydown", (event) => this.onKey(event));
    element.addEventListener("keyup", (event) => this.keys.delete(event.key.toLowerCase()));
    element.addEventListener("blur", () => this.keys.clear());
  }

  private canMove(): boolean {
    return this.host.usesCamera() || this.host.eye() !== undefined;
  }

  private onDown(element: HTMLElement, event: PointerEvent): void {
    element.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (this.pointers.size === 1) {
      this.moved = 0;
      this.eyeNow = this.host.eye()?.value;
      this.mode = event.button === 1 || event.shiftKey ? "pan" : event.button === 2 ? "zoom" : "orbit";
    }
    if (event.button === 1) event.preventDefault();
  }

  private onMove(event: PointerEvent): void {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const dx = event.clientX - before.x;
    const dy = event.clientY - before.y;
    const spread = () => {
      const [a, b] = [...this.pointers.values()];
      return a && b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
    };
    const oldSpread = spread();
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    this.moved += Math.abs(dx) + Math.abs(dy);
    if (this.moved <= kClickDistance) return;
    if (!this.canMove()) {
      if (this.moved - Math.abs(dx) - Math.abs(dy) <= kClickDistance) this.host.cannotMove();
      return;
    }
    if (this.pointers.size === 2 && oldSpread > 0) {
      // Two fingers: their distance zooms, their movement pans.
      this.queue({ do: "zoom", factor: spread() / oldSpread });
      this.queue({ do: "pan", dx: (dx / 2) * this.host.scale(), dy: (dy / 2) * this.host.scale() });
    } else if (this.mode === "pan") this.queue({ do: "pan", dx: dx * this.host.scale(), dy: dy * this.host.scale() });
    else if (this.mode === "zoom") this.queue({ do: "zoom", factor: Math.exp(-dy * 0.006) });
    else this.queue({ do: "orbit", dx: -dx * kDegreesPerPixel, dy: dy * kDegreesPerPixel });
  }

  private onUp(event: PointerEvent): void {
    if (!this.pointers.delete(event.pointerId) || this.pointers.size > 0) return;
    if (event.type === "pointerup" && this.moved <= kClickDistance && event.button === 0) {
      const at = this.host.pixelAt(event);
      if (at) this.host.pick(at.x, at.y);
    } else if (this.moved > kClickDistance && this.canMove()) this.endDrag();
  }

  private onWheel(event: WheelEvent): void {
    if (!this.canMove()) return;
    event.preventDefault();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : event.deltaMode === WheelEvent.DOM_DELTA_PAGE ? 400 : 1;
    const at = this.host.pixelAt(event);
    this.eyeNow ??= this.host.eye()?.value;
    this.queue({ do: "zoom", factor: Math.exp(-event.deltaY * lines * 0.0012), ...(at && { x: at.x, y: at.y }) });
    clearTimeout(this.wheelEnd);
    this.wheelEnd = setTimeout(() => this.endDrag(), 300);
  }

  private onKey(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const key = event.key.toLowerCase();
    const step: Record<string, Command> = {
      arrowleft: { do: "orbit", dx: -kKeyDegrees, dy: 0 },
      arrowright: { do: "orbit", dx: kKeyDegrees, dy: 0 },
      arrowup: { do: "orbit", dx: 0, dy: kKeyDegrees },
      arrowdown: { do: "orbit", dx: 0, dy: -kKeyDegrees },
      "+": { do: "zoom", factor: 1.15 },
      "-": { do: "zoom", factor: 1 / 1.15 },
    };
    const command = step[key];
    if (command) {
      event.preventDefault();
      if (!this.canMove()) this.host.cannotMove();
      else {
        this.eyeNow = this.host.eye()?.value;
        this.queue(command);
      }
    } else if (kFlyKeys.has(key) && this.host.usesCamera()) {
      event.preventDefault();
      this.keys.add(key);
      this.fly(event.shiftKey ? 4 : 1);
    } else if (key === "home" && this.host.usesCamera()) {
      event.preventDefault();
      this.host.send({ do: "frame" });
    }
  }

  private fly(factor: number): void {
    if (this.flying) return;
    this.flying = true;
    let last = performance.now();
    const step = (now: number) => {
      const meters = kFlySpeed * factor * Math.min(0.1, (now - last) / 1000);
      last = now;
      if (this.keys.size === 0) {
        this.flying = false;
        this.endDrag();
        return;
      }
      const axis = (plus: string, minus: string) => meters * (Number(this.keys.has(plus)) - Number(this.keys.has(minus)));
      this.queue({ do: "fly", right: axis("d", "a"), up: axis("e", "q"), forward: axis("w", "s") });
      requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  // Movements of one frame of the screen become one command.
  private queue(command: Command): void {
    const pending = this.pending;
    if (pending && pending.do === command.do && pending.do !== "zoom") {
      const sums = pending as unknown as Record<string, unknown>;
      for (const [name, value] of Object.entries(command)) if (typeof value === "number") sums[name] = Number(sums[name] ?? 0) + value;
    } else if (pending && pending.do === "zoom" && command.do === "zoom") pending.factor = Number(pending.factor) * Number(command.factor);
    else {
      this.flush();
      this.pending = { ...command };
    }
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame(() => {
      this.scheduled = false;
      this.flush();
    });
  }

  private flush(): void {
    const command = this.pending;
    this.pending = undefined;
    if (!command) return;
    if (this.host.usesCamera()) {
      this.host.send(command);
      return;
    }
    const eye = this.host.eye();
    if (!eye) return;
    const from = this.eyeNow ?? eye.value;
    if (command.do === "orbit") this.eyeNow = orbitPoint(from, Number(command["dx"]), Number(command["dy"]));
    else if (command.do === "zoom") this.eyeNow = from.map((value) => Math.round((value / Number(command["factor"])) * 1e4) / 1e4) as [number, number, number];
    else return;
    this.host.setParameter(eye.name, this.eyeNow);
  }

  private endDrag(): void {
    this.flush();
    this.eyeNow = undefined;
    this.host.send({ do: "endDrag" });
  }
}
