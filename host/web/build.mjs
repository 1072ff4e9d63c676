// Bundles the page into the Python package (`npm run build`); the page with a bench inside into a folder (`npm run site
// FOLDER`), or into one file there (`npm run single FOLDER`); the tests, and runs them (`npm test`).
import { spawnSync } from "node:child_process";
import { copyFileSync, existsSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";
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

/** The page that a server hands out, and beside it the rules of a calibration, where tools/setup could compile them. */
async function buildServed(out) {
  await buildPage(out, { page: "src/entries/page.ts" });
  const rules = join(here, "../../build/web/calibration.wasm");
  if (existsSync(rules)) copyFileSync(rules, join(out, "calibration.wasm"));
}

const WORKERS = { worker: "src/sources/in_page/worker.ts", tuner: "src/tuner/worker.ts" };
const SITE = { page: "src/entries/site.ts", ...WORKERS, offline: "src/entries/service_worker.ts" };

/** One file that opens from a disk too, in a folder with the modules and their data. */
async function buildSingle(folder) {
  const bundle = (entry) => build({
    ...common, entryPoints: { page: entry }, outdir: folder, write: false, minify: true, format: "iife",
    loader: { ".svg": "dataurl" }, legalComments: "none",
  });
  const [page, bench, tuner] = await Promise.all(["src/entries/single.ts", WORKERS.worker, WORKERS.tuner].map(bundle));
  const text = ({ outputFiles }, kind) => outputFiles.find(({ path }) => path.endsWith(kind)).text;
  // Whatever is text stands within an element that ends at the next such tag.
  const element = (id, type, content) => `<script type="${type}" id="${id}">${content.replaceAll("</", "<\\/")}</script>\n`;
  const html = readFileSync(join(here, "src/index.html"), "utf8")
    .replace('<link rel="stylesheet" href="page.css">', () => `<style>${text(page, ".css")}</style>`)
    .replace('<script type="module" src="page.js"></script>\n', "")
    .replace("</body>", () => [
      ...["bench.wasm", "bench.json", "tuner.wasm", "tuner.json", "calibration.wasm", "mega.hex", "nano.hex"].map((name) =>
        element(name, "text/plain", gzipSync(readFileSync(join(folder, name))).toString("base64"))),
      ...Object.entries({ bench, tuner }).map(([name, worker]) => element(`${name}-worker`, "text/plain", text(worker, ".js"))),
      element("page", "text/javascript", text(page, ".js")),
      "</body>",
    ].join(""));
  writeFileSync(join(folder, "greywhale.html"), html);
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
  return spawnSync(process.execPath, ["--test", "--test-isolation=none", ...args, ...files], { stdio: "inherit" }).status ?? 1;
}

const [what, ...args] = process.argv.slice(2);
if (what === "test") process.exitCode = await runTests(join(here, "../../build/page-tests"), args);
else if (what === "site") await buildPage(resolve(args[0]), SITE);
else if (what === "single") await buildSingle(resolve(args[0]));
else await buildServed(what ?? join(here, "../src/greywhale/dashboard/page"));
