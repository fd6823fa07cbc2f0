// SPDX-License-Identifier: Apache-2.0
// What the menu "Share" and the button above the image download: the image, a video, a page, the program.
import { api } from "./api";
import { notify } from "./dialog";
import type { ImageView } from "./image_view";
import type { Session } from "./session";
import { download, sharedPage } from "./share";
import { exportVideo } from "./video_export";
import type { Workspace } from "./workspace";

function dataAddress(file: Blob): Promise<string> {
  return new Promise((resolve, reject) => {
    const reader = new FileReader();
    reader.onload = () => resolve(reader.result as string);
    reader.onerror = () => reject(reader.error ?? new Error("The image cannot be read"));
    reader.readAsDataURL(file);
  });
}

export class Downloads {
  private video = false; // its dialog is open

  constructor(
    private readonly session: Session,
    private readonly workspace: Workspace,
    private readonly image: ImageView,
    private readonly facts: { version: () => string; samples: () => number },
  ) {}

  // Without extension.
  get name(): string {
    return (this.workspace.program?.title ?? "image").replace(/^.*\//, "").replace(/\.rt\.glsl$/, "");
  }

  async saveImage(): Promise<void> {
    const file = await this.imageFile();
    if (file) download(file, `${this.name}.png`);
    else notify("There is no image yet", "error");
  }

  // 32-bit floats, without exposure and tone mapping, with the metadata of the render.
  async saveExr(): Promise<void> {
    try {
      const { name } = this;
      const { content } = await this.session.askFile({ do: "exr" });
      download(content, `${name}.exr`);
    } catch (error) {
      notify((error as Error).message, "error");
    }
  }

  async saveVideo(): Promise<void> {
    const { session } = this;
    if (this.video) return;
    this.video = true;
    try {
      await this.workspace.save();
      const open = session.currentRequest;
      const { name } = this;
      if (open && session.state && session.opened) await exportVideo(open, session.state, session.opened, (content, format) => download(content, `${name}.${format}`));
      else notify("The program does not render yet", "error");
    } finally {
      this.video = false;
    }
  }

  async savePage(): Promise<void> {
    const { session, workspace } = this;
    const state = session.state;
    const file = await this.imageFile();
    const image = file ? await dataAddress(file) : "";
    const program = workspace.program;
    if (!program) return notify("No program is open yet", "error");
    const samples = this.facts.samples();
    const text = sharedPage({
      title: program.title,
      version: this.facts.version(),
      scene: session.opened?.scene ?? "",
      device: session.opened?.device ?? "",
      output: state?.output ?? "",
      samples: state?.frames ? `${samples} frames` : `${samples} samples per pixel`,
      parameters: state?.parameters ?? {},
      image,
      width: state?.width ?? 0,
      height: state?.height ?? 0,
      files: workspace.files.map((source) => ({ path: source.path, text: workspace.textOf(source) })),
    });
    download(new Blob([text], { type: "text/html" }), `${this.name}.html`);
  }

  async saveProgram(form: "zip" | "lecture"): Promise<void> {
    const { program } = this.workspace;
    if (!program) return notify("No program is open yet", "error");
    try {
      await this.workspace.save();
      const file = await api.export(program.name, form);
      download(file, form === "zip" ? `${this.name}.zip` : `${this.name}.rt.glsl`);
    } catch (error) {
      notify((error as Error).message, "error");
    }
  }

  private async imageFile(): Promise<Blob | undefined> {
    if (!this.session.hasImage) return undefined;
    const latest = this.image.latest;
    // The file of the worker has the exact pixels.
    if (latest?.mime === "image/png") return new Blob([latest.file], { type: latest.mime });
    return new Promise((resolve) => this.image.canvas.toBlob((blob) => resolve(blob ?? undefined), "image/png"));
  }
}
