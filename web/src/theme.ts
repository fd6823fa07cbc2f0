// SPDX-License-Identifier: Apache-2.0
// Light or dark: the preference of the system, until the user chooses one.
import { stored } from "./stored";

export type Theme = "light" | "dark";

const choice = stored<Theme | "system">("theme", "system");
const preference = matchMedia("(prefers-color-scheme: dark)");

export function currentTheme(): Theme {
  if (choice.value !== "system") return choice.value;
  return preference.matches ? "dark" : "light";
}

export function themeChoice(): Theme | "system" {
  return choice.value;
}

export function setThemeChoice(value: Theme | "system"): void {
  choice.value = value;
  apply();
}

function apply(): void {
  document.documentElement.dataset["theme"] = currentTheme();
}

export function initTheme(): void {
  preference.addEventListener("change", apply);
  apply();
}
