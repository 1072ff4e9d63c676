// The page with a bench inside as one file, which opens from a disk too: build.mjs has put the module, its data and the
// worker into elements of the page.

import type { BenchData } from "./sources/in_page/bench_data";
import { openPage, type Parts } from "./in_page";

function within(id: string): string {
  return document.getElementById(id)!.textContent!;
}

async function parts(): Promise<Parts> {
  const code = Uint8Array.from(atob(within("bench-module")), (byte) => byte.charCodeAt(0)).buffer;
  const worker = new Worker(URL.createObjectURL(new Blob([within("bench-worker")], { type: "text/javascript" })));
  return { code, data: JSON.parse(within("bench-data")) as BenchData, worker };
}

openPage(parts());
