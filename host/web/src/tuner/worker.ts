// The worker that tunes: it searches batch by batch, and between two of them hears whether it shall stop.

import { sentenceOf } from "../parts/sentence";
import type { FromTuner, ToTuner } from "./data";
import { TunerModule } from "./module";
import { Tuning } from "./tuning";

const page = globalThis as unknown as {
  postMessage(message: FromTuner): void;
  addEventListener(kind: "message", heard: (event: MessageEvent<ToTuner>) => void): void;
};
let stopped = false;

async function tune({ code, data, before }: Extract<ToTuner, { kind: "tune" }>): Promise<void> {
  const tuning = new Tuning(await TunerModule.load(code, data), data, before);
  for (const { evaluations, cost, curve } of tuning.run()) {
    page.postMessage({ kind: "searched", searched: { evaluations, budget: data.search.budget, cost, curve } });
    await new Promise((settle) => setTimeout(settle));
    if (stopped) break;
  }
  page.postMessage({ kind: "tuned", tuned: tuning.result() });
}

page.addEventListener("message", ({ data: message }) => {
  if (message.kind === "stop") stopped = true;
  else tune(message).catch((error: unknown) =>
    page.postMessage({ kind: "failed", sentence: `The tuner has ended: ${sentenceOf(error)}` }));
});
