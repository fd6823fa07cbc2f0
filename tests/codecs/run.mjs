// SPDX-License-Identifier: Apache-2.0
// Compares Quintet's decoders with those of npm packages: node run.mjs UNIT_TESTS FOLDER
//
// Installs the packages of package-lock.json in FOLDER, encodes images and vertices with them, decodes the files with the
// reference decoders, and runs the unit tests that read the files (QUINTET_REFERENCE_FILES). Exit status 77 means skipped,
// because npm could not install the packages; with CI=true that is an error.
import { spawnSync } from "node:child_process";
import { copyFileSync, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import os from "node:os";
import path from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

const here = path.dirname(fileURLToPath(import.meta.url));
const [unitTests, folder] = process.argv.slice(2);

// Returns whether the packages are in `folder`.
function installPackages() {
  const lock = path.join(folder, "package-lock.json");
  const wanted = readFileSync(path.join(here, "package-lock.json"), "utf8");
  const installed = path.join(folder, "node_modules/.package-lock.json");
  if (existsSync(installed) && existsSync(lock) && readFileSync(lock, "utf8") === wanted) return true;
  mkdirSync(folder, { recursive: true });
  rmSync(path.join(folder, "node_modules"), { recursive: true, force: true });
  for (const name of ["package.json", "package-lock.json", ".npmrc"])
    copyFileSync(path.join(here, name), path.join(folder, name));
  const { status } = spawnSync("npm", ["ci", "--loglevel=error", "--fetch-retries=1"], { cwd: folder, stdio: "inherit" });
  if (status !== 0) rmSync(lock, { force: true });
  return status === 0;
}

if (!installPackages()) {
  console.log(`npm cannot install the packages of ${path.join(here, "package-lock.json")}; check the network and run the test again`);
  process.exit(process.env.CI === "true" ? 1 : 77);
}
copyFileSync(path.join(here, "generate.mjs"), path.join(folder, "generate.mjs"));  // beside its packages
const files = mkdtempSync(path.join(os.tmpdir(), "quintet-codecs-"));
try {
  const { generate } = await import(pathToFileURL(path.join(folder, "generate.mjs")));
  console.log(await generate(files));
  const { status } = spawnSync(unitTests, ["--gtest_filter=ReferenceDecoders.*"], {
    stdio: "inherit",
    env: { ...process.env, QUINTET_REFERENCE_FILES: files },
  });
  process.exitCode = status ?? 1;
} finally {
  rmSync(files, { recursive: true, force: true });
}
