// SPDX-License-Identifier: Apache-2.0
// The questions of the workspace to the user.
import { ask } from "./dialog";
import { h } from "./dom";
import { validFolder } from "./program_chooser";
import { capitalized } from "./text";
import type { SourceFile } from "./workspace";

// The editor and the disk have changed the same lines.
export function askForVersion(file: SourceFile, disk: string): Promise<"mine" | "disk" | undefined> {
  return ask<"mine" | "disk">(
    `${file.path} was changed on disk`,
    [
      h("p", {}, "The same lines were changed here and by another program. Which version do you want to keep?"),
      h("details", {}, h("summary", {}, "Version on disk"), h("pre", { class: "conflict", tabindex: 0 }, disk)),
    ],
    [
      { label: "Load the version on disk", value: "disk" },
      { label: "Keep my version", value: "mine", primary: true },
    ],
  );
}

// A folder for the copy of a built-in program. `message`: why `proposal` cannot be used.
export async function askForFolder(proposal: string, message: string): Promise<string | undefined> {
  const input = h("input", { type: "text", value: proposal, "aria-label": "Folder" });
  const answer = await ask(
    "Copy the built-in program",
    [h("p", {}, `${capitalized(message)}. Choose a different folder for your copy.`), h("label", {}, "Folder ", input)],
    [
      { label: "Cancel", value: false },
      { label: "Copy", value: true, primary: true },
    ],
  );
  if (!answer) return undefined;
  if (validFolder(input.value)) return input.value;
  return askForFolder(proposal, "The name must consist of letters, digits, '_', '-' and '/'");
}
