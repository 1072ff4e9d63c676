// The frame around all views: state, enable and stop always in sight, the views by tabs, notices, the space bar.

import { InTheWay } from "./in_the_way";
import { State } from "../link/schema";
import { button, el, setText } from "../parts/dom";
import { grey } from "../parts/grey";
import { drawPictures } from "../parts/pictures";
import { isDark, switchTheme, themeChanged } from "../parts/theme";
import type { View } from "./view";
import type { Session } from "../session/session";

const WRITING = new Set(["text", "number", "search", ""]);

export class Shell {
  private readonly stop = button("Stop", () => this.stopNow(), {
    class: "stop", title: "Motors off (space bar)", attrs: { "aria-keyshortcuts": "Space" },
  });
  private readonly enable = button("Enable", () => void this.session.attempt(() => this.session.enable()), { class: "enable" });
  private readonly let = el("span");
  private readonly control = button("", () => this.takeOrLetGo(), { class: "control" });
  private readonly state = el("span", { class: "pill", attrs: { role: "status" } });
  private readonly place = el("span", { class: "place" });
  private readonly notice = el("div", { class: "notice", hidden: true, attrs: { role: "alert" } });
  private readonly noticeText = el("p");
  private readonly empty = el("section", { class: "empty" });
  private readonly emptyText = el("p");
  private readonly main = el("main", { attrs: { id: "view", tabindex: "-1" } });
  private readonly nav = el("nav", { attrs: { "aria-label": "Views" } });
  private readonly offers = el("div", { class: "offers" });
  private readonly tabs = new Map<View, HTMLButtonElement>();
  private front: View;

  /** `remedy` says what to do where no board is there; `front` is the view to begin with, `shows` hears of each one. */
  constructor(
    private readonly session: Session, views: readonly View[], remedy: string, front: View,
    private readonly shows: (view: View) => void,
  ) {
    this.front = front;
    this.control.append(this.let, el("span", { class: "wide" }, " of the arm"));
    for (const view of views) this.add(view);
    this.notice.append(this.noticeText, button("×", () => { this.notice.hidden = true; }, {
      attrs: { "aria-label": "Close this notice" },
    }));
    this.empty.append(el("h2", {}, "No board"), this.emptyText, el("p", {}, remedy));
    const theme = button("", switchTheme, { class: "theme" });
    const nameTheme = (): void => setText(theme, isDark() ? "Light" : "Dark");
    themeChanged.on(nameTheme);
    nameTheme();
    document.body.append(
      el("header", {},
        el("div", { class: "brand" }, el("h1", {}, "greywhale"), this.place),
        this.state,
        el("div", { class: "motors" }, this.control, this.enable, this.stop, theme)),
      el("div", { class: "bar" }, this.nav, this.offers),
      new InTheWay(session, this.enable, this.control).element, this.notice, this.empty, this.main);
    session.changed.on(() => this.refresh());
    session.noticed.on(() => this.showNotice());
    addEventListener("keydown", (event) => this.pressed(event), { capture: true });
    this.show(this.front);
    this.showState(); // before the first picture: nothing can be enabled yet
    drawPictures(() => this.picture());
  }

  private add(view: View): void {
    const tab = button(view.name, () => this.show(view), { attrs: { "aria-controls": "view" } });
    this.tabs.set(view, tab);
    this.nav.append(tab);
  }

  /** Adds what is at hand in every view, beside the tabs. */
  offer(element: HTMLElement): void {
    this.offers.append(element);
  }

  get shown(): string {
    return this.front.name;
  }

  show(view: View): void {
    this.front.leave?.();
    this.front = view;
    this.notice.hidden = true; // it was about the view before, and may cover something of this one
    for (const [one, tab] of this.tabs) {
      if (one === view) tab.setAttribute("aria-current", "page");
      else tab.removeAttribute("aria-current");
    }
    this.main.replaceChildren(view.element);
    this.main.setAttribute("aria-label", view.name);
    this.shows(view);
    view.enter?.();
    this.refresh();
  }

  private picture(): void {
    this.showState();
    if (!this.empty.hidden && this.session.samples.end) this.refresh();
    this.front.frame?.();
  }

  private showState(): void {
    const { session } = this;
    const state = session.link.open ? State.of(session.state).name : "no board";
    setText(this.state, state.replace("_", " "));
    this.state.dataset["state"] = state;
    document.body.dataset["motors"] = session.motorsOn ? "on" : "off";
    grey(this.enable, session.whyNotEnable, "Starts the motors through the soft start");
  }

  private refresh(): void {
    const { link, driver, samples, whyNotChange } = this.session;
    setText(this.place, !link.open ? "" : driver.verb ? `${link.port}, used by ${driver.verb}` : link.port);
    this.empty.hidden = link.open || samples.end > 0 || this.front.withoutBoard === true;
    setText(this.emptyText, link.sentence || "Looking for a board.");
    setText(this.let, driver.you ? "Let go" : "Take control");
    grey(this.control, driver.you || driver.free ? "" : whyNotChange,
      driver.you ? "Let another page drive; the motors go off" : "Drive the arm from this page");
  }

  private takeOrLetGo(): void {
    if (this.session.driver.you) this.session.release();
    else this.session.drive();
  }

  private stopNow(): void {
    void this.session.attempt(() => this.session.stop());
  }

  private showNotice(): void {
    const { notice } = this.session;
    this.notice.hidden = notice === null;
    if (!notice) return;
    this.notice.dataset["kind"] = notice.kind;
    setText(this.noticeText, notice.sentence);
  }

  /**
   * While motors run, the space bar stops them wherever the focus is, but in a field where a person writes. While it is
   * counted down before they start, it does so there too.
   */
  private pressed(event: KeyboardEvent): void {
    const { target } = event;
    const writing = target instanceof HTMLInputElement && WRITING.has(target.type);
    const { counting, motorsOn } = this.session;
    if (event.key === " " && (counting || (!writing && (motorsOn || target === document.body)))) {
      event.preventDefault();
      if (!event.repeat) this.stopNow();
      return;
    }
    const choosing = writing || target instanceof HTMLSelectElement || target instanceof HTMLInputElement;
    if (event.ctrlKey || event.altKey || event.metaKey || choosing) return;
    if (this.front.key?.(event)) event.preventDefault();
  }
}
