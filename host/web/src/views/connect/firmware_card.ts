// Writes firmware onto a board, the page's own or a file, and says how far it is.

import { button, el, fileField, setText } from "../../parts/dom";
import type { NamedText } from "../../parts/named_text";
import type { BoardPort } from "../../session/port";
import type { Session } from "../../session/session";

export class FirmwareCard {
  readonly element: HTMLElement;
  private readonly bar = el("progress", { hidden: true, attrs: { "aria-label": "Flashing" } });
  private readonly stage = el("p", { class: "quiet", attrs: { role: "status" } });
  private readonly write: HTMLButtonElement;
  private image: Promise<NamedText> | null = null;

  /** `act` does one thing at a time. */
  constructor(
    private readonly session: Session, private readonly port: Pick<BoardPort, "flash">, words: string,
    act: (act: () => Promise<void>) => void,
  ) {
    const file = fileField("A HEX file in its place", ".hex", (given) => { this.image = given; });
    this.write = button("Flash", () => act(() => this.flash()), { title: "Write it through the board's bootloader, and read it back" });
    this.element = el("section", { class: "card" }, el("h2", {}, "Firmware"), el("p", {}, words),
      el("div", { class: "row" }, file), el("div", { class: "row" }, this.write), this.bar, this.stage);
  }

  set disabled(disabled: boolean) {
    this.write.disabled = disabled;
  }

  private async flash(): Promise<void> {
    setText(this.stage, "");
    const { hello: before } = this.session;
    try {
      const board = await this.port.flash(await this.image, (stage, share) => {
        this.bar.hidden = false;
        this.bar.value = share;
        setText(this.stage, stage);
      });
      const { hello } = this.session;
      setText(this.stage, `The ${board} holds what was written${hello && hello !== before ? `; firmware ${hello.fw_major}.${hello.fw_minor}.${hello.fw_patch} runs` : ""}.`);
    } catch (error) {
      setText(this.stage, "");
      throw error;
    } finally {
      this.bar.hidden = true;
    }
  }
}
