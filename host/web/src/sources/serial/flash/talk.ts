// A line to a bootloader, an answer at a time.

import { SerialLine, wait, type Port } from "../line";
import { ANSWER_MS, ASK_EVERY_MS, QUESTIONS, START_MS, STILL_MS } from "./rules";

export class Talk {
  private heard: number[] = [];
  private arrived: () => void = () => undefined;
  private line!: SerialLine;

  /** Opens the port at a bootloader's speed and restarts the board, which starts the bootloader. */
  static async open(port: Port, baud: number): Promise<Talk> {
    const talk = new Talk();
    talk.line = await SerialLine.open(port, baud, {
      heard: (data) => {
        talk.heard.push(...data);
        talk.arrived();
      },
      lost: () => talk.arrived(),
    });
    await talk.line.restart();
    await wait(START_MS);
    return talk;
  }

  write(data: readonly number[]): void {
    this.line.write(Uint8Array.from(data));
  }

  close(): Promise<void> {
    return this.line.close();
  }

  /** So many bytes, or fewer where no more came in time. */
  async read(count: number): Promise<Uint8Array> {
    await this.until(() => this.heard.length >= count, ANSWER_MS);
    return Uint8Array.from(this.heard.splice(0, count));
  }

  /** Asks again and again until the answer comes; whether it did. */
  async hears(question: readonly number[], answer: readonly number[]): Promise<boolean> {
    const words = (bytes: readonly number[]): string => ` ${bytes.join(" ")} `;
    const there = (): boolean => words(this.heard).includes(words(answer));
    for (let left = QUESTIONS; left && !there(); left--) {
      this.write(question);
      await this.until(there, ASK_EVERY_MS);
    }
    const found = there();
    if (found) await this.forget();
    return found;
  }

  /** Lets pass what still comes, such as answers to questions that were asked twice. */
  private async forget(): Promise<void> {
    while (this.heard.length) {
      this.heard = [];
      await this.until(() => this.heard.length > 0, STILL_MS);
    }
  }

  private async until(done: () => boolean, ms: number): Promise<void> {
    let late = false;
    const end = wait(ms).then(() => { late = true; });
    while (!done() && !late) await Promise.race([end, new Promise<void>((settle) => { this.arrived = settle; })]);
  }
}
