// SPDX-License-Identifier: Apache-2.0
// The text of a lesson page as the lab shows it. A comment "lab: TEXT" replaces the block that follows it, up to an empty line, by
// TEXT: what the page says about the command line can differ from what the lab does.

export function labText(page: string): string {
  return page.replace(/<!-- lab:\s*([\s\S]*?)\s*-->\n+(?:(?:.*\S.*)(?:\n|$))+/g, (_, text: string) => `${text}\n`);
}

// The buttons below the tasks replace the links to other lessons.
export function withoutFooter(page: string): string {
  return page.replace(/\nPrograms?: [\s\S]*$/, "\n");
}
