// Connects a board by hand, with or without restarting it, and writes firmware onto it.

import { button, el, setText } from "../../parts/dom";
import type { View } from "../view";
import type { BoardPort } from "../../session/port";
import type { Session } from "../../session/session";
import { FirmwareCard } from "./firmware_card";

export class ConnectView implements View {
  readonly name = "Port";
  readonly withoutBoard = true;
  readonly element: HTMLElement;
  private readonly now = el("p", { attrs: { role: "status" } });
  private readonly buttons: readonly HTMLButtonElement[];
  private readonly letGo = button("Disconnect", () => this.act(() => this.port.disconnect()), { title: "Motors off, and the port free for another program" });
  private readonly firmware: FirmwareCard;
  private busy = false;

  constructor(private readonly session: Session, private readonly port: BoardPort) {
    const connect = (label: string, restart: boolean, choose: boolean, title: string): HTMLButtonElement =>
      button(label, () => this.act(() => port.connect({ restart, choose })), { title });
    this.buttons = [
      connect("Connect", false, false, "Takes the board as it runs, where the browser and its adapter allow that"),
      connect("Restart and connect", true, false, "Restarts the board by DTR"),
      connect("Another port", false, true, "Choose the port anew"),
    ];
    this.buttons[0]!.classList.add("primary");
    this.firmware = new FirmwareCard(
      session, port,
      "The bootloader tells whether it is a Mega 2560 or a Nano; its own firmware comes with this page. What the board has stored stays.",
      (act) => this.act(act),
    );
    this.element = el("div", { class: "editor connect" },
      el("section", { class: "card" }, el("h2", {}, "Board at a port"), this.now,
        el("div", { class: "row" }, ...this.buttons, this.letGo),
        el("p", { class: "quiet" }, "A browser raises DTR when it opens a port. Where it was low, an Arduino restarts by that and its motors are off; no page can prevent it, and this one says so. The motors' lease is renewed only while this page is visible.")),
      this.firmware.element);
    session.changed.on(() => this.show());
    this.show();
  }

  /** One thing at a time. */
  private act(act: () => Promise<void>): void {
    this.busy = true;
    this.show();
    void this.session.attempt(act).then(() => {
      this.busy = false;
      this.show();
    });
  }

  private show(): void {
    const { link } = this.session;
    setText(this.now, link.open ? `${link.port}${link.sentence ? `: ${link.sentence}` : " is connected."}` : link.sentence);
    for (const one of [...this.buttons, this.firmware]) one.disabled = this.busy || this.port.missing !== "";
    this.letGo.disabled = this.busy || !link.open;
  }
}
