// SPDX-License-Identifier: Apache-2.0
// The live image: decodes the files of the worker, shows them at the size of the panel or pixel by pixel, and marks the
// selected pixel.
import { h } from "./dom";
import type { ImageMessage } from "./protocol";

export class ImageView {
  readonly canvas = h("canvas", { class: "image", width: 640, height: 360 });
  // Receives pointer and keys.
  readonly stage: HTMLElement;
  readonly element: HTMLElement;
  // Its pixels are read back for the pixel under the pointer.
  private readonly context = this.canvas.getContext("2d", { willReadFrequently: true })!;
  private readonly marker = h("div", { class: "pixel-marker", hidden: true });
  private readonly overlay = h("div", { class: "image-overlay", hidden: true, role: "status" });
  private size = { width: 640, height: 360 }; // of the session
  private newest = 0;
  private session = 0; // counts calls of reset()
  private shown = 0; // images
  private pixel: { x: number; y: number } | undefined;
  latest: ImageMessage | undefined;

  constructor(private readonly received: (image: number) => void) {
    this.stage = h(
      "div",
      {
        class: "image-stage",
        tabindex: 0,
        role: "application",
        "aria-roledescription": "rendered image",
        "aria-label": "Rendered image. Arrow keys turn the camera, plus and minus zoom, W A S D E Q fly, Home shows the whole scene, Enter explains the pixel in the middle.",
      },
      this.canvas,
      this.marker,
    );
    this.element = h("div", { class: "image-view" }, this.stage, this.overlay);
    new ResizeObserver(() => this.layout()).observe(this.element);
  }

  setSize(width: number, height: number): void {
    this.size = { width, height };
    this.layout();
  }

  // Images of a new session can start with number 1. Those of the one before are not shown any more, also if they are being
  // decoded.
  reset(): void {
    this.newest = 0;
    ++this.session;
  }

  async show(image: ImageMessage): Promise<void> {
    const session = this.session;
    let bitmap: ImageBitmap;
    try {
      bitmap = await createImageBitmap(new Blob([image.file], { type: image.mime }), { colorSpaceConversion: "none" });
    } catch {
      this.received(image.number);
      return;
    }
    // Decoding takes different times; an older image must not replace a newer one.
    if (image.number > this.newest && session === this.session) {
      this.newest = image.number;
      this.latest = image;
      if (this.canvas.width !== bitmap.width || this.canvas.height !== bitmap.height) {
        this.canvas.width = bitmap.width;
        this.canvas.height = bitmap.height;
      }
      this.context.drawImage(bitmap, 0, 0);
      this.layout();
      // For tests.
      this.canvas.dataset["shown"] = String(++this.shown);
      this.canvas.dataset["samples"] = String(image.samples);
      this.canvas.dataset["state"] = image.complete ? "complete" : image.mime === "image/png" ? "at rest" : "moving";
    }
    bitmap.close();
    this.received(image.number);
  }

  // A message over the image; empty hides it. `dim`: the image does not show the current program; `blank`: there is none.
  setOverlay(content: Node | string, dim: boolean, blank = false): void {
    const empty = content === "";
    this.overlay.hidden = empty;
    this.overlay.replaceChildren(content);
    this.stage.classList.toggle("dim", dim);
    this.stage.classList.toggle("blank", blank);
  }

  mark(pixel: { x: number; y: number } | undefined): void {
    this.pixel = pixel;
    this.layout();
  }

  pixelAt(event: MouseEvent): { x: number; y: number } | undefined {
    const box = this.canvas.getBoundingClientRect();
    const x = Math.floor(((event.clientX - box.left) / box.width) * this.size.width);
    const y = Math.floor(((event.clientY - box.top) / box.height) * this.size.height);
    return x >= 0 && y >= 0 && x < this.size.width && y < this.size.height ? { x, y } : undefined;
  }

  // Pixels of the session per pixel of the screen.
  get scale(): number {
    return this.size.width / Math.max(1, this.canvas.getBoundingClientRect().width);
  }

  // Color of a pixel as displayed, 0 to 255.
  displayedColor(x: number, y: number): [number, number, number] | undefined {
    const factor = this.canvas.width / this.size.width;
    const data = this.context.getImageData(Math.floor(x * factor), Math.floor(y * factor), 1, 1).data;
    return [data[0]!, data[1]!, data[2]!];
  }

  private layout(): void {
    const { clientWidth, clientHeight } = this.element;
    if (clientWidth === 0 || clientHeight === 0) return;
    const fit = Math.min(clientWidth / this.size.width, clientHeight / this.size.height);
    // Above its own size, whole factors keep pixels sharp if little space is lost.
    const scale = fit >= 2 && Math.floor(fit) / fit > 0.9 ? Math.floor(fit) : fit;
    const width = Math.round(this.size.width * scale);
    const height = Math.round(this.size.height * scale);
    this.canvas.style.width = `${width}px`;
    this.canvas.style.height = `${height}px`;
    this.canvas.classList.toggle("pixelated", this.canvas.width * 3 <= width);
    this.marker.hidden = this.pixel === undefined;
    if (this.pixel) {
      this.marker.style.left = `${((this.pixel.x + 0.5) / this.size.width) * 100}%`;
      this.marker.style.top = `${((this.pixel.y + 0.5) / this.size.height) * 100}%`;
    }
  }
}
