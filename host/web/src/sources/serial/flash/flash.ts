// Flashes a board: finds its bootloader and its chip, refuses what is for another, writes, and reads all of it back.

import { noBootloader, otherChip, silent, wrongByte } from "../../../files/rules";
import { LinkError } from "../../../link/declared";
import { upperFirst } from "../../../link/refusal";
import type { NamedText } from "../../../parts/named_text";
import type { Report } from "../../../session/port";
import type { Port } from "../line";
import { bootloaderOf, type Bootloader } from "./bootloader";
import { checkImage, hex, hexNumber, readImage, type Image } from "./image";
import { ATTEMPTS, ERASED, LOOP, ROUNDS, TARGETS } from "./rules";
import { Talk } from "./talk";
import { titleOf, type Target } from "./targets";

type Dialect = { readonly language: number; readonly baud: number };

/** Writes the file, or else the firmware of the board that answers; the board's name. The port is closed afterwards. */
export async function flash(
  port: Port, file: NamedText | null, firmware: (board: string) => Promise<NamedText>, report: Report,
): Promise<string> {
  const images = await readImages(file, firmware);
  report("looking for the bootloader", 0);
  const { talk, dialect, bootloader } = await findBootloader(port);
  let board: Target;
  let image: Image;
  try {
    board = await boardOf(bootloader);
    image = images.get(board)!;
    checkImage(image, board);
    const waiting = withLoop(image, board);
    await writeImage(bootloader, waiting, board, report);
    await verify(bootloader, waiting, board, report);
  } finally {
    await talk.close();
  }
  await writeFirst(port, dialect, image.memory.subarray(0, board.page), board);
  return titleOf(board);
}

/**
 * The image with a loop as its first page, where a program starts: whatever ends the writing in the middle, the board does
 * nothing, where half of a new program with half of an old one could do anything with the motors.
 */
function withLoop(image: Image, { page }: Target): Image {
  const memory = image.memory.slice().fill(ERASED, 0, page);
  memory.set(LOOP);
  return { ...image, memory };
}

/** Writes the first page, and lets the board start. Once after each restart: a second write erases the Mega's next page. */
async function writeFirst(port: Port, dialect: Dialect, wanted: Uint8Array, { page }: Target): Promise<void> {
  const content = new Uint8Array(page).fill(ERASED);
  content.set(wanted);
  for (let left = ATTEMPTS; left; left--) {
    const talk = await Talk.open(port, dialect.baud);
    try {
      const bootloader = bootloaderOf(dialect.language, talk);
      if (!await bootloader.enter()) continue;
      await boardOf(bootloader); // the first question may be lost
      await bootloader.write(0, content);
      const found = await bootloader.read(0, page);
      if (!found || content.some((byte, i) => byte !== found[i])) continue;
      await bootloader.leave();
      return;
    } finally {
      await talk.close();
    }
  }
  throw new LinkError(stopped("writing", 0));
}

/** Images for each board, read before a port is opened: a bootloader waits for a second, and a network may be slower. */
async function readImages(
  file: NamedText | null, firmware: (board: string) => Promise<NamedText>,
): Promise<ReadonlyMap<Target, Image>> {
  const chosen = file && readImage(file);
  return new Map(await Promise.all(TARGETS.map(async (board) => [board, chosen ?? readImage(await firmware(board.name))] as const)));
}

async function findBootloader(port: Port): Promise<{ talk: Talk; dialect: Dialect; bootloader: Bootloader }> {
  const dialects = TARGETS.flatMap(({ language, bauds }) => bauds.map((baud): Dialect => ({ language, baud })));
  for (let round = 0; round < ROUNDS; round++) {
    for (const dialect of dialects) {
      const talk = await Talk.open(port, dialect.baud);
      const bootloader = bootloaderOf(dialect.language, talk);
      if (await bootloader.enter()) return { talk, dialect, bootloader };
      await talk.close();
    }
  }
  const bauds = [...new Set(dialects.map(({ baud }) => baud))].join(" and ");
  throw new LinkError(upperFirst(noBootloader({ bauds })));
}

async function boardOf(bootloader: Bootloader): Promise<Target> {
  let signature: Uint8Array | null = null;
  // Half a question that was asked twice may be waiting for its other half: the first answer is lost then.
  for (let left = ATTEMPTS; left && !signature; left--) signature = await bootloader.signature();
  const hexSignature = signature && hex(signature);
  const board = TARGETS.find((one) => one.signature === hexSignature);
  if (board) return board;
  const known = TARGETS.map((one) => `${titleOf(one)} (${one.signature})`).join(" and ");
  const told = hexSignature ? `signature ${hexSignature}` : "no readable signature";
  throw new LinkError(upperFirst(otherChip({ signature: told, known })));
}

async function writeImage(bootloader: Bootloader, { memory }: Image, { page }: Target, report: Report): Promise<void> {
  for (let at = 0; at < memory.length; at += page) {
    const held = memory.subarray(at, at + page);
    const content = new Uint8Array(page).fill(ERASED);
    content.set(held);
    if (!await (isErased(held) ? bootloader.pass(at) : bootloader.write(at, content))) throw new LinkError(stopped("writing", at));
    report("writing", (at + page) / memory.length);
  }
}

function isErased(memory: Uint8Array): boolean {
  return memory.every((byte) => byte === ERASED);
}

/** Reads back all that the image has something for; what it leaves out is never executed. */
async function verify(bootloader: Bootloader, { memory }: Image, { page }: Target, report: Report): Promise<void> {
  for (let at = 0; at < memory.length; at += page) {
    const wanted = memory.subarray(at, at + page);
    if (isErased(wanted)) continue;
    const found = await bootloader.read(at, wanted.length + wanted.length % 2); // whole words
    if (!found) throw new LinkError(stopped("reading", at));
    const wrong = wanted.findIndex((byte, i) => byte !== found[i]);
    if (wrong >= 0) {
      const [is, was] = [hex(found.subarray(wrong, wrong + 1)), hex(wanted.subarray(wrong, wrong + 1))];
      throw new LinkError(upperFirst(wrongByte({ found: `0x${is}`, address: hexNumber(at + wrong), wanted: `0x${was}` })));
    }
    report("verifying", (at + page) / memory.length);
  }
}

function stopped(doing: string, at: number): string {
  return upperFirst(silent({ doing, address: hexNumber(at) }));
}
