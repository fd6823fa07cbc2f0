// SPDX-License-Identifier: Apache-2.0
// A list of tabs with the keyboard pattern of WAI-ARIA: arrows, Home and End move between tabs.
import { h, replace, uniqueId } from "./dom";

export interface Tab {
  id: string;
  title: string;
  badge?: string; // "3", after the title
  mark?: "error" | "warning" | "changed";
  hint?: string;
}

export class TabList {
  readonly element: HTMLElement;
  private tabs: readonly Tab[] = [];
  private current = "";
  private buttons: HTMLButtonElement[] = [];
  private readonly prefix = uniqueId("tab");

  constructor(
    label: string,
    private readonly panel: HTMLElement,
    private readonly onSelect: (id: string) => void,
  ) {
    panel.id ||= uniqueId("panel");
    panel.setAttribute("role", "tabpanel");
    this.element = h("div", { class: "tabs", role: "tablist", "aria-label": label, onkeydown: (event: KeyboardEvent) => this.onKey(event) });
  }

  get selected(): string {
    return this.current;
  }

  show(tabs: readonly Tab[], selected: string): void {
    // The element of a tab that the user is pressing is not replaced.
    if (tabs.map((tab) => tab.id).join() !== this.tabs.map((tab) => tab.id).join()) {
      const hadFocus = this.element.contains(document.activeElement);
      this.buttons = tabs.map((tab) => h("button", { id: `${this.prefix}-${tab.id}`, role: "tab", type: "button", "aria-controls": this.panel.id, dataset: { tab: tab.id }, onclick: () => this.select(tab.id) }));
      replace(this.element, this.buttons);
      if (hadFocus) this.buttons[tabs.findIndex((tab) => tab.id === selected)]?.focus();
    }
    this.tabs = tabs;
    this.current = selected;
    tabs.forEach((tab, i) => this.update(this.buttons[i]!, tab));
    this.panel.setAttribute("aria-labelledby", `${this.prefix}-${selected}`);
    this.element.querySelector<HTMLElement>("[aria-selected=true]")?.scrollIntoView({ block: "nearest", inline: "nearest" });
  }

  private update(button: HTMLButtonElement, tab: Tab): void {
    const active = tab.id === this.current;
    const marks: Record<string, string> = { error: "has errors", warning: "has warnings", changed: "not saved" };
    button.className = `tab${tab.mark ? ` ${tab.mark}` : ""}`;
    button.title = tab.hint ?? "";
    button.setAttribute("aria-selected", String(active));
    button.tabIndex = active ? 0 : -1;
    replace(button, tab.title, tab.badge !== undefined && h("span", { class: "badge" }, tab.badge), tab.mark && h("span", { class: "mark", role: "img", "aria-label": marks[tab.mark] }));
  }

  private select(id: string): void {
    if (id !== this.current) {
      this.show(this.tabs, id);
      this.onSelect(id);
    }
  }

  private onKey(event: KeyboardEvent): void {
    const index = this.tabs.findIndex((tab) => tab.id === this.current);
    const count = this.tabs.length;
    const next: Record<string, number> = { ArrowRight: (index + 1) % count, ArrowLeft: (index + count - 1) % count, Home: 0, End: count - 1 };
    const target = next[event.key];
    if (target === undefined || count === 0) return;
    event.preventDefault();
    this.select(this.tabs[target]!.id);
    this.element.querySelector<HTMLElement>("[aria-selected=true]")?.focus();
  }
}
