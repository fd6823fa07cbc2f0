// SPDX-License-Identifier: Apache-2.0
// Modal dialogs and short messages, with the elements of the platform.
import { type Child, h } from "./dom";
import { icon } from "./icons";

export interface DialogButton<T> {
  label: string;
  value: T;
  primary?: boolean;
}

// Returns undefined if the user closes the dialog.
export function ask<T>(title: string, content: Child[], buttons: readonly DialogButton<T>[]): Promise<T | undefined> {
  return new Promise((resolve) => {
    let answer: T | undefined;
    const element = h(
      "dialog",
      { class: "dialog", "aria-label": title },
      h("h2", {}, title),
      h("div", { class: "dialog-body" }, content),
      h(
        "div",
        { class: "dialog-buttons" },
        buttons.map((button) =>
          h(
            "button",
            {
              type: "button",
              class: button.primary ? "primary" : "",
              autofocus: button.primary,
              onclick: () => {
                answer = button.value;
                element.close();
              },
            },
            button.label,
          ),
        ),
      ),
    );
    element.addEventListener("close", () => {
      element.remove();
      resolve(answer);
    });
    document.body.append(element);
    element.showModal();
  });
}

// A page beside the work: an explanation of a diagnostic, help. Escape closes it.
export function openSheet(title: string, content: Node): void {
  document.querySelector<HTMLDialogElement>("dialog.sheet")?.close();
  const close = h("button", { type: "button", class: "icon", "aria-label": "Close", onclick: () => element.close() }, icon("close"));
  const element = h("dialog", { class: "sheet", "aria-label": title }, h("header", {}, h("h2", {}, title), close), h("div", { class: "prose" }, content));
  element.addEventListener("close", () => element.remove());
  element.addEventListener("click", (event) => {
    if (event.target === element) element.close();
  });
  document.body.append(element);
  element.showModal();
}

// A message that disappears; errors stay until they are closed.
export function notify(text: string, kind: "info" | "error" = "info"): void {
  let area = document.querySelector<HTMLElement>(".toasts");
  if (!area) {
    area = h("div", { class: "toasts", role: "status", "aria-live": "polite" });
    document.body.append(area);
  }
  // A message that is still shown is not repeated.
  for (const shown of area.children) if (shown.firstElementChild?.textContent === text) shown.remove();
  const toast = h(
    "div",
    { class: `toast ${kind}`, role: kind === "error" ? "alert" : undefined },
    h("span", {}, text),
    h("button", { type: "button", class: "icon", "aria-label": "Close the message", onclick: () => toast.remove() }, icon("close")),
  );
  area.append(toast);
  while (area.childElementCount > 4) area.firstElementChild!.remove();
  if (kind === "info") setTimeout(() => toast.remove(), 4000);
}

// Removes a message that no longer holds.
export function withdraw(text: string): void {
  for (const shown of document.querySelectorAll(".toast")) if (shown.firstElementChild?.textContent === text) shown.remove();
}

export interface MenuItem {
  label: string;
  hint?: string;
  disabled?: boolean;
  run: () => void;
}

// A button that opens a menu with the keyboard pattern of WAI-ARIA.
export function menuButton(label: Child[], name: string, items: () => readonly MenuItem[]): HTMLElement {
  const button = h("button", { type: "button", class: "menu-button", "aria-haspopup": "menu", "aria-expanded": "false", "aria-label": name }, label);
  const root = h("div", { class: "menu-root" }, button);
  let menu: HTMLElement | undefined;
  const close = (focus: boolean) => {
    menu?.remove();
    menu = undefined;
    button.setAttribute("aria-expanded", "false");
    document.removeEventListener("pointerdown", outside, true);
    if (focus) button.focus();
  };
  const outside = (event: Event) => {
    if (!root.contains(event.target as Node)) close(false);
  };
  const open = () => {
    menu = h(
      "div",
      { class: "menu", role: "menu", "aria-label": name },
      items().map((item) =>
        h(
          "button",
          {
            type: "button",
            role: "menuitem",
            tabindex: -1,
            disabled: item.disabled,
            onclick: () => {
              close(true);
              item.run();
            },
          },
          h("span", {}, item.label),
          item.hint && h("span", { class: "hint" }, item.hint),
        ),
      ),
    );
    root.append(menu);
    const box = menu.getBoundingClientRect();
    if (box.right > innerWidth - 4) menu.classList.add("right");
    button.setAttribute("aria-expanded", "true");
    document.addEventListener("pointerdown", outside, true);
    menu.querySelector<HTMLElement>("button:not(:disabled)")?.focus();
  };
  button.addEventListener("click", () => (menu ? close(true) : open()));
  root.addEventListener("keydown", (event) => {
    if (!menu) {
      if (event.key === "ArrowDown" && event.target === button) {
        event.preventDefault();
        open();
      }
      return;
    }
    const entries = [...menu.querySelectorAll<HTMLButtonElement>("button:not(:disabled)")];
    const index = entries.indexOf(document.activeElement as HTMLButtonElement);
    if (event.key === "Escape") close(true);
    else if (event.key === "Tab") close(false);
    else if (event.key === "ArrowDown") entries[(index + 1) % entries.length]?.focus();
    else if (event.key === "ArrowUp") entries[(index + entries.length - 1) % entries.length]?.focus();
    else return;
    if (event.key !== "Tab") event.preventDefault();
    event.stopPropagation();
  });
  return root;
}
