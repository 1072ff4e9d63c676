// Starts code in WebAssembly; of a browser that has none or forbids it, a sentence tells.

import { sentenceOf } from "./sentence";

export type Exports = { readonly memory: WebAssembly.Memory } & Readonly<Record<string, (...given: number[]) => number>>;

/** The exports of a module without files, not yet initialised. `what` is made of it, as a sentence names that. */
export async function startCode(code: BufferSource, what: string): Promise<Exports> {
  const refuse = (): never => {
    throw new Error(`${what} asked for a file`);
  };
  const files = { fd_close: refuse, fd_seek: refuse, fd_write: refuse };
  try {
    return (await WebAssembly.instantiate(code, { wasi_snapshot_preview1: files })).instance.exports as unknown as Exports;
  } catch (error) {
    throw new Error(`This browser does not run WebAssembly, of which ${what} is made (${sentenceOf(error)}); allow it for this page, or take another browser.`);
  }
}
