// A board inside the page, in a worker of its own, with the bench around it.

import type { Board, BoardListener } from "../../board";
import type { BenchControls, BenchWish, Bench as BenchActions } from "../../host";
import { encodeFrame } from "../../link/frames";
import { StopRequest } from "../../link/schema";
import type { BenchData } from "./bench_data";
import { keepEeprom, keptEeprom } from "./eeprom";
import { SPEED } from "./life";
import type { FromBench, ToBench } from "./messages";

const PORT = "firmware and arm in this page, no cycle timing";
const RESTARTED = "The board restarted, and its motors are off.";
const UNPOWERED = "The board has no power.";
const UNKEPT = "This browser has no room to keep what the board stores; it ends with this page.";

export class PageBoard implements Board, BenchActions {
  private listener: BoardListener | null = null;
  private readonly wishes = new Map<number, (error: string | null) => void>();
  private wished = 0;
  private readonly sizes: { supply: number; load: number; speed: number };
  private keptSentence = ""; // of what the browser had kept; told once the board is there
  private unkeptTold = false;

  /** `worker` runs worker.ts, `code` is the module, `storage` the browser's own. */
  constructor(
    private readonly worker: Worker, private readonly code: ArrayBuffer, private readonly data: BenchData,
    private readonly storage: () => Storage,
  ) {
    this.sizes = { supply: data.supply.value, load: data.load.value, speed: SPEED.value };
    worker.addEventListener("message", ({ data: message }: MessageEvent<FromBench>) => this.heard(message));
    worker.addEventListener("error", ({ message }) => this.failed(`The bench does not start: ${message}; reload the page.`));
    document.addEventListener("visibilitychange", () => this.showVisible());
  }

  listen(listener: BoardListener): void {
    this.listener = listener;
    const kept = keptEeprom(this.storage);
    this.tell({ kind: "start", code: this.code, data: this.data, eeprom: kept.content });
    this.showVisible();
    this.keptSentence = kept.sentence;
  }

  private tell(message: ToBench): void {
    this.worker.postMessage(message);
  }

  private showVisible(): void {
    this.tell({ kind: "visible", on: document.visibilityState === "visible" });
  }

  private heard(message: FromBench): void {
    switch (message.kind) {
      case "ready":
        this.listener?.link({ open: true, port: PORT, sentence: "" });
        if (this.keptSentence) this.listener?.refused(0, 0, this.keptSentence);
        this.drive();
        break;
      case "bytes":
        this.listener?.bytes(message.data);
        this.tell({ kind: "taken", count: message.data.length });
        break;
      case "restarted":
        this.listener?.link({ open: true, port: PORT, sentence: RESTARTED });
        break;
      case "eeprom":
        if (!keepEeprom(this.storage, message.content) && !this.unkeptTold) {
          this.unkeptTold = true;
          this.listener?.refused(0, 0, UNKEPT);
        }
        break;
      case "done":
        this.wishes.get(message.id)?.(message.error);
        this.wishes.delete(message.id);
        break;
      case "failed":
        this.failed(message.sentence);
        break;
    }
  }

  private failed(sentence: string): void {
    for (const settle of this.wishes.values()) settle(sentence);
    this.wishes.clear();
    this.listener?.driver({ you: false, free: false, verb: null });
    this.listener?.link({ open: false, port: "", sentence });
  }

  send(frame: Uint8Array): void {
    this.tell({ kind: "send", frame });
  }

  drive(): void {
    this.listener?.driver({ you: true, free: true, verb: null });
  }

  /** Motors that run for this page go off. */
  release(): void {
    this.send(encodeFrame(StopRequest.type, 0, new Uint8Array()));
    this.listener?.driver({ you: false, free: true, verb: null });
  }

  /** Nobody keeps samples from before: there is none. */
  async history(): Promise<Uint8Array> {
    return new Uint8Array();
  }

  async controls(): Promise<BenchControls> {
    const { leader, supply, load, faults } = this.data;
    return {
      leader,
      faults: faults.map(({ name, description, places }) => ({ name, description, places: Object.keys(places).filter(Boolean) })),
      supply: { ...supply, value: this.sizes.supply },
      load: { ...load, value: this.sizes.load },
      speed: { ...SPEED, value: this.sizes.speed },
    };
  }

  async change(wish: BenchWish): Promise<void> {
    const id = ++this.wished;
    const error = await new Promise<string | null>((settle) => {
      this.wishes.set(id, settle);
      this.tell({ kind: "wish", id, wish });
    });
    if (error) throw new Error(error);
    if ("power" in wish && !wish.power) this.listener?.link({ open: true, port: PORT, sentence: UNPOWERED });
    for (const size of ["supply", "load", "speed"] as const) {
      if (size in wish) this.sizes[size] = (wish as Readonly<Record<string, number>>)[size]!;
    }
  }
}
