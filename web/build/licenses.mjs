// SPDX-License-Identifier: Apache-2.0
// The license texts of the packages of which a bundle of esbuild contains code.
import { readFile, readdir } from "node:fs/promises";
import path from "node:path";

// The folder of the package that has this file, or null for a file of Quintet.
function packageFolder(file) {
  const match = /^(.*\/)?node_modules\/(@[^/]+\/)?[^/]+/.exec(file.replaceAll("\\", "/"));
  return match ? match[0] : null;
}

// Returns one text: for each package its name, version, license and license files. `inputs`: paths of the sources of the
// bundle, as esbuild's metafile names them, relative to `folder`. Throws if a package has no license file.
export async function licensesOf(inputs, folder) {
  // The bundler adds helper functions of its own.
  const folders = new Set(["node_modules/esbuild", ...inputs.map(packageFolder).filter(Boolean)]);
  const texts = [];
  for (const name of [...folders].sort()) {
    const root = path.resolve(folder, name);
    const { name: title, version, license } = JSON.parse(await readFile(path.join(root, "package.json"), "utf8"));
    const files = (await readdir(root)).filter((file) => /^(licen[cs]e|notice|copying)/i.test(file)).sort();
    if (files.length === 0) throw new Error(`the package ${title} has no license file, and the page contains its code`);
    const parts = await Promise.all(files.map((file) => readFile(path.join(root, file), "utf8")));
    texts.push(`${title} ${version} (npm${license ? `, ${license}` : ""})\n\n${parts.map((part) => part.trim()).join("\n\n")}\n`);
  }
  return texts.join(`\n${"-".repeat(80)}\n`);
}
