// The two languages of Arduinos' bootloaders. Addresses are in bytes and even; a wrong answer is null or false.

import { ERASED } from "./image";
import type { Speaks } from "./targets";
import type { Talk } from "./talk";

export interface Bootloader {
  /** Asks until it answers; whether it does. */
  enter(): Promise<boolean>;
  /** The chip's signature. */
  signature(): Promise<Uint8Array | null>;
  /** Erases and writes a page. Pages come in their order from 0, each written or passed over. */
  write(address: number, page: Uint8Array): Promise<boolean>;
  /** Passes over a page of which an image has nothing. */
  pass(address: number): Promise<boolean>;
  read(address: number, count: number): Promise<Uint8Array | null>;
  /** Lets it start the firmware. */
  leave(): Promise<void>;
}

const IN_SYNC = 0x14;
const OK = 0x10;
const letter = (text: string): number => text.charCodeAt(0);
const END = letter(" ");

/** The Nano's: a command of one letter and a space; "in sync", the answer, "ok". */
class Version1 implements Bootloader {
  constructor(private readonly talk: Talk) {}

  enter(): Promise<boolean> {
    return this.talk.hears(Uint8Array.of(letter("0"), END), [IN_SYNC, OK]);
  }

  signature(): Promise<Uint8Array | null> {
    return this.ask([letter("u")], 3);
  }

  async write(address: number, page: Uint8Array): Promise<boolean> {
    return await this.seek(address) && await this.ask([letter("d"), ...size(page.length), letter("F"), ...page]) !== null;
  }

  async pass(): Promise<boolean> {
    return true;
  }

  async read(address: number, count: number): Promise<Uint8Array | null> {
    return await this.seek(address) ? this.ask([letter("t"), ...size(count), letter("F")], count) : null;
  }

  async leave(): Promise<void> {
    await this.ask([letter("Q")]);
  }

  private async seek(address: number): Promise<boolean> {
    const word = address / 2;
    return await this.ask([letter("U"), word & 0xff, word >> 8]) !== null;
  }

  private async ask(command: readonly number[], count = 0): Promise<Uint8Array | null> {
    this.talk.write(Uint8Array.of(...command, END));
    const answer = await this.talk.read(count + 2);
    return answer[0] === IN_SYNC && answer[count + 1] === OK ? answer.subarray(1, -1) : null;
  }
}

const START = 0x1b;
const TOKEN = 0x0e;
const COMMAND = { sign_on: 0x01, load_address: 0x06, leave: 0x11, program_flash: 0x13, read_flash: 0x14, spi: 0x1d };
const DONE = 0;
const BEYOND_64_KB = 0x80; // the top bit of an address
// The command that writes a page, and the way to wait, for a programmer; a bootloader knows that by itself.
const HOW_TO_WRITE = [0xc1, 10, 0x40, 0x4c, 0x20, 0, 0];

/** The Mega's: messages with start, sequence number, length, token, body and checksum. */
class Version2 implements Bootloader {
  private sequence = 0;
  private at: number | null = null; // where it goes on by itself

  constructor(private readonly talk: Talk) {}

  enter(): Promise<boolean> {
    const named = [..."AVRISP_2"].map(letter);
    return this.talk.hears(this.message([COMMAND.sign_on]), [TOKEN, COMMAND.sign_on, DONE, named.length, ...named]);
  }

  /** Byte by byte, as SPI commands that the bootloader answers itself. */
  async signature(): Promise<Uint8Array | null> {
    const found: number[] = [];
    for (const index of [0, 1, 2]) {
      const answer = await this.ask([COMMAND.spi, 4, 4, 0, 0x30, 0, index, 0]);
      if (answer?.length !== 7) return null;
      found.push(answer[5]!);
    }
    return Uint8Array.from(found);
  }

  async write(address: number, page: Uint8Array): Promise<boolean> {
    return await this.seek(address) && this.program(page);
  }

  /**
   * It erases one page after the other, whichever is written: a page that is left out would be erased too late. So a word
   * of nothing is written, which changes nothing wherever that is.
   */
  pass(): Promise<boolean> {
    return this.program(Uint8Array.of(ERASED, ERASED));
  }

  private async program(content: Uint8Array): Promise<boolean> {
    const written = await this.ask([COMMAND.program_flash, ...size(content.length), ...HOW_TO_WRITE, ...content]) !== null;
    this.at = written && this.at !== null ? this.at + content.length : null;
    return written;
  }

  async read(address: number, count: number): Promise<Uint8Array | null> {
    if (!await this.seek(address)) return null;
    const answer = await this.ask([COMMAND.read_flash, ...size(count), 0x20]);
    this.at = answer ? address + count : null;
    return answer?.length === count + 3 && answer.at(-1) === DONE ? answer.subarray(2, -1) : null;
  }

  async leave(): Promise<void> {
    await this.ask([COMMAND.leave, 1, 1]);
  }

  private async seek(address: number): Promise<boolean> {
    if (this.at === address) return true;
    const word = address / 2;
    const there = await this.ask([COMMAND.load_address, BEYOND_64_KB, word >> 16, ...size(word & 0xffff)]) !== null;
    this.at = there ? address : null;
    return there;
  }

  private message(body: readonly number[]): Uint8Array {
    this.sequence = (this.sequence + 1) & 0xff;
    const bytes = [START, this.sequence, ...size(body.length), TOKEN, ...body];
    return Uint8Array.of(...bytes, checksum(bytes));
  }

  /** The body of the answer, where that says that all went well. */
  private async ask(body: readonly number[]): Promise<Uint8Array | null> {
    this.talk.write(this.message(body));
    const head = await this.talk.read(5);
    if (head.length < 5 || head[0] !== START || head[1] !== this.sequence || head[4] !== TOKEN) return null;
    const rest = await this.talk.read(head[2]! * 256 + head[3]! + 1);
    const sound = checksum([...head, ...rest]) === 0 && rest[0] === body[0] && rest[1] === DONE;
    return sound ? rest.subarray(0, -1) : null;
  }
}

function size(count: number): [high: number, low: number] {
  return [count >> 8, count & 0xff];
}

function checksum(bytes: readonly number[]): number {
  return bytes.reduce((sum, byte) => sum ^ byte, 0);
}

export function bootloaderOf(speaks: Speaks, talk: Talk): Bootloader {
  return speaks === "STK500 version 1" ? new Version1(talk) : new Version2(talk);
}
