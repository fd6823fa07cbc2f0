// SPDX-License-Identifier: Apache-2.0
// Files of the user that become files of the project: programs, scenes, environments and images. Nothing is overwritten
// without a question.
import { api, type ApiError, type Copied } from "./api";
import { ask, notify } from "./dialog";
import { h } from "./dom";
import type { Workspace } from "./workspace";

export interface UploadHost {
  workspace: Workspace;
  openProgram: (name: string) => Promise<void>;
  setScene: (path: string) => Promise<void>;
  setEnvironment: (path: string) => Promise<void>;
  changed: () => void; // the project has other files
}

const fileName = (file: File) => file.name.replace(/[^\w.-]+/g, "_").replace(/^\.+/, "");

export class Uploads {
  constructor(private readonly host: UploadHost) {}

  // A lecture file, a program of the GSN Composer, or a zip file.
  async importProgram(file: File): Promise<void> {
    const zip = /\.zip$/i.test(file.name);
    const name = file.name.replace(/(\.rt)?\.(glsl|txt|zip)$/i, "").replace(/[^\w-]+/g, "_") || "imported";
    await this.importTo(file, name, zip, false);
  }

  // Scenes become the scene of the session, environment maps its environment; programs are opened.
  async upload(files: readonly File[]): Promise<void> {
    const program = files.find((file) => /\.(rt\.glsl|zip)$/i.test(file.name));
    if (program) {
      await this.importProgram(program);
      return;
    }
    const paths: string[] = [];
    for (const file of files) {
      const path = `uploads/${fileName(file)}`;
      if (await this.put(path, file)) paths.push(path);
    }
    if (paths.length === 0) return;
    this.host.changed();
    const scene = paths.find((path) => /\.(glb|gltf|scene\.toml)$/i.test(path));
    const environment = paths.find((path) => /\.(hdr|exr)$/i.test(path));
    if (scene) await this.host.setScene(scene);
    else if (environment) await this.host.setEnvironment(environment);
    else notify(`Uploaded: ${paths.join(", ")}`);
  }

  // An image for a parameter, beside the program. Returns its path in the project.
  async uploadImage(file: File): Promise<string | undefined> {
    const { workspace } = this.host;
    if (!(await workspace.ensureCopy())) return undefined;
    const path = workspace.program!.main.replace(/[^/]*$/, "") + fileName(file);
    if (!(await this.put(path, file))) return undefined;
    this.host.changed();
    return path;
  }

  private async importTo(file: File, folder: string, zip: boolean, replaceFiles: boolean): Promise<void> {
    let copy: Copied;
    try {
      copy = await api.import(folder, zip ? file : await file.text(), zip ? "application/zip" : "text/plain", replaceFiles);
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
      return;
    }
    await this.host.openProgram(copy.name);
    this.host.changed();
  }

  // Returns whether the project has the file now.
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
}
