// SPDX-License-Identifier: Apache-2.0
// The controls above the image (output, frames, undo, download) and the line of facts below it.
import { h, replace, setOptions } from "./dom";
import { icon, type IconName } from "./icons";
import type { OutputDescription, SessionState, Statistics } from "./protocol";
import type { Session } from "./session";

export function raysText(rate: number): string {
  for (const [factor, unit] of [[1e9, "G"], [1e6, "M"], [1e3, "k"]] as const) if (rate >= factor) return `${(rate / factor).toPrecision(3)} ${unit}`;
  return rate.toFixed(0);
}

export function percentText(value: number): string {
  const percent = 100 * value;
  return `${percent >= 10 ? percent.toFixed(0) : percent.toPrecision(2)} %`;
}

// "Frame 0 · all frames are equal · 640 × 360" if only one is rendered; "12 of 64 samples · 3.4 M rays/s · error ≤ 2 % · 640 × 360", or "Frame 12 · 24 frames/s · 640 × 360": programs that count
// frames do not count rays.
export function factsText(state: SessionState, samples: number, statistics: Statistics | undefined): string {
  if (state.frames && state.still) return `Frame 0 · all frames are equal · ${state.width} × ${state.height}`;
  const parts = [state.frames ? `Frame ${Math.max(0, samples - 1)}` : `${samples} of ${state.samples} samples`];
  if (state.frames && statistics && statistics.seconds > 0) parts.push(`${Number((statistics.samples / statistics.seconds).toPrecision(2))} frames/s`);
  if (statistics && statistics.raysPerSecond > 0) parts.push(`${raysText(statistics.raysPerSecond)} rays/s`);
  if (typeof statistics?.error === "number" && !state.frames) parts.push(`error ≤ ${percentText(statistics.error)}`);
  parts.push(`${state.width} × ${state.height}`);
  if (state.paused) parts.push("paused");
  return parts.join(" · ");
}

export class ImageBar {
  readonly element: HTMLElement;
  readonly facts = h("div", { class: "image-facts" });
  statistics: Statistics | undefined;
  samples = 0; // of the image: per pixel, or frames
  private readonly output = h("select", { "aria-label": "Output", title: "Output or heat map" });
  private readonly play: HTMLButtonElement;
  private readonly step: HTMLButtonElement;
  private readonly first: HTMLButtonElement;
  private readonly undo: HTMLButtonElement;
  private readonly redo: HTMLButtonElement;

  constructor(
    private readonly session: Session,
    download: () => void,
  ) {
    const button = (name: IconName | undefined, label: string, run: () => void) =>
      h("button", { type: "button", class: "icon", title: label, "aria-label": label, onclick: run }, name && icon(name));
    this.play = button(undefined, "Play frames", () => {
      const state = session.state;
      if (state) session.send({ do: "pause", on: !state.paused });
    });
    this.step = button("next", "Next frame", () => session.send({ do: "advance", frames: 1 }));
    this.first = button("first", "First frame", () => session.send({ do: "rewind" }));
    this.undo = button("undo", "Undo a change of camera or parameters", () => session.send({ do: "undo" }));
    this.redo = button("redo", "Redo a change of camera or parameters", () => session.send({ do: "redo" }));
    this.output.addEventListener("change", () => session.send({ do: "output", name: this.output.value }));
    this.element = h(
      "div",
      { class: "bar image-bar" },
      h("div", { class: "actions" }, this.output, this.first, this.play, this.step),
      h("div", { class: "actions" }, this.undo, this.redo, button("download", "Download the image", download)),
    );
    this.clear();
  }

  // Before the session has opened a program.
  clear(): void {
    this.statistics = undefined;
    this.samples = 0;
    this.undo.disabled = this.redo.disabled = true;
    setOptions(this.output, []);
  }

  showOutputs(outputs: readonly OutputDescription[]): void {
    setOptions(this.output, outputs.map((output) => [output.name, output.kind === "heat" ? `${output.name} (heat map)` : output.name, output.help]));
  }

  showState(state: SessionState): void {
    if (document.activeElement !== this.output) this.output.value = state.output;
    this.undo.disabled = !state.canUndo;
    this.redo.disabled = !state.canRedo;
    this.showFacts();
  }

  showFacts(): void {
    const state = this.session.state;
    const plays = state?.frames === true && !state.still;
    this.step.hidden = this.first.hidden = !plays;
    this.output.hidden = this.output.options.length === 0;
    this.play.hidden = !state || (state.frames && !plays);
    const playing = state?.paused === false;
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
    replace(this.facts, factsText(state, this.samples, this.statistics));
    if (state.frames) this.facts.style.removeProperty("--progress");
    else this.facts.style.setProperty("--progress", String(Math.min(1, this.samples / Math.max(1, state.samples))));
  }
}
