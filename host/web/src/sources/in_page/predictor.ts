// Predicts inside the page, by the core that tunes: a worker that lives as long as the page, from the first question on.

import { armIn, type ArmNumbers } from "../../files/arm_file";
import type { NamedText } from "../../parts/named_text";
import type { Model, Prediction, Predictor } from "../../session/services";
import type { FromTuner, ToTuner } from "../../tuner/data";
import { DEFAULT_ARM, type TunerParts } from "./tuner";

type Asked = { settle(prediction: Prediction): void; fail(error: Error): void };

export class PagePredictor implements Predictor {
  private worker: Promise<Worker> | null = null;
  private readonly asked = new Map<number, Asked>();
  private count = 0;
  private readonly own = new Map<string, Model & { readonly numbers: ArmNumbers }>(); // by name
  readonly read?: (file: NamedText) => Model;

  /** `says` tells a person what the default arm is here; `takesFiles`: a person's own arm may take its place. */
  constructor(private readonly parts: () => Promise<TunerParts>, private readonly says: string, takesFiles = false) {
    if (takesFiles) this.read = (file) => this.take(file);
  }

  async models(): Promise<readonly Model[]> {
    return [{ name: DEFAULT_ARM, identified: false, says: this.says }, ...this.own.values()];
  }

  private take(file: NamedText): Model {
    const { identified, numbers } = armIn(file);
    const says = `${file.name} is the arm as ${identified ? "greywhale identify has found it" : "it is described there"}.`;
    const model = { name: file.name, identified, says, numbers };
    this.own.set(file.name, model);
    return model;
  }

  async predict(raw: readonly number[], board: number, { name }: Model): Promise<Prediction> {
    this.worker ??= this.start();
    const worker = await this.worker;
    const id = this.count++;
    return new Promise((settle, fail) => {
      this.asked.set(id, { settle, fail });
      tell(worker, { kind: "predict", id, raw, board, arm: this.own.get(name)?.numbers ?? null });
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
    tell(worker, { kind: "begin", code, data });
    return worker;
  }

  private failAll(why: string): void {
    for (const { fail } of this.asked.values()) fail(new Error(`Nothing is predicted: ${why}`));
    this.asked.clear();
  }
}

function tell(worker: Worker, message: ToTuner): void {
  worker.postMessage(message);
}
