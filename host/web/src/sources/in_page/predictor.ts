// Predicts inside the page, by the core that tunes: a worker that lives as long as the page, from the first question on.

import type { Model, Prediction, Predictor } from "../../session/services";
import type { FromTuner } from "../../tuner/data";
import type { TunerParts } from "./tuner";

type Asked = { settle(prediction: Prediction): void; fail(error: Error): void };

export class PagePredictor implements Predictor {
  private worker: Promise<Worker> | null = null;
  private readonly asked = new Map<number, Asked>();
  private count = 0;

  /** `says` tells a person what the default arm is here. */
  constructor(private readonly parts: () => Promise<TunerParts>, private readonly says: string) {}

  async models(): Promise<readonly Model[]> {
    return [{ name: "default arm", identified: false, says: this.says }];
  }

  async predict(raw: readonly number[], board: number): Promise<Prediction> {
    this.worker ??= this.start();
    const worker = await this.worker;
    const id = this.count++;
    return new Promise((settle, fail) => {
      this.asked.set(id, { settle, fail });
      worker.postMessage({ kind: "predict", id, raw, board });
    });
  }

  private async start(): Promise<Worker> {
    const { code, data, worker } = await this.parts();
    worker.addEventListener("message", ({ data: message }: MessageEvent<FromTuner>) => {
      if (message.kind === "predicted") {
        this.asked.get(message.id)?.settle(message.prediction);
        this.asked.delete(message.id);
      } else if (message.kind === "failed") {
        this.failAll(message.sentence);
      }
    });
    worker.addEventListener("error", ({ message }) => this.failAll(message || "its worker is refused"));
    worker.postMessage({ kind: "begin", code, data });
    return worker;
  }

  private failAll(why: string): void {
    for (const { fail } of this.asked.values()) fail(new Error(`Nothing is predicted: ${why}`));
    this.asked.clear();
  }
}
