// The page with a bench inside as a folder of files: modules, their data and workers lie beside it.

import type { BenchData } from "../sources/in_page/messages";
import type { TunerData } from "../tuner/data";
import { openPage, type Parts } from "./in_page";
import type { NamedText } from "../parts/named_text";

async function fetched(file: string): Promise<Response> {
  const answer = await fetch(new URL(file, import.meta.url));
  if (!answer.ok) throw new Error(`${file} is missing beside this page (${answer.status})`);
  return answer;
}

const worker = (file: string): Worker => new Worker(new URL(file, import.meta.url), { type: "module" });

async function module<Data>(name: string): Promise<{ code: ArrayBuffer; data: Data }> {
  const [code, data] = await Promise.all([
    fetched(`${name}.wasm`).then((answer) => answer.arrayBuffer()),
    fetched(`${name}.json`).then((answer) => answer.json() as Promise<Data>),
  ]);
  return { code, data };
}

async function calibration(): Promise<ArrayBuffer> {
  return (await fetched("calibration.wasm")).arrayBuffer();
}

async function firmware(board: string): Promise<NamedText> {
  const name = `${board}.hex`;
  return { name, text: await (await fetched(name)).text() };
}

async function parts(): Promise<Parts> {
  const bench = worker("worker.js"); // starts while its module is on the way
  return {
    worker: bench, ...await module<BenchData>("bench"),
    tuner: async () => ({ worker: worker("tuner.js"), ...await module<TunerData>("tuner") }), calibration, firmware, docs: "docs/",
  };
}

/** A browser offers this on a secure connection and on this machine. */
async function keepForOffline(): Promise<void> {
  if ("serviceWorker" in navigator) await navigator.serviceWorker.register(new URL("offline.js", document.baseURI));
}

const all = parts();
openPage(all);
all.then(keepForOffline).catch(() => undefined); // without it, the page needs the network each time
