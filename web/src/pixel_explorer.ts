// SPDX-License-Identifier: Apache-2.0
// What is at a pixel: under the pointer (position, color, surface), and in the pixel panel (value, rays, prints).
import { notify } from "./dialog";
import { h } from "./dom";
import type { ImageView } from "./image_view";
import type { PixelFacts, PixelPanel } from "./pixel_panel";
import { formatValue } from "./ray_tree";
import type { Session } from "./session";

const kExplainedFrames = 300; // an explanation of a later frame has to be asked for
const kHoverDelay = 180; // ms of rest after which the surface under the pointer is read

export interface PixelExplorerHost {
  usesCamera: () => boolean;
  shownFrames: () => number; // of the image
  showPanel: () => void;
}

export class PixelExplorer {
  readonly hover = h("div", { class: "image-hover" });
  private pixel: { x: number; y: number } | undefined;
  private request = 0;
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(
    private readonly session: Session,
    private readonly image: ImageView,
    private readonly panel: PixelPanel,
    private readonly host: PixelExplorerHost,
  ) {
    image.stage.addEventListener("pointermove", (event) => this.onHover(event));
    image.stage.addEventListener("pointerleave", () => this.onLeave());
    image.stage.addEventListener("keydown", (event) => {
      const state = session.state;
      if (event.key !== "Enter" || !state) return;
      event.preventDefault();
      const at = this.pixel ?? { x: Math.floor(state.width / 2), y: Math.floor(state.height / 2) };
      void this.select(at.x, at.y);
    });
  }

  clear(): void {
    ++this.request;
    this.pixel = undefined;
    this.image.mark(undefined);
    this.panel.clear();
  }

  async select(x: number, y: number): Promise<void> {
    const { session, image, panel } = this;
    this.pixel = { x, y };
    image.mark(this.pixel);
    // The frame that is shown, unless rendering all frames before it takes long.
    const frames = this.host.shownFrames();
    if (session.state?.frames) panel.sampleNumber = frames <= kExplainedFrames ? Math.max(0, frames - 1) : 0;
    this.host.showPanel();
    if (panel.printing) this.print(true);
    const request = ++this.request;
    const facts: PixelFacts = { x, y };
    const displayed = image.displayedColor(x, y);
    if (displayed) facts.displayed = displayed;
    const show = () => {
      if (request === this.request) panel.showFacts(facts);
    };
    show();
    const value = session.ask({ do: "value", x, y }, "value").then((event) => ((facts.value = event.value), show()), () => undefined);
    const picked = this.host.usesCamera() ? session.ask({ do: "pick", x, y }, "picked").then((event) => ((facts.picked = event), show()), () => undefined) : undefined;
    await Promise.all([value, picked, this.explain(x, y, panel.sampleNumber)]);
  }

  async explain(x: number, y: number, sample: number): Promise<void> {
    const request = this.request;
    this.panel.say("Tracing the sample…");
    try {
      const event = await this.session.ask({ do: "explain", x, y, sample }, "explained");
      if (request === this.request) this.panel.showExplanation(event.explanation);
    } catch (error) {
      if (request === this.request) this.panel.say((error as Error).message);
    }
  }

  async focusAt(x: number, y: number): Promise<void> {
    try {
      const event = await this.session.ask({ do: "pick", x, y }, "picked");
      if (event.position) this.session.send({ do: "orbitCenter", point: event.position });
    } catch (error) {
      notify((error as Error).message, "error");
    }
  }

  print(on: boolean): void {
    if (on && this.pixel) this.session.send({ do: "print", x: this.pixel.x, y: this.pixel.y });
    else this.session.send({ do: "print", on: false });
  }

  private onHover(event: PointerEvent): void {
    clearTimeout(this.timer);
    if (event.buttons !== 0 || !this.session.hasImage) return;
    const at = this.image.pixelAt(event);
    if (!at) {
      this.onLeave();
      return;
    }
    const color = this.image.displayedColor(at.x, at.y);
    const text = `${at.x}, ${at.y}${color ? ` · ${color.join(" ")}` : ""}`;
    this.hover.textContent = text;
    if (!this.host.usesCamera() || this.session.worker?.state !== "started") return;
    this.timer = setTimeout(async () => {
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
    clearTimeout(this.timer);
    this.hover.textContent = "";
  }
}
