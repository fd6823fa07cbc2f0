// SPDX-License-Identifier: Apache-2.0
// Builds the page: dist/index.html, dist/lab.js, dist/lab.css, dist/licenses.txt. `--outdir FOLDER` writes elsewhere, `--watch` builds again
// after each save. The environment variable QUINTET_SOURCE names the repository if the script is not in it. The table of the shader library is generated from the headers and their documentation.
import * as esbuild from "esbuild";
import { copyFile, mkdir, readFile, rename, writeFile } from "node:fs/promises";
import { gzipSync } from "node:zlib";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { libraryTable } from "./library_table.mjs";
import { licensesOf } from "./licenses.mjs";

const web = path.dirname(path.dirname(fileURLToPath(import.meta.url)));
const root = process.env.QUINTET_SOURCE ?? path.dirname(web);  // the repository; the build works in a copy of web/
const args = process.argv.slice(2);
const outdirIndex = args.indexOf("--outdir");
const outdir = outdirIndex >= 0 ? path.resolve(args[outdirIndex + 1]) : path.join(web, "dist");

// Bytes of JavaScript after gzip that the page must not exceed.
const kBudget = 600_000;

// The module "generated:library" has the table.
const libraryPlugin = {
  name: "library",
  setup(build) {
    build.onResolve({ filter: /^generated:library$/ }, () => ({ path: "library", namespace: "generated" }));
    build.onLoad({ filter: /.*/, namespace: "generated" }, async () => ({
      contents: JSON.stringify(await libraryTable(root)),
      loader: "json",
      watchFiles: [path.join(root, "docs/glsl.md"), path.join(root, "docs/lecture-form.md")],
    }));
  },
};

const options = {
  entryPoints: { lab: path.join(web, "src/main.ts") },
  bundle: true,
  outdir,
  format: "iife",
  target: ["chrome110", "firefox110"],
  minify: !args.includes("--watch"),
  sourcemap: args.includes("--watch") ? "inline" : false,
  legalComments: "inline",
  charset: "utf8",
  logLevel: "warning",
  plugins: [libraryPlugin],
};

await mkdir(outdir, { recursive: true });
await copyFile(path.join(web, "src/index.html"), path.join(outdir, "index.html.new"));
await rename(path.join(outdir, "index.html.new"), path.join(outdir, "index.html"));
if (args.includes("--watch")) {
  const context = await esbuild.context(options);
  await context.watch();
} else {
  const { metafile } = await esbuild.build({ ...options, metafile: true, absWorkingDir: web });
  await writeFile(path.join(outdir, "licenses.txt"), await licensesOf(Object.keys(metafile.inputs), web));
  const size = gzipSync(await readFile(path.join(outdir, "lab.js")), { level: 9 }).length;
  if (size > kBudget) {
    console.error(`lab.js: ${size} bytes after gzip exceed the limit of ${kBudget}`);
    process.exit(1);
  }
  await writeFile(path.join(outdir, "size.txt"), `${size}\n`);
  if (args.includes("--verbose")) console.log(`lab.js: ${size} bytes after gzip`);
}
