// The page with a bench inside as one file, which opens from a disk too: build.mjs has put modules, their data,
// workers and the boards' firmware into elements of the page.

import type { BenchData } from "../sources/in_page/messages";
import type { TunerData } from "../tuner/data";
import { openPage, type Parts } from "./in_page";
import type { NamedText } from "../parts/named_text";

function within(id: string): string {
  return document.getElementById(id)!.textContent!;
}

/** A file of the folder, compressed within the page. */
function file(name: string): Response {
  const packed = Uint8Array.from(atob(within(name)), (byte) => byte.charCodeAt(0));
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip")));
}

async function module<Data>(name: string): Promise<{ code: ArrayBuffer; data: Data; worker: Worker }> {
  const worker = new Worker(URL.createObjectURL(new Blob([within(`${name}-worker`)], { type: "text/javascript" })));
  const [code, data] = await Promise.all([file(`${name}.wasm`).arrayBuffer(), file(`${name}.json`).json() as Promise<Data>]);
  return { code, data, worker };
}

async function calibration(): Promise<ArrayBuffer> {
  return file("calibration.wasm").arrayBuffer();
}

async function firmware(board: string): Promise<NamedText> {
  const name = `${board}.hex`;
  return { name, text: await file(name).text() };
}

async function parts(): Promise<Parts> {
  return { ...await module<BenchData>("bench"), tuner: () => module<TunerData>("tuner"), calibration, firmware, docs: null };
}

openPage(parts());
