// Bundles the page into the Python package (`npm run build`), the page with a bench inside into a folder (`npm run site
// FOLDER`), or the tests and runs them (`npm test`).
import { spawnSync } from "node:child_process";
import { copyFileSync, mkdirSync, readdirSync, rmSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const common = { bundle: true, target: "es2022", logLevel: "warning", absWorkingDir: here };

async function buildPage(out, entryPoints) {
  rmSync(out, { recursive: true, force: true });
  mkdirSync(out, { recursive: true });
  await build({
    ...common,
    entryPoints,
    outdir: out,
    format: "esm",
    splitting: true,
    minify: true,
    chunkNames: "[name]-[hash]",
    loader: { ".svg": "file" },
    assetNames: "[name]",
    legalComments: "eof",
  });
  copyFileSync(join(here, "src/index.html"), join(out, "index.html"));
}

async function runTests(out, args) {
  rmSync(out, { recursive: true, force: true });
  const tests = readdirSync(join(here, "test")).filter((name) => name.endsWith(".test.ts"));
  await build({
    ...common,
    entryPoints: tests.map((name) => `test/${name}`),
    outdir: out,
    platform: "node",
    format: "esm",
    outExtension: { ".js": ".mjs" },
  });
  const files = tests.map((name) => join(out, name.replace(/ts$/, "mjs")));
  return spawnSync(process.execPath, ["--test", ...args, ...files], { stdio: "inherit" }).status ?? 1;
}

const [what, ...args] = process.argv.slice(2);
if (what === "test") process.exitCode = await runTests(join(here, "../../build/page-tests"), args);
else if (what === "site") await buildPage(resolve(args[0]), { page: "src/try.ts", worker: "src/sources/in_page/worker.ts" });
else await buildPage(what ?? join(here, "../src/greywhale/dashboard/page"), { page: "src/page.ts" });
