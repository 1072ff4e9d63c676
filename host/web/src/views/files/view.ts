// The files of the host's folder: brought, kept, renamed, deleted, used by a verb; logs are laid over each other.

import { el } from "../../parts/dom";
import type { View } from "../view";
import type { Services } from "../../session/services";
import type { Session } from "../../session/session";
import { LogComparison } from "./comparison";
import { FileList, type Open } from "./list";

export class FilesView implements View {
  readonly name = "Files";
  readonly withoutBoard = true;
  readonly element: HTMLElement;
  private readonly list: FileList;
  private readonly comparison: LogComparison;
  private inFront = false;

  /** `open` brings the form of a verb to the front, with these fields filled in. */
  constructor(private readonly session: Session, services: Services, open: Open) {
    this.comparison = new LogComparison(session, services, () => this.list.mark());
    this.list = new FileList(session, services, open, this.comparison);
    this.element = el("div", { class: "logs" }, this.list.element, this.comparison.element);
    services.jobs.listen(({ state, verb }) => {
      if (this.inFront && state !== "running" && verb !== "evaluate") this.refresh(); // it may have written files
    });
  }

  enter(): void {
    this.inFront = true;
    this.comparison.rebuild();
    this.refresh();
  }

  leave(): void {
    this.inFront = false;
  }

  private refresh(): void {
    void this.session.attempt(() => this.list.refresh());
  }

  frame(): void {
    this.comparison.frame();
  }

  key(event: KeyboardEvent): boolean {
    return this.comparison.key(event);
  }
}
