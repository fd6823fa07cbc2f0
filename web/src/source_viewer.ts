// SPDX-License-Identifier: Apache-2.0
// Shows a location of a source: in an editor, or read only if it is a file of the shader library; and the explanation page of
// a diagnostic.
import { api } from "./api";
import { notify, openSheet } from "./dialog";
import { h, replace } from "./dom";
import type { EditorArea } from "./editor_pane";
import { docsOptions } from "./lesson_panel";
import { renderMarkdown } from "./markdown";
import { colored, languageOf } from "./share";
import type { Workspace } from "./workspace";

function sourceListing(file: string, text: string, line: number): Node {
  const listing = h("pre", { class: "listing", tabindex: 0 });
  const lines: [string, string][][] = [[]];
  for (const [part, name] of colored(text, languageOf(file)))
    part.split("\n").forEach((piece, i) => {
      if (i > 0) lines.push([]);
      if (piece) lines[lines.length - 1]!.push([piece, name]);
    });
  replace(
    listing,
    lines.map((parts, i) => h("div", { class: i + 1 === line ? "current" : undefined }, h("span", { class: "line-number" }, i + 1), parts.map(([part, name]) => (name ? h("span", { class: `code-${name}` }, part) : part)))),
  );
  requestAnimationFrame(() => listing.querySelector(".current")?.scrollIntoView({ block: "center" }));
  return listing;
}

export class SourceViewer {
  private library: Map<string, string> | undefined;

  constructor(
    private readonly workspace: Workspace,
    private readonly editors: EditorArea,
  ) {}

  async open(file: string, line: number, column: number): Promise<void> {
    if (this.editors.open(file, line, column)) return;
    if (!file.startsWith("quintet/")) {
      notify(`${file} is not a file of the open program`);
      return;
    }
    try {
      this.library ??= new Map((await api.library()).map((entry) => [entry.path, entry.text]));
    } catch (error) {
      notify((error as Error).message, "error");
      return;
    }
    const text = this.library.get(file);
    if (text === undefined) notify(`${file} is not a file of the shader library`);
    else openSheet(`${file}, read only`, sourceListing(file, text, line));
  }

  openStage(file: string, kind: string): void {
    const found = this.workspace.locateStage(file, kind);
    if (found) this.editors.openDocument(found);
    else void this.open(file, 1, 0);
  }

  async explain(id: string): Promise<void> {
    try {
      const page = `diagnostics/${id}.md`;
      const text = await api.docs(page);
      const options = docsOptions(page, () => undefined, (other) => void this.explain(other));
      openSheet(id, renderMarkdown(text, { ...options, firstHeading: 3 }));
    } catch (error) {
      notify((error as Error).message, "error");
    }
  }
}
