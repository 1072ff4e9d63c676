// The page with a bench inside as one file, which opens from a disk too: build.mjs has put modules, their data,
// workers and the boards' firmware into elements of the page.

import { openPage } from "./in_page";

function within(id: string): string {
  return document.getElementById(id)!.textContent!;
}

/** A file of the folder, compressed within the page. */
async function file(name: string): Promise<Response> {
  const packed = Uint8Array.from(atob(within(name)), (byte) => byte.charCodeAt(0));
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip")));
}

function worker(name: string): Worker {
  return new Worker(URL.createObjectURL(new Blob([within(`${name}-worker`)], { type: "text/javascript" })));
}

openPage({ file, worker, docs: null }).catch(() => undefined); // the page has told it
