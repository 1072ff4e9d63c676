// A board inside the page, in a worker of its own, with the bench around it.

import type { Board, BoardListener } from "../../session/board";
import { SIZES, type BenchControls, type BenchWish, type HandsWish, type Bench as BenchActions, type Range, type Size } from "../../session/services";
import { encodeFrame } from "../../link/frames";
import { upperFirst } from "../../link/refusal";
import { StopRequest } from "../../link/schema";
import type { NamedText } from "../../parts/named_text";
import { sentenceOf } from "../../parts/sentence";
import type { Store } from "../../parts/storage";
import type { BoardPort, Report } from "../../session/port";
import { flash } from "../serial/flash/flash";
import { readImage } from "../serial/flash/image";
import { keepEeprom, keptEeprom } from "./eeprom";
import { SPEED } from "./bench_loop";
import type { BenchData, FromBench, ToBench } from "./messages";
import { PagePort } from "./port";

const PORT = "an Arduino Mega and an arm, simulated in this page";
const RESTARTED = "The board restarted, and its motors are off.";
const BOOT_MS = 2200; // until a bootloader has given up waiting and the firmware has said hello
const FLASHING = "The board is being flashed.";
const UNPOWERED = "The board has no power.";
const UNKEPT = "This browser has no room to keep what the board stores; it ends with this page.";

export class PageBoard implements Board, BenchActions, Pick<BoardPort, "flash"> {
  private listener: BoardListener | null = null;
  private readonly wishes = new Map<number, (error: string | null, takes_s: number) => void>();
  private wished = 0;
  private readonly sizes: Record<Size, number>;
  private broken: readonly string[] = [];
  private led: readonly number[] | string; // or the motion, by its name
  private keptSentence = ""; // of what the browser had kept; told once the board is there
  private unkeptTold = false;
  private port: PagePort | null = null; // while the board is being flashed
  private said: () => void = () => undefined;

  /** `worker` runs worker.ts, `code` is the module, `firmware` gives the HEX file of a board, `store` is the browser's own. */
  constructor(
    private readonly worker: Worker, private readonly code: ArrayBuffer, private readonly data: BenchData,
    private readonly firmware: (board: string) => Promise<NamedText>,
    private readonly store: Store,
  ) {
    this.led = data.motions[0]!.name;
    this.sizes = Object.fromEntries(SIZES.map((size) => [size, this.range(size).value])) as Record<Size, number>;
    worker.addEventListener("message", ({ data: message }: MessageEvent<FromBench>) => this.heard(message));
    worker.addEventListener("error", ({ message }) => this.failed(`The bench does not start (${message || "its worker is refused"}); reload the page.`));
    document.addEventListener("visibilitychange", () => this.showVisible());
  }

  listen(listener: BoardListener): void {
    this.listener = listener;
    this.start().catch((error: unknown) => this.failed(`${upperFirst(sentenceOf(error))}; load the page again.`));
  }

  private async start(): Promise<void> {
    const { memory } = readImage(await this.firmware("mega"));
    const kept = keptEeprom(this.store);
    this.tell({ kind: "start", code: this.code, data: this.data, firmware: memory, eeprom: kept.content });
    this.showVisible();
    this.keptSentence = kept.sentence;
    this.unkeptTold = !this.store.allowed;
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
        if (this.port) this.port.hear(message.data);
        else this.listener?.bytes(message.data);
        this.said();
        this.tell({ kind: "taken", count: message.data.length });
        break;
      case "restarted":
        if (!this.port) this.listener?.link({ open: true, port: PORT, sentence: RESTARTED });
        break;
      case "eeprom":
        if (!keepEeprom(this.store, message.content) && !this.unkeptTold) {
          this.unkeptTold = true;
          this.listener?.refused(0, 0, UNKEPT);
        }
        break;
      case "done":
        this.wishes.get(message.id)?.(message.error, message.takes_s);
        this.wishes.delete(message.id);
        break;
      case "failed":
        this.failed(message.sentence);
        break;
    }
  }

  private failed(sentence: string): void {
    for (const settle of this.wishes.values()) settle(sentence, 0);
    this.wishes.clear();
    this.listener?.driver({ you: false, free: false, verb: null });
    this.listener?.link({ open: false, port: "", sentence });
  }

  send(data: Uint8Array): void {
    if (!this.port) this.tell({ kind: "send", data, flashes: false });
  }

  async flash(file: NamedText | null, report: Report): Promise<string> {
    const { speed } = this.sizes;
    await this.change({ speed: 1 }); // a flasher waits for a bootloader by the wall clock
    this.listener?.driver({ you: false, free: false, verb: null });
    this.listener?.link({ open: false, port: "", sentence: FLASHING });
    this.port = new PagePort({
      send: (data) => this.tell({ kind: "send", data, flashes: true }),
      restart: () => this.tell({ kind: "reset" }),
    });
    try {
      return await flash(this.port, file, this.firmware, report);
    } finally {
      report("starting the firmware", 0);
      this.port = null;
      this.listener?.link({ open: true, port: PORT, sentence: "" });
      this.drive();
      await this.saysSomething();
      await this.change({ speed });
    }
  }

  /** Waits until the board says something, but no longer than a bootloader waits for a host. */
  private saysSomething(): Promise<void> {
    return new Promise((settle) => {
      this.said = settle;
      setTimeout(settle, BOOT_MS);
    });
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
    const { leader, faults, motions } = this.data;
    return {
      leader,
      broken: this.broken,
      faults: faults.map((fault) => ({ ...fault, places: Object.keys(fault.places).filter(Boolean) })),
      motions: motions.map(({ name, title }) => ({ name, title })),
      ...Object.fromEntries(SIZES.map((size) => [size, { ...this.range(size), value: this.sizes[size] }])),
    };
  }

  /** Does it, or fails with a sentence; how long hands take. */
  private wish(wish: BenchWish | HandsWish): Promise<number> {
    const id = ++this.wished;
    return new Promise((settle, fail) => {
      this.wishes.set(id, (error, takes_s) => (error ? fail(new Error(error)) : settle(takes_s)));
      this.tell({ kind: "wish", id, wish });
    });
  }

  async hands(wish: HandsWish): Promise<number> {
    const takes_s = await this.wish(wish);
    this.led = "held";
    return takes_s;
  }

  async change(wish: BenchWish): Promise<void> {
    await this.wish(wish);
    if ("power" in wish && !wish.power) this.listener?.link({ open: true, port: PORT, sentence: UNPOWERED });
    if ("fault" in wish) this.takeFault(wish.fault);
    else if ("leader" in wish) this.led = [...wish.leader];
    else if ("motion" in wish) this.led = wish.motion;
    for (const size of SIZES) {
      if (size in wish) this.sizes[size] = (wish as Readonly<Record<Size, number>>)[size];
    }
  }

  private takeFault(fault: string | null): void {
    this.broken = fault === null ? [] : [...this.broken, fault];
    if (fault === null) this.sizes.supply = this.data.supply.value; // mended as well
  }

  /** The range of a size, and its value on a fresh bench. */
  private range(size: Size): Range {
    return size === "speed" ? SPEED : this.data[size];
  }

  /** The wishes that would bring a fresh bench to where this one is, its leader being at these angles now. */
  condition(leader: readonly number[]): { readonly sizes: readonly BenchWish[]; readonly acts: readonly BenchWish[] } {
    const led = this.led === "hold" ? leader : this.led;
    const fresh = led === this.data.motions[0]!.name;
    return {
      sizes: SIZES.filter((size) => this.sizes[size] !== this.range(size).value).map((size) => ({ [size]: this.sizes[size] })),
      acts: [
        ...(fresh ? [] : [typeof led === "string" ? { motion: led } : { leader: led.map((angle) => Number(angle.toFixed(3))) }]),
        ...this.broken.map((fault) => ({ fault })),
      ],
    };
  }
}
