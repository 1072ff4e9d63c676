// The page with a bench inside as one file, which opens from a disk too: build.mjs has put modules, their data and
// workers into elements of the page.

import type { BenchData } from "./sources/in_page/bench_data";
import type { TunerData } from "./tuner/data";
import { openPage, type Parts } from "./in_page";
import type { NamedText } from "./port";

function within(id: string): string {
  return document.getElementById(id)!.textContent!;
}

function module<Data>(name: string): { code: ArrayBuffer; data: Data; worker: Worker } {
  const code = Uint8Array.from(atob(within(`${name}-module`)), (byte) => byte.charCodeAt(0)).buffer;
  const worker = new Worker(URL.createObjectURL(new Blob([within(`${name}-worker`)], { type: "text/javascript" })));
  return { code, data: JSON.parse(within(`${name}-data`)) as Data, worker };
}

async function parts(): Promise<Parts> {
  const firmware = async (board: string): Promise<NamedText> => ({ name: `${board}.hex`, text: within(`firmware-${board}`) });
  return { ...module<BenchData>("bench"), tuner: async () => module<TunerData>("tuner"), firmware, docs: null };
}

openPage(parts());
