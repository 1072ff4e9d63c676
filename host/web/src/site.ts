// The page with a bench inside as a folder of files: the module, its data and the worker lie beside it.

import type { BenchData } from "./sources/in_page/bench_data";
import { openPage, type Parts } from "./in_page";

async function fetched(file: string): Promise<Response> {
  const answer = await fetch(new URL(file, import.meta.url));
  if (!answer.ok) throw new Error(`${file} is missing beside this page (${answer.status})`);
  return answer;
}

async function parts(): Promise<Parts> {
  const worker = new Worker(new URL("worker.js", import.meta.url), { type: "module" });
  const [code, data] = await Promise.all([
    fetched("bench.wasm").then((answer) => answer.arrayBuffer()),
    fetched("bench.json").then((answer) => answer.json() as Promise<BenchData>),
  ]);
  return { code, data, worker };
}

openPage(parts());
