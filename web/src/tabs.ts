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
    const hadFocus = this.element.contains(document.activeElement);
    this.tabs = tabs;
    this.current = selected;
    replace(
      this.element,
      tabs.map((tab) => {
        const active = tab.id === selected;
        const marks: Record<string, string> = { error: "has errors", warning: "has warnings", changed: "not saved" };
        return h(
          "button",
          {
            class: `tab${tab.mark ? ` ${tab.mark}` : ""}`,
            id: `${this.prefix}-${tab.id}`,
            role: "tab",
            type: "button",
            title: tab.hint,
            "aria-selected": String(active),
            "aria-controls": this.panel.id,
            tabindex: active ? 0 : -1,
            dataset: { tab: tab.id },
            onclick: () => this.select(tab.id),
          },
          tab.title,
          tab.badge !== undefined && h("span", { class: "badge" }, tab.badge),
          tab.mark && h("span", { class: "mark", role: "img", "aria-label": marks[tab.mark] }),
        );
      }),
    );
    this.panel.setAttribute("aria-labelledby", `${this.prefix}-${selected}`);
    if (hadFocus) this.element.querySelector<HTMLElement>("[aria-selected=true]")?.focus();
    this.element.querySelector<HTMLElement>("[aria-selected=true]")?.scrollIntoView({ block: "nearest", inline: "nearest" });
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
