// The two languages of Arduinos' bootloaders. Addresses are in bytes and even; a wrong answer is null or false.

import { keep, ANY, type Question } from "./question";
import { ERASED, Stk500V1, Stk500V2 } from "./rules";
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

/** The Nano's. */
class Version1 implements Bootloader {
  constructor(private readonly talk: Talk) {}

  enter(): Promise<boolean> {
    const { asks, answer } = Stk500V1.enter();
    return this.talk.hears(asks, answer);
  }

  signature(): Promise<Uint8Array | null> {
    return this.ask(Stk500V1.signature());
  }

  async write(address: number, page: Uint8Array): Promise<boolean> {
    return await this.seek(address) && await this.ask(Stk500V1.writePage(page)) !== null;
  }

  async pass(): Promise<boolean> {
    return true;
  }

  async read(address: number, count: number): Promise<Uint8Array | null> {
    return await this.seek(address) ? this.ask(Stk500V1.readPage(count)) : null;
  }

  async leave(): Promise<void> {
    await this.ask(Stk500V1.leave());
  }

  private async seek(address: number): Promise<boolean> {
    return await this.ask(Stk500V1.loadAddress(address / 2)) !== null;
  }

  private async ask({ asks, answer }: Question): Promise<Uint8Array | null> {
    this.talk.write(asks);
    return keep(await this.talk.read(answer.length), answer);
  }
}

/** The Mega's. */
class Version2 implements Bootloader {
  private sequence = 1; // with 1 every bootloader takes a message, older ones else only with the next number
  private at: number | null = null; // where it goes on by itself

  constructor(private readonly talk: Talk) {}

  enter(): Promise<boolean> {
    const { asks, answer } = Stk500V2.enter();
    return this.talk.hears(this.message(asks), answer);
  }

  async signature(): Promise<Uint8Array | null> {
    const found: number[] = [];
    for (const index of [0, 1, 2]) {
      const byte = await this.ask(Stk500V2.signature(index));
      if (!byte) return null;
      found.push(...byte);
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
    const written = await this.ask(Stk500V2.writePage(content)) !== null;
    this.at = written && this.at !== null ? this.at + content.length : null;
    return written;
  }

  async read(address: number, count: number): Promise<Uint8Array | null> {
    if (!await this.seek(address)) return null;
    const found = await this.ask(Stk500V2.readPage(count));
    this.at = found ? address + count : null;
    return found;
  }

  async leave(): Promise<void> {
    await this.ask(Stk500V2.leave());
  }

  private async seek(address: number): Promise<boolean> {
    if (this.at === address) return true;
    const there = await this.ask(Stk500V2.loadAddress(address / 2)) !== null;
    this.at = there ? address : null;
    return there;
  }

  private message(body: readonly number[]): number[] {
    const bytes = Stk500V2.message(this.sequence, body);
    return [...bytes, checksum(bytes)];
  }

  private async ask({ asks, answer }: Question): Promise<Uint8Array | null> {
    this.sequence = (this.sequence + 1) & 0xff;
    this.talk.write(this.message(asks));
    const pattern = [...Stk500V2.message(this.sequence, answer), ANY];
    const heard = await this.talk.read(pattern.length);
    return checksum(heard) === 0 ? keep(heard, pattern) : null;
  }
}

function checksum(bytes: Iterable<number>): number {
  return [...bytes].reduce((sum, byte) => sum ^ byte, 0);
}

const LANGUAGES: Readonly<Record<number, new (talk: Talk) => Bootloader>> = { 1: Version1, 2: Version2 };

export function bootloaderOf(language: number, talk: Talk): Bootloader {
  return new LANGUAGES[language]!(talk);
}
