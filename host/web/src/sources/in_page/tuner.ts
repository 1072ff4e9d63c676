// The tuner inside the page: a worker of its own for each tuning.

import type { Model, Searched, Tuned, Tuner } from "../../session/services";
import type { FromTuner, ToTuner, TunerData } from "../../tuner/data";

/** The name of the arm that a page without a host has. */
export const DEFAULT_ARM = "default arm";

export type TunerParts = { readonly code: ArrayBuffer; readonly data: TunerData; readonly worker: Worker };

export class PageTuner implements Tuner {
  readonly promise = "GWO-WOA tries 500 sets of four controllers for greywhale's default arm, and begins with those that you see. It "
    + "searches as greywhale tune does, with the same costs on the same motions.";
  readonly limits = "It tunes at the board's usual period and limits; what you broke, loaded or changed on "
    + "the bench it does not know. Left out are: identification, as the arm's numbers are known here, and so the other arms that a "
    + "recording would allow; rivals for the last place; the report with its held-out motions; and the least error that a supply "
    + "allows. greywhale tune tries 2400 sets.";
  private worker: Worker | null = null;

  /** `parts` brings what a tuning needs, once one is asked for. */
  constructor(private readonly parts: () => Promise<TunerParts>) {}

  async tune(before: readonly (readonly number[])[], { name }: Model, heard: (searched: Searched) => void): Promise<Tuned> {
    if (name !== DEFAULT_ARM) {
      throw new Error(`This page tunes for the ${DEFAULT_ARM} alone: choose that as the model, or run greywhale tune ${name} on a computer.`);
    }
    const { code, data, worker } = await this.parts();
    this.worker = worker;
    try {
      return await new Promise((settle, fail) => {
        worker.addEventListener("message", ({ data: message }: MessageEvent<FromTuner>) => {
          if (message.kind === "searched") heard(searched(message));
          else if (message.kind === "tuned") settle(message.tuned);
          else if (message.kind === "failed") fail(new Error(`The tuner has ended: ${message.sentence}`));
        });
        worker.addEventListener("error", ({ message }) => fail(new Error(`The tuner does not start (${message || "its worker is refused"}).`)));
        this.tell({ kind: "begin", code, data });
        this.tell({ kind: "tune", before });
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

function searched({ evaluations, budget, cost, curve }: Extract<FromTuner, { kind: "searched" }>): Searched {
  const total = cost.reduce((sum, one) => sum + one, 0);
  return {
    share: evaluations / budget,
    words: `${evaluations} of ${budget} sets; the best cost together ${total.toFixed(2)}.`,
    curve: { unit: "sets", x: curve.map(([at]) => at), y: cost.map((_, joint) => curve.map(([, costs]) => costs[joint]!)) },
  };
}
