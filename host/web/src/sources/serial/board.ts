// A real board at a serial port of the browser (Web Serial).

import type { Board, BoardListener } from "../../session/board";
import { LinkError } from "../../link/declared";
import { encodeFrame } from "../../link/frames";
import { ResetCause, StopRequest, TelemetryRequest } from "../../link/schema";
import { sentenceOf } from "../../parts/sentence";
import type { NamedText } from "../../parts/named_text";
import type { BoardPort, Report } from "../../session/port";
import { flash } from "./flash/flash";
import { Lease } from "./lease";
import { SerialLine } from "./line";
import { Silence } from "./silence";

const BAUD = 1_000_000;
const QUIET_MS = 100; // without any of the samples, which come every ms: perhaps a bootloader listens
const SILENT_MS = 1000;
const BOOT_MS = 2200; // until a bootloader has given up waiting and the firmware has said hello

const NO_SERIAL = "This browser reaches no serial port: take a recent Chromium, Chrome, Edge or Firefox on a computer, and open the page over https or from this computer.";
const NONE = "No board is connected.";
const UNPLUGGED = "The board was unplugged; plug it in again, and this page takes it.";
const SILENT = "The board is silent: is its supply on?";
const RESTARTED = "Opening the port has restarted the board.";
const FLASHING = "The board is being flashed.";
const frame = ({ type }: { readonly type: number }, payload: Uint8Array = new Uint8Array()): Uint8Array => encodeFrame(type, 0, payload);

export class SerialBoard implements Board, BoardPort {
  readonly missing: string;
  private listener: BoardListener | null = null;
  private port: SerialPort | null = null; // the chosen one
  private line: SerialLine | null = null;
  private met = false; // whether the page was told that the board is there
  private started = false; // whether the board has said that it has just started
  private unplugged = false;
  private quiet = false; // whether nothing may be asked just now
  private silent = false;
  private readonly silence = new Silence([
    [QUIET_MS, () => { this.quiet = this.lease.samples; }],
    [SILENT_MS, () => this.tellSilent()],
    [BOOT_MS, () => { this.quiet = false; }],
  ]);
  private answered: () => void = () => undefined;
  private driving = true;
  private readonly lease = new Lease((renewal) => this.line?.write(renewal), () => document.visibilityState === "visible");

  /** `firmware` gives the HEX file of a board, mega or nano. */
  constructor(private readonly serial: Serial | undefined, private readonly firmware: (board: string) => Promise<NamedText>) {
    this.missing = serial ? "" : NO_SERIAL;
    serial?.addEventListener("connect", ({ target }) => void this.pluggedIn(target as SerialPort));
  }

  listen(listener: BoardListener): void {
    this.listener = listener;
    this.tell(false, this.missing || NONE);
  }

  private tell(open: boolean, sentence: string): void {
    this.listener?.driver({ you: open && this.driving, free: open, verb: null });
    this.listener?.link({ open, port: open ? this.name() : "", sentence });
  }

  private name(): string {
    const { usbVendorId, usbProductId } = this.port?.getInfo() ?? {};
    const hex = (id: number): string => id.toString(16).padStart(4, "0");
    return usbVendorId === undefined ? "serial port" : `USB ${hex(usbVendorId)}:${hex(usbProductId ?? 0)}`;
  }

  async connect({ restart, choose }: { restart: boolean; choose: boolean }): Promise<void> {
    await this.disconnect();
    this.port = choose ? await this.ask() : await this.known() ?? await this.ask();
    if (this.port) await this.open(restart);
  }

  /** The port that a person chose before, here or on an earlier visit. */
  private async known(): Promise<SerialPort | null> {
    const granted = await this.serial!.getPorts();
    return this.port ?? (granted.length === 1 ? granted[0]! : null);
  }

  /** Lets a person choose; null where nothing is chosen. */
  private async ask(): Promise<SerialPort | null> {
    try {
      return await this.serial!.requestPort();
    } catch (error) {
      if (error instanceof DOMException && error.name === "NotFoundError") return null;
      throw error;
    }
  }

  /**
   * Opens the chosen port and listens first: to open it may have restarted the board, and the Mega's bootloader, once it
   * has heard a byte, waits for ever for the rest.
   */
  private async open(restart: boolean): Promise<void> {
    const line = await SerialLine.open(this.port!, BAUD, {
      heard: (data) => this.heard(data),
      lost: () => void this.lost(),
    });
    this.line = line;
    this.started = false;
    if (restart) await line.restart();
    await this.saysSomething(BOOT_MS);
    if (this.line !== line) return;
    this.met = this.driving = true;
    this.silence.begin();
    this.tell(true, this.started && !restart ? RESTARTED : "");
  }

  /** Waits until the board says something, but not longer than that. */
  private saysSomething(ms: number): Promise<void> {
    return new Promise((settle) => {
      const timer = setTimeout(settle, ms);
      this.answered = () => {
        clearTimeout(timer);
        settle();
      };
    });
  }

  private heard(data: Uint8Array): void {
    this.answered();
    if (this.silent) this.tell(true, "");
    this.quiet = this.silent = false;
    if (this.met) this.silence.begin();
    this.lease.onHeard(data, ({ reset_cause }) => {
      this.started = true;
      if (this.met) this.tell(true, `The board restarted (${ResetCause.of(reset_cause).description}), and its motors are off.`);
    });
    this.listener?.bytes(data);
  }

  private tellSilent(): void {
    this.silent = true;
    this.tell(true, SILENT);
  }

  /** The port went away, and with it whatever ran: the board's lease has ended. */
  private async lost(): Promise<void> {
    this.unplugged = true;
    await this.leave(UNPLUGGED);
  }

  private async pluggedIn(port: SerialPort): Promise<void> {
    if (!this.unplugged || this.line || (port !== this.port && !this.looksLike(port))) return;
    this.port = port;
    try {
      await this.open(false);
    } catch (error) {
      this.tell(false, sentenceOf(error));
    }
  }

  private looksLike(port: SerialPort): boolean {
    const [was, is] = [this.port?.getInfo(), port.getInfo()];
    return was?.usbVendorId !== undefined && was.usbVendorId === is.usbVendorId && was.usbProductId === is.usbProductId;
  }

  /** Stops the motors and closes the port. */
  async disconnect(): Promise<void> {
    this.unplugged = false;
    await this.leave(NONE);
  }

  private async leave(sentence: string): Promise<void> {
    const { line } = this;
    this.line = null;
    this.met = this.quiet = this.silent = false;
    this.lease.samples = false;
    this.silence.end();
    this.tell(false, sentence);
    if (!line) return;
    line.write(frame(StopRequest));
    line.write(frame(TelemetryRequest, TelemetryRequest.pack({ every: 0 })));
    await line.close();
  }

  async flash(file: NamedText | null, report: Report): Promise<string> {
    this.port ??= await this.known() ?? await this.ask();
    if (!this.port) throw new LinkError("No port is chosen; choose the board's.");
    await this.leave(FLASHING);
    try {
      return await flash(this.port, file, this.firmware, report);
    } finally {
      report("starting the firmware", 0);
      await this.open(true).catch((error: unknown) => this.tell(false, String(error)));
    }
  }

  /** Sends a frame; one that may meet a bootloader is lost, and asked again. A stop always goes. */
  send(data: Uint8Array): void {
    const stops = this.lease.onSent(data);
    if (!this.quiet || stops) this.line?.write(data);
  }

  drive(): void {
    this.driving = true;
    this.tellDriver();
  }

  /** Motors that run for this page go off. */
  release(): void {
    this.driving = false;
    this.send(frame(StopRequest));
    this.tellDriver();
  }

  private tellDriver(): void {
    this.listener?.driver({ you: this.met && this.driving, free: this.met, verb: null });
  }

  /** Nobody keeps samples from before. */
  async history(): Promise<Uint8Array> {
    return new Uint8Array();
  }
}
