// SPDX-License-Identifier: Apache-2.0
// What the image shows: scene, size, samples, exposure, tone map, camera, and the frame of an animated scene.
import { h, replace, setOptions } from "./dom";
import type { Command, Opened, SessionState, ToneMap } from "./protocol";

export interface ViewHost {
  send: (command: Command) => void;
  scene: (name: string) => void;
  upload: (files: readonly File[]) => void;
}

const kSizes: [number, number][] = [[320, 180], [480, 270], [640, 360], [800, 450], [960, 540], [1280, 720], [1920, 1080], [512, 512], [1024, 1024]];
const kSamples = [1, 4, 16, 64, 256, 1024, 4096, 16384];
const kToneMaps = ["default", "linear", "aces", "agx", "neutral"];

export class ViewPanel {
  readonly element = h("div", { class: "view-panel" });
  private readonly scene = h("select", { id: "view-scene" });
  private readonly size = h("select", { id: "view-size" });
  private readonly samples = h("select", { id: "view-samples" });
  private readonly tonemap = h("select", { id: "view-tonemap" }, kToneMaps.map((name) => h("option", { value: name }, name)));
  private readonly exposure = h("input", { id: "view-exposure", type: "range", min: -6, max: 6, step: 0.25, value: "0" });
  private readonly exposureText = h("output", { for: "view-exposure" }, "0");
  private readonly frame = h("input", { id: "view-frame", type: "range", min: 0, max: 1, step: 1, value: "0" });
  private readonly frameText = h("output", { for: "view-frame" }, "0");
  private readonly frameRow: HTMLElement;
  private readonly camera = h("select", { id: "view-camera" });
  private readonly fov = h("input", { id: "view-fov", type: "range", min: 5, max: 120, step: 1, value: "45" });
  private readonly fovText = h("output", { for: "view-fov" }, "45");
  private readonly fovRow: HTMLElement;
  private readonly cameraRow: HTMLElement;
  private readonly samplesRow: HTMLElement;
  private readonly note = h("p", { class: "note" });
  private scenes: readonly string[] = [];
  private sceneNow = "";
  private programScene = "";

  constructor(host: ViewHost) {
    const row = (label: string, id: string, ...controls: Node[]) => h("div", { class: "parameter" }, h("label", { for: id }, label), h("div", { class: "control" }, controls));
    const file = h("input", { type: "file", multiple: true, hidden: true, "aria-label": "Scene files" });
    file.addEventListener("change", () => {
      if (file.files?.length) host.upload([...file.files]);
      file.value = "";
    });
    this.scene.addEventListener("change", () => host.scene(this.scene.value));
    this.size.addEventListener("change", () => {
      const [width, height] = this.size.value.split("x").map(Number);
      host.send({ do: "size", width: width!, height: height! });
    });
    this.samples.addEventListener("change", () => host.send({ do: "samples", count: Number(this.samples.value) }));
    this.tonemap.addEventListener("change", () => host.send({ do: "tonemap", name: this.tonemap.value as ToneMap }));
    this.exposure.addEventListener("input", () => {
      this.exposureText.textContent = this.exposure.value;
      host.send({ do: "exposure", stops: this.exposure.valueAsNumber });
    });
    this.frame.addEventListener("input", () => {
      this.frameText.textContent = this.frame.value;
      host.send({ do: "time", frame: this.frame.valueAsNumber });
    });
    this.camera.addEventListener("change", () => host.send({ do: "camera", name: this.camera.value }));
    this.fov.addEventListener("input", () => {
      this.fovText.textContent = this.fov.value;
      host.send({ do: "lens", fov: this.fov.valueAsNumber });
    });
    for (const slider of [this.exposure, this.frame, this.fov]) slider.addEventListener("change", () => host.send({ do: "endDrag" }));
    this.frameRow = row("Scene frame", "view-frame", this.frame, this.frameText);
    this.cameraRow = row("Camera", "view-camera", this.camera, h("button", { type: "button", class: "small", title: "Show the whole scene (Home)", onclick: () => host.send({ do: "frame" }) }, "Whole scene"));
    this.fovRow = row("Field of view", "view-fov", this.fov, this.fovText);
    this.samplesRow = row("Samples", "view-samples", this.samples);
    replace(
      this.element,
      row("Scene", "view-scene", this.scene, h("button", { type: "button", class: "small", onclick: () => file.click() }, "Upload…"), file),
      this.note,
      row("Size", "view-size", this.size),
      this.samplesRow,
      this.cameraRow,
      this.fovRow,
      this.frameRow,
      row("Exposure", "view-exposure", this.exposure, this.exposureText),
      row("Tone map", "view-tonemap", this.tonemap),
    );
    this.note.textContent = "Drop glTF, .scene.toml or image files on the page to upload them.";
  }

  showScenes(scenes: readonly string[], current: string, ofProgram: string): void {
    this.scenes = scenes;
    this.sceneNow = current;
    this.programScene = ofProgram;
    const names = [...new Set([...this.scenes, ...(this.sceneNow ? [this.sceneNow] : [])])].filter((name) => name !== ofProgram).sort();
    const own = this.programScene ? `${this.programScene.replace(/^.*\//, "")} (of the program)` : "Default scene";
    setOptions(this.scene, [["", own], ...names.map((name) => [name, name] as const)]);
    this.scene.value = this.sceneNow === ofProgram ? "" : this.sceneNow;
  }

  showOpened(opened: Opened): void {
    this.frameRow.hidden = !opened.animated;
    this.frame.max = String(Math.max(1, Math.ceil(opened.lastFrame)));
    setOptions(this.camera, [["", "first"], ...opened.cameras.map((name) => [name, name] as const)]);
  }

  showState(state: SessionState, usesCamera: boolean): void {
    const key = `${state.width}x${state.height}`;
    const sizes = kSizes.some(([width, height]) => `${width}x${height}` === key) ? kSizes : [[state.width, state.height] as [number, number], ...kSizes];
    setOptions(this.size, sizes.map(([width, height]) => [`${width}x${height}`, `${width} × ${height}`]));
    this.size.value = key;
    const counts = kSamples.includes(state.samples) ? kSamples : [state.samples, ...kSamples].sort((a, b) => a - b);
    setOptions(this.samples, counts.map((count) => [String(count), String(count)]));
    this.samples.value = String(state.samples);
    this.samplesRow.hidden = state.frames;
    this.tonemap.value = state.tonemap;
    const unlessActive = (slider: HTMLInputElement, text: HTMLElement, value: number) => {
      if (document.activeElement === slider) return;
      slider.value = String(value);
      text.textContent = String(Math.round(value * 100) / 100);
    };
    unlessActive(this.exposure, this.exposureText, state.exposure);
    unlessActive(this.frame, this.frameText, state.frame);
    this.cameraRow.hidden = !usesCamera;
    this.fovRow.hidden = !usesCamera || state.camera === null;
    if (state.camera) unlessActive(this.fov, this.fovText, state.camera.fov);
  }
}
