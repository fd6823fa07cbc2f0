// SPDX-License-Identifier: Apache-2.0
// Tabs of editors, alone or as two panes side by side. A document is in one pane at a time.
import { EditorSelection } from "@codemirror/state";
import { EditorView } from "@codemirror/view";
import { openSearchPanel } from "@codemirror/search";
import { h } from "./dom";
import { icon, type IconName } from "./icons";
import { formatDocument } from "./source_format";
import { split } from "./splitter";
import { stored } from "./stored";
import { type Tab, TabList } from "./tabs";
import { type EditorDocument, isGlsl, type Workspace } from "./workspace";

class Pane {
  readonly body = h("div", { class: "editor-body" });
  readonly tabs: TabList;
  readonly element: HTMLElement;
  private view: EditorView | undefined;
  shown: EditorDocument | undefined;

  constructor(label: string, select: (id: string) => void, actions: HTMLElement) {
    this.tabs = new TabList(label, this.body, select);
    this.element = h("section", { class: "editor-pane", "aria-label": label }, h("div", { class: "bar" }, this.tabs.element, actions), this.body);
  }

  show(document: EditorDocument | undefined): void {
    if (this.shown === document && this.view) return;
    if (this.shown?.view === this.view && this.shown) this.shown.view = undefined;
    this.shown = document;
    if (!document) {
      this.view?.destroy();
      this.view = undefined;
      return;
    }
    if (this.view) this.view.setState(document.state);
    else this.view = new EditorView({ state: document.state, parent: this.body });
    document.view = this.view;
  }

  get editor(): EditorView | undefined {
    return this.view;
  }
}

export class EditorArea {
  readonly element: HTMLElement;
  private readonly panes: [Pane, Pane];
  private readonly layout;
  private readonly twoPanes = stored("editors.two", false);
  private active = 0;
  private readonly splitButton: HTMLButtonElement;

  constructor(private readonly workspace: Workspace) {
    const button = (name: IconName, label: string, title: string, run: () => void) => h("button", { type: "button", class: "icon", title, "aria-label": label, onclick: run }, icon(name));
    this.splitButton = button("columns", "Two editors", "Show two editors side by side", () => {
      this.twoPanes.value = !this.twoPanes.value;
      this.refresh();
    });
    this.splitButton.setAttribute("aria-pressed", "false");
    const actions = h(
      "div",
      { class: "actions" },
      button("find", "Find", "Find and replace (Ctrl+F)", () => this.withEditor((view) => openSearchPanel(view))),
      button("format", "Format", "Format the code (Shift+Alt+F)", () => this.withEditor((view, document) => void formatDocument(view, isGlsl(document.kind)))),
      this.splitButton,
    );
    this.panes = [new Pane("Editor", (id) => this.select(0, id), actions), new Pane("Second editor", (id) => this.select(1, id), h("span"))];
    this.panes.forEach((pane, i) => pane.element.addEventListener("focusin", () => (this.active = i)));
    this.layout = split(this.panes[0].element, this.panes[1].element, {
      name: "editors",
      label: "Width of the first editor",
      vertical: false,
      share: 0.5,
      minFirst: 160,
      minSecond: 160,
    });
    this.element = this.layout.element;
  }

  // Call it when documents, their titles or marks change.
  refresh(): void {
    const documents = this.workspace.documents;
    const two = this.twoPanes.value && documents.length > 1;
    for (const pane of this.panes) if (pane.shown && !documents.includes(pane.shown)) pane.show(undefined);
    const first = this.panes[0].shown ?? this.preferred(documents);
    let second = this.panes[1].shown;
    if (!two) second = undefined;
    else if (!second || second === first) second = documents.find((document) => document !== first && this.isCode(document)) ?? documents.find((document) => document !== first);
    this.panes[1].show(second);
    this.panes[0].show(first);
    this.layout.setHidden(false, !two);
    this.splitButton.setAttribute("aria-pressed", String(two));
    this.panes.forEach((pane) => pane.tabs.show(documents.map((document) => this.tabOf(document)), pane.shown?.id ?? ""));
  }

  // Shows a line of a file and moves the cursor there. Returns false if no editor has the file.
  open(path: string, line: number, column = 0): boolean {
    const found = this.workspace.locate(path, line);
    if (!found) return false;
    this.reveal(found.document);
    const view = found.document.view!;
    const at = view.state.doc.line(found.line);
    const position = column > 0 ? Math.min(at.to, at.from + column - 1) : at.from + (at.text.length - at.text.trimStart().length);
    view.dispatch({ selection: EditorSelection.cursor(position), effects: EditorView.scrollIntoView(position, { y: "center" }) });
    view.focus();
    return true;
  }

  openDocument(document: EditorDocument): void {
    this.reveal(document);
    document.view?.focus();
  }

  private reveal(document: EditorDocument): void {
    const pane = this.panes.findIndex((candidate) => candidate.shown === document);
    if (pane < 0) this.select(this.twoPanes.value ? this.active : 0, document.id);
  }

  private select(index: number, id: string): void {
    const document = this.workspace.documents.find((candidate) => candidate.id === id);
    if (!document) return;
    const pane = this.panes[index]!;
    const other = this.panes[1 - index]!;
    const before = pane.shown;
    if (other.shown === document) {
      // The two panes swap their documents.
      pane.show(undefined);
      other.show(undefined);
      other.show(before);
    }
    pane.show(document);
    this.refresh();
  }

  private withEditor(run: (view: EditorView, document: EditorDocument) => void): void {
    const pane = this.panes[this.twoPanes.value ? this.active : 0];
    const view = pane?.editor;
    if (!view || !pane.shown) return;
    view.focus();
    run(view, pane.shown);
  }

  private isCode(document: EditorDocument): boolean {
    return isGlsl(document.kind) && document.kind !== "common";
  }

  private preferred(documents: readonly EditorDocument[]): EditorDocument | undefined {
    return documents.find((document) => document.kind === "rgen") ?? documents.find((document) => this.isCode(document)) ?? documents[0];
  }

  private tabOf(document: EditorDocument): Tab {
    const { file } = document;
    const mark = document.marks === "error" ? "error" : document.marks === "warning" ? "warning" : file.status === "saved" || file.status === "saving" ? undefined : "changed";
    return { id: document.id, title: document.title, hint: file.path, ...(mark && { mark }) };
  }
}
