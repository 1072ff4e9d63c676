// The page with a bench inside as a folder of files: modules, their data and workers lie beside it.

import { openPage } from "./in_page";

const WORKERS = { bench: "worker.js", tuner: "tuner.js" };

async function file(name: string): Promise<Response> {
  const answer = await fetch(new URL(name, import.meta.url));
  if (!answer.ok) throw new Error(`${name} is missing beside this page (${answer.status})`);
  return answer;
}

const worker = (name: keyof typeof WORKERS): Worker => new Worker(new URL(WORKERS[name], import.meta.url), { type: "module" });

/** A browser offers this on a secure connection and on this machine. */
async function keepForOffline(): Promise<void> {
  if ("serviceWorker" in navigator) await navigator.serviceWorker.register(new URL("offline.js", document.baseURI));
}

openPage({ file, worker, docs: "docs/" }).then(keepForOffline).catch(() => undefined); // without it, the page needs the network each time
