// The tuner inside the page: a worker of its own for each tuning.

import type { Searched, Tuned, Tuner } from "../../session/services";
import type { FromTuner, ToTuner, TunerData } from "../../tuner/data";

export type TunerParts = { readonly code: ArrayBuffer; readonly data: TunerData; readonly worker: Worker };

export class PageTuner implements Tuner {
  private worker: Worker | null = null;

  /** `parts` brings what a tuning needs, once one is asked for. */
  constructor(private readonly parts: () => Promise<TunerParts>) {}

  async tune(before: readonly (readonly number[])[], heard: (searched: Searched) => void): Promise<Tuned> {
    const { code, data, worker } = await this.parts();
    this.worker = worker;
    try {
      return await new Promise((settle, fail) => {
        worker.addEventListener("message", ({ data: message }: MessageEvent<FromTuner>) => {
          if (message.kind === "searched") heard(message.searched);
          else if (message.kind === "tuned") settle(message.tuned);
          else fail(new Error(message.sentence));
        });
        worker.addEventListener("error", ({ message }) => fail(new Error(`The tuner does not start (${message || "its worker is refused"}).`)));
        this.tell({ kind: "tune", code, data, before });
      });
    } finally {
      worker.terminate();
      this.worker = null;
    }
  }

  stop(): void {
    this.tell({ kind: "stop" });
  }

  private tell(message: ToTuner): void {
    this.worker?.postMessage(message);
  }
}
