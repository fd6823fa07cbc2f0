// SPDX-License-Identifier: Apache-2.0
// Renders a video in a session of its own, so that the page stays usable: asks for frames, rate and format, shows the progress,
// and can be canceled.
import { Connection } from "./connection";
import { h } from "./dom";
import type { Opened, SessionState } from "./protocol";
import type { OpenRequest } from "./session";

export interface VideoRequest {
  frames: number;
  fps: number;
  format: "mp4" | "webm" | "gif";
  turn: boolean;
}

// What moves in a video of a session, by default.
export function videoMotion(state: SessionState, opened: Opened): "frames" | "animation" | "turn" {
  return state.frames ? "frames" : opened.animated ? "animation" : "turn";
}

// Frames of a scene's animation to its end; five seconds of anything else.
export function defaultFrames(state: SessionState, opened: Opened): number {
  return videoMotion(state, opened) === "animation" ? Math.max(2, Math.round(opened.lastFrame) + 1) : 120;
}

class VideoRender {
  private readonly link: Connection;
  private resolveStart: (() => void) | undefined;
  private rejectStart: ((error: Error) => void) | undefined;

  constructor(onProgress: (done: number, total: number) => void) {
    this.link = new Connection({
      onConnect: () => this.resolveStart?.(),
      onState: (state, message) => {
        if (state === "refused" || state === "full" || state === "lost") this.rejectStart?.(new Error(message || "The server does not answer"));
      },
      onEvent: (event) => {
        if (event.event === "progress") onProgress(event.done, event.total);
      },
      onImage: (image) => this.link.send({ do: "received", image: image.number }),
    });
  }

  async run(open: OpenRequest, video: VideoRequest): Promise<{ name: string; content: Blob }> {
    await new Promise<void>((resolve, reject) => {
      this.resolveStart = resolve;
      this.rejectStart = reject;
      this.link.connect();
    });
    await this.link.request({ do: "open", ...open, ...(video.turn ? {} : { frame: 0 }) }, "done");
    return this.link.requestFile({ do: "video", frames: video.frames, fps: video.fps, format: video.format, turn: video.turn });
  }

  // The server ends the process that renders.
  cancel(): void {
    this.link.close();
  }
}

// The dialog. Resolves when it is closed; `save` gets the video.
export function exportVideo(open: OpenRequest, state: SessionState, opened: Opened, save: (content: Blob, format: string) => void): Promise<void> {
  return new Promise((resolve) => {
    const motion = videoMotion(state, opened);
    const kinds = { frames: "The video shows the frames of the program, from frame 0.", animation: "The video shows the animation of the scene.", turn: "The camera turns once around the scene." };
    const number = (label: string, value: number, min: number, max: number, step: number | "any") => h("input", { type: "number", class: "number", "aria-label": label, value, min, max, step, required: true });
    const frames = number("Frames", defaultFrames(state, opened), 1, 10_000, 1);
    const fps = number("Frames per second", 24, 1, 240, "any");
    const format = h("select", { "aria-label": "Format" }, [["mp4", "MP4 (H.264)"], ["webm", "WebM (VP9)"], ["gif", "GIF"]].map(([value, label]) => h("option", { value }, label)));
    const size = h("p", { class: "note" }, `${state.width} × ${state.height} pixels${state.frames ? "" : `, ${state.samples} samples per pixel`}: change them under View.`);
    const progress = h("progress", { max: 1, value: 0, "aria-label": "Rendered frames", hidden: true });
    const message = h("p", { class: "video-message", role: "status" });
    const start = h("button", { type: "submit", class: "primary" }, "Render");
    const close = h("button", { type: "button", onclick: () => element.close() }, "Close");
    const fields = h("fieldset", {}, h("label", {}, "Frames ", frames), h("label", {}, "Frames per second ", fps), h("label", {}, "Format ", format));
    const form = h("form", { class: "dialog-body video-form" }, h("p", {}, kinds[motion]), fields, size, progress, message, h("div", { class: "dialog-buttons" }, close, start));
    const element = h("dialog", { class: "dialog", "aria-label": "Video" }, h("h2", {}, "Video"), form);
    let render: VideoRender | undefined;
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      fields.disabled = start.disabled = true;
      progress.hidden = false;
      progress.value = 0;
      message.classList.remove("failed");
      message.textContent = "Starting…";
      close.textContent = "Cancel";
      const startTime = performance.now();
      const own = new VideoRender((done, total) => {
        progress.value = done / total;
        const left = ((performance.now() - startTime) / 1000 / done) * (total - done);
        message.textContent = `${done} of ${total} frames${done > 2 ? `, about ${Math.ceil(left)} s left` : ""}`;
      });
      render = own;
      try {
        const video = { frames: frames.valueAsNumber, fps: fps.valueAsNumber, format: format.value as VideoRequest["format"], turn: motion === "turn" };
        const { content } = await own.run(open, video);
        save(content, video.format);
        message.textContent = "The video is complete.";
      } catch (error) {
        message.classList.add("failed");
        message.textContent = (error as Error).message;
      }
      own.cancel();
      fields.disabled = start.disabled = false;
      progress.hidden = true;
      close.textContent = "Close";
    });
    element.addEventListener("close", () => {
      render?.cancel();
      element.remove();
      resolve();
    });
    document.body.append(element);
    element.showModal();
  });
}
