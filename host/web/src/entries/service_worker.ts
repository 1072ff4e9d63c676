// Lets the folder's page open without a network after the first visit. The page itself is asked of the network first, so
// that a new build shows at once; its parts lie in a folder that their digest names, and never change.

declare const PARTS: readonly string[]; // addresses in this worker's folder; tools/site puts them before this file
declare const BUILD: string; // folder of the parts

type Waiting = { waitUntil(done: Promise<unknown>): void };
type Asked = { readonly request: Request; respondWith(answer: Promise<Response>): void };

const worker = globalThis as unknown as {
  readonly registration: { readonly scope: string };
  readonly clients: { claim(): Promise<void> };
  skipWaiting(): Promise<void>;
  addEventListener(kind: "install" | "activate", heard: (event: Waiting) => void): void;
  addEventListener(kind: "fetch", heard: (event: Asked) => void): void;
};

const { scope } = worker.registration;
const OURS = `greywhale ${scope} `;
const CACHE = OURS + BUILD;
const PAGES = [scope, `${scope}index.html`];

worker.addEventListener("install", (event) => event.waitUntil(install()));
worker.addEventListener("activate", (event) => event.waitUntil(takeOver()));
worker.addEventListener("fetch", (event) => {
  if (event.request.method === "GET" && event.request.url.startsWith(scope)) event.respondWith(answer(event.request));
});

async function install(): Promise<void> {
  const cache = await caches.open(CACHE);
  await cache.addAll([...PAGES, ...PARTS].map((address) => new Request(address, { cache: "no-cache" })));
  await worker.skipWaiting();
}

/** Takes the page over, and removes what older builds have kept. */
async function takeOver(): Promise<void> {
  const old = (await caches.keys()).filter((name) => name.startsWith(OURS) && name !== CACHE);
  await Promise.all(old.map((name) => caches.delete(name)));
  await worker.clients.claim();
}

/** Answers from the cache, else from the network; a cache that the browser does not open, read or fill is none. */
async function answer(request: Request): Promise<Response> {
  const cache = await caches.open(CACHE).catch(() => null);
  const kept = await cache?.match(request, { ignoreSearch: true }).catch(() => undefined);
  if (kept && request.url.startsWith(`${scope}${BUILD}/`)) return kept;
  try {
    // A browser may take a page for fresh that is not: a server that says nothing about it lets it guess.
    const answered = await fetch(request.mode === "navigate" ? new Request(request.url, { cache: "no-cache", redirect: "manual" }) : request);
    const isPage = PAGES.includes(request.url.replace(/[?#].*/, "")); // this build's own is kept with its parts
    if (answered.status === 200 && !isPage) await cache?.put(request, answered.clone()).catch(() => undefined);
    return answered;
  } catch (error) {
    if (kept) return kept;
    throw error;
  }
}

export {};
