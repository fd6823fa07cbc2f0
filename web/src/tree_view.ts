// SPDX-License-Identifier: Apache-2.0
// A tree with the keyboard pattern of WAI-ARIA: arrows move and open, Enter activates.
import { h, replace } from "./dom";

export interface TreeItem {
  head: Node[];
  detail: Node | undefined; // shown below the head while the item is open
  children: TreeItem[];
  open: boolean;
  activate?: () => void;
}

export class TreeView {
  readonly element: HTMLElement;

  constructor(label: string) {
    this.element = h("ul", { class: "tree", role: "tree", "aria-label": label, onkeydown: (event: KeyboardEvent) => this.onKey(event) });
  }

  show(items: readonly TreeItem[]): void {
    replace(this.element, items.map((item) => this.build(item, 1)));
    const first = this.element.querySelector<HTMLElement>("[role=treeitem]");
    if (first) first.tabIndex = 0;
  }

  private build(item: TreeItem, level: number): HTMLElement {
    const canOpen = item.children.length > 0 || item.detail !== undefined;
    const element = h(
      "li",
      { role: "treeitem", tabindex: -1, "aria-level": level, "aria-expanded": canOpen ? String(item.open) : undefined },
      h("div", { class: "tree-head" }, h("span", { class: "twist", "aria-hidden": "true" }), h("span", { class: "tree-text" }, item.head)),
      item.detail && h("div", { class: "tree-detail" }, item.detail),
      item.children.length > 0 && h("ul", { role: "group" }, item.children.map((child) => this.build(child, level + 1))),
    );
    const head = element.firstElementChild as HTMLElement;
    (head.firstElementChild as HTMLElement).addEventListener("click", (event) => {
      event.stopPropagation();
      this.toggle(element);
      this.focus(element);
    });
    head.addEventListener("click", () => {
      this.focus(element);
      if (item.activate) item.activate();
      else this.toggle(element);
    });
    head.addEventListener("dblclick", () => this.toggle(element));
    activations.set(element, item);
    return element;
  }

  private toggle(element: HTMLElement, open = element.getAttribute("aria-expanded") !== "true"): void {
    if (element.hasAttribute("aria-expanded")) element.setAttribute("aria-expanded", String(open));
  }

  private focus(element: HTMLElement): void {
    for (const other of this.element.querySelectorAll<HTMLElement>("[role=treeitem][tabindex='0']")) other.tabIndex = -1;
    element.tabIndex = 0;
    element.focus();
  }

  private visible(): HTMLElement[] {
    return [...this.element.querySelectorAll<HTMLElement>("[role=treeitem]")].filter((element) => element.offsetParent !== null);
  }

  private onKey(event: KeyboardEvent): void {
    const element = (event.target as HTMLElement).closest<HTMLElement>("[role=treeitem]");
    if (!element) return;
    const items = this.visible();
    const index = items.indexOf(element);
    const expanded = element.getAttribute("aria-expanded");
    const move = (to: HTMLElement | undefined | null) => to && this.focus(to);
    switch (event.key) {
      case "ArrowDown":
        move(items[index + 1]);
        break;
      case "ArrowUp":
        move(items[index - 1]);
        break;
      case "Home":
        move(items[0]);
        break;
      case "End":
        move(items[items.length - 1]);
        break;
      case "ArrowRight":
        if (expanded === "false") this.toggle(element, true);
        else move(element.querySelector<HTMLElement>("[role=treeitem]"));
        break;
      case "ArrowLeft":
        if (expanded === "true") this.toggle(element, false);
        else move(element.parentElement?.closest<HTMLElement>("[role=treeitem]"));
        break;
      case "Enter":
        activations.get(element)?.activate?.();
        break;
      case " ":
        this.toggle(element);
        break;
      default:
        return;
    }
    event.preventDefault();
    event.stopPropagation();
  }
}

const activations = new WeakMap<HTMLElement, TreeItem>();
