// SPDX-License-Identifier: Apache-2.0
// Bundles the unit tests of the page (test/*.test.ts) and runs them with node's test runner.
import * as esbuild from "esbuild";
import { mkdtemp, readdir, rm } from "node:fs/promises";
import { spawnSync } from "node:child_process";
import { tmpdir } from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { libraryTable } from "./library_table.mjs";

const web = path.dirname(path.dirname(fileURLToPath(import.meta.url)));
const root = process.env.QUINTET_SOURCE ?? path.dirname(web);  // the repository; the build works in a copy of web/
const folder = await mkdtemp(path.join(tmpdir(), "quintet-lab-test-"));
const tests = (await readdir(path.join(web, "test"))).filter((name) => name.endsWith(".test.ts"));
const table = await libraryTable(root);
await esbuild.build({
  entryPoints: tests.map((name) => path.join(web, "test", name)),
  bundle: true,
  outdir: folder,
  outExtension: { ".js": ".mjs" },
  format: "esm",
  platform: "node",
  target: "node18",
  logLevel: "warning",
  define: { REPOSITORY: JSON.stringify(root), WEB: JSON.stringify(web) },
  plugins: [
    {
      name: "library",
      setup(build) {
        build.onResolve({ filter: /^generated:library$/ }, () => ({ path: "library", namespace: "generated" }));
        build.onLoad({ filter: /.*/, namespace: "generated" }, () => ({ contents: JSON.stringify(table), loader: "json" }));
      },
    },
  ],
});
const files = tests.map((name) => path.join(folder, name.replace(/\.ts$/, ".mjs")));
const result = spawnSync(process.execPath, ["--test", ...files], { stdio: "inherit" });
await rm(folder, { recursive: true, force: true });
process.exit(result.status ?? 1);
