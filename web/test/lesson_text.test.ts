// SPDX-License-Identifier: Apache-2.0
// The lesson pages as the lab shows them.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { labText, withoutFooter } from "../src/lesson_text";

declare const REPOSITORY: string;

test("a comment replaces the block below it", () => {
  assert.equal(labText("One.\n\n<!-- lab: In the\nlab. -->\nTwo\nlines.\n\nThree.\n"), "One.\n\nIn the\nlab.\n\nThree.\n");
  assert.equal(labText("<!-- lab: A. -->\n\nLast."), "A.\n");
  assert.equal(labText("<!-- lab: -->\nOne.\n\n<!-- expect: Q002 -->\n\n    quintet run\n"), "\n\n<!-- expect: Q002 -->\n\n    quintet run\n");
});

test("no lesson sends the user of the lab to a file or a terminal without saying so", () => {
  let variants = 0;
  for (const name of readdirSync(`${REPOSITORY}/docs/lessons`)) {
    if (!/^\d\d_/.test(name)) continue;
    const page = readFileSync(`${REPOSITORY}/docs/lessons/${name}`, "utf8");
    variants += page.split("<!-- lab:").length - 1;
    const shown = labText(withoutFooter(page));
    assert.doesNotMatch(shown, /<!-- lab:/, name);
    // Commands are buttons; the rest is text.
    const prose = shown.replace(/```[\s\S]*?```/g, "").replace(/^ {4}.*$/gm, "").replace(/<!--[\s\S]*?-->/g, "");
    for (const [sentence] of prose.matchAll(/[^.:]*(?:`mine|--watch|--frames|--help|--set|-o |\.png`|pipeline\.svg|%04d|quintet run|[Oo]pen it in)[^.:]*/g)) assert.fail(`${name}: ${sentence}`);
    for (const [sentence] of prose.matchAll(/[^.:]*`quintet (?!check`)[^.:]*/g)) assert.match(sentence, /[Ii]n\s+a\s+terminal/, `${name}: ${sentence}`);
  }
  assert.ok(variants >= 25, `${variants}`);
});
