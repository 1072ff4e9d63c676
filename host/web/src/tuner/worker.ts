// The worker that tunes and predicts: it searches batch by batch, and between two of them hears whether it shall stop.

import { sentenceOf } from "../parts/sentence";
import type { Controllers, FromTuner, ToTuner, TunerData } from "./data";
import { TunerModule } from "./module";
import { Foresight } from "./prediction";
import { Tuning } from "./tuning";

type Core = { readonly module: TunerModule; readonly data: TunerData; readonly foresight: Foresight };

const page = globalThis as unknown as {
  postMessage(message: FromTuner): void;
  addEventListener(kind: "message", heard: (event: MessageEvent<ToTuner>) => void): void;
};
let core: Promise<Core> | null = null;
let stopped = false;

async function begin(code: ArrayBuffer, data: TunerData): Promise<Core> {
  const module = await TunerModule.load(code, data);
  return { module, data, foresight: new Foresight(module, data.predicted) };
}

async function tune({ module, data }: Core, before: Controllers): Promise<void> {
  const tuning = new Tuning(module, data, before);
  for (const { evaluations, cost, curve } of tuning.run()) {
    page.postMessage({ kind: "searched", evaluations, budget: data.search.budget, cost, curve });
    await new Promise((settle) => setTimeout(settle));
    if (stopped) break;
  }
  page.postMessage({ kind: "tuned", tuned: tuning.result() });
}

async function hear(message: ToTuner): Promise<void> {
  if (message.kind === "begin") core = begin(message.code, message.data);
  if (message.kind === "stop") stopped = true;
  const ready = await core!;
  if (message.kind === "tune") await tune(ready, message.before);
  if (message.kind === "predict") {
    const { id, raw, board, arm } = message;
    page.postMessage({ kind: "predicted", id, prediction: ready.foresight.predict(raw, board, arm) });
  }
}

page.addEventListener("message", ({ data: message }) =>
  void hear(message).catch((error: unknown) => page.postMessage({ kind: "failed", sentence: sentenceOf(error) })));
