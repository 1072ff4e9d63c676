// A serial port of the browser that is open: bytes come and go, DTR restarts the board, and a lost port is told.

import { LinkError } from "../../link/declared";
import { sentenceOf } from "../../parts/sentence";

const DTR_DOWN_MS = 50; // a board's reset line needs some 2 ms
const BUFFER_BYTES = 65_536; // of the browser, for a page that reads late

/** What is used of a browser's serial port. */
export type Port = Pick<SerialPort, "open" | "close" | "setSignals" | "readable" | "writable">;

export type Ear = { heard(data: Uint8Array): void; lost(): void };

export const wait = (ms: number): Promise<void> => new Promise((done) => setTimeout(done, ms));

export class SerialLine {
  private reader: ReadableStreamDefaultReader<Uint8Array> | null = null;
  private readonly writer: WritableStreamDefaultWriter<Uint8Array>;
  private readonly ended: Promise<void>;
  private closing = false;

  private constructor(private readonly port: Port, private readonly ear: Ear) {
    this.writer = port.writable!.getWriter();
    this.ended = this.read();
  }

  static async open(port: Port, baudRate: number, ear: Ear): Promise<SerialLine> {
    try {
      await port.open({ baudRate, bufferSize: BUFFER_BYTES });
    } catch (error) {
      const why = sentenceOf(error);
      throw new LinkError(`The port cannot be opened (${why}); close what else has it, or plug the board in again, and connect.`);
    }
    return new SerialLine(port, ear);
  }

  /** Noise and an overrun end a stream, and the port has another one; a port that is lost has none. */
  private async read(): Promise<void> {
    while (!this.closing && this.port.readable) {
      this.reader = this.port.readable.getReader();
      try {
        for (let got = await this.reader.read(); !got.done; got = await this.reader.read()) this.ear.heard(got.value);
      } catch {
        // the port's next stream, or none, says which error it was
      } finally {
        this.reader.releaseLock();
      }
    }
    if (!this.closing) this.ear.lost();
  }

  /** Sends bytes; a port that is lost is told by reading. */
  write(data: Uint8Array): void {
    this.writer.write(data).catch(() => undefined);
  }

  /** Lets DTR fall and rise, which restarts an Arduino; its bootloader then listens for a second. */
  async restart(): Promise<void> {
    await this.port.setSignals({ dataTerminalReady: false, requestToSend: false });
    await wait(DTR_DOWN_MS);
    await this.port.setSignals({ dataTerminalReady: true, requestToSend: true });
  }

  /** Closes the port once what was written has gone; never fails, as a lost port is closed already. */
  async close(): Promise<void> {
    this.closing = true;
    const ignore = (): void => undefined;
    await this.writer.close().catch(ignore);
    await this.reader?.cancel().catch(ignore);
    await this.ended;
    await this.port.close().catch(ignore);
  }
}
