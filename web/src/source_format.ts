// SPDX-License-Identifier: Apache-2.0
// Formats the text of an editor: GLSL by clang-format where the server has it, everything else by the indentation of the
// editor. A message says which.
import type { EditorView } from "@codemirror/view";
import { api, type ApiError } from "./api";
import { notify } from "./dialog";
import { indentDocument } from "./editor_setup";
import { minimalChange } from "./text_merge";

export async function formatDocument(view: EditorView, isGlsl: boolean): Promise<void> {
  if (view.state.readOnly) return;
  if (!isGlsl) {
    indentDocument(view);
    return;
  }
  const document = view.state.doc;
  const text = document.toString();
  try {
    const { text: formatted, formatter } = await api.format(text);
    if (view.state.doc !== document) return; // it was edited in the meantime
    // The editor shows no blank lines at its end.
    const change = minimalChange(text, formatted.replace(/\n+$/, ""));
    if (change) view.dispatch({ changes: change, userEvent: "format" });
    notify(change ? `Formatted by ${formatter}` : `Already formatted (${formatter})`);
  } catch (error) {
    if (view.state.doc !== document) return;
    indentDocument(view);
    notify((error as ApiError).status === 501 ? "Indented only: clang-format is not installed on the machine of the server" : `Indented only: ${(error as Error).message}`);
  }
}
