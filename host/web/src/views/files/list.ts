// The list of the folder's files by kind, with size and date, and what can be done with the one that is chosen.

import { button, el, setText } from "../../parts/dom";
import { fileWords, sizeWords } from "../../parts/file_words";
import type { HostState, NamedFile, Services, Verb } from "../../session/services";
import type { Session } from "../../session/session";
import type { LogComparison } from "./comparison";

export type Open = (verb: string, given: Readonly<Record<string, unknown>>) => void;

/** The titles of the kinds, in this order; a kind that has none comes last, by its own name. */
const TITLES: Readonly<Record<string, string>> = {
  log: "Logs", motion: "Motions", model: "Models", controller: "Controllers", arm: "Arms", answers: "Answers about an arm",
  parameters: "Backups of parameters", firmware: "Firmware", picture: "Pictures", report: "Reports",
};

/** Pictures that are shown here, by the end of the name. */
const IMAGES: Readonly<Record<string, string>> = { png: "image/png", svg: "image/svg+xml" };

export class FileList {
  readonly element: HTMLElement;
  private readonly groups = el("div", { class: "files-list" });
  private readonly folder = el("code");
  private readonly hint = el("p", { class: "quiet" });
  private readonly actions = el("div", { class: "file-actions", hidden: true, attrs: { role: "group", "aria-label": "The chosen file" } });
  private readonly picture = el("img", { hidden: true });
  private readonly asked = el("div", { attrs: { role: "status" } });
  private readonly rows = new Map<string, HTMLButtonElement>();
  private verbs: readonly Verb[] = [];
  private state: HostState | null = null;
  private chosen: NamedFile | null = null;
  private actionsOf: string | undefined; // the name of the file whose actions are shown

  constructor(
    private readonly session: Session, private readonly services: Services, private readonly open: Open,
    private readonly comparison: Pick<LogComparison, "choose" | "drop" | "names">,
  ) {
    const input = el("input", { type: "file", attrs: { multiple: "", accept: ".csv,.toml,.hex" }, on: { change: () => {
      const files = [...input.files ?? []];
      input.value = ""; // so that the same file is taken again
      this.bringAll(files);
    } } });
    this.element = el("section", { class: "card" }, el("h2", {}, "Files"),
      el("p", {}, "Recordings, models and all other files are in ", this.folder, "."),
      this.hint, this.actions, this.asked, this.picture, this.groups,
      el("label", { class: "file bring" }, el("span", {}, "Bring files here, or drop them on this list"), input));
    this.takeDrops();
  }

  /** Reads the folder anew. */
  async refresh(): Promise<void> {
    const [state, verbs] = await Promise.all([this.services.state(), this.services.jobs.verbs()]);
    [this.state, this.verbs] = [state, verbs];
    setText(this.folder, state.folder);
    setText(this.hint, state.files.some(({ kind }) => kind === "log")
      ? "Choose a log, or two to lay them over each other." : "There is no log yet: record one in the view Live or Do.");
    const known = Object.keys(TITLES);
    const kinds = [...new Set([...known, ...state.files.map(({ kind }) => kind)])];
    this.rows.clear();
    this.groups.replaceChildren(...kinds.flatMap((kind) => {
      const files = state.files.filter((one) => one.kind === kind).sort((one, other) => other.changed_s - one.changed_s);
      return files.length ? [this.group(TITLES[kind] ?? kind, files)] : [];
    }));
    const chosen = state.files.find(({ name }) => name === this.chosen?.name) ?? null;
    if (chosen?.name !== this.actionsOf) this.act(chosen); // else a question about it may be open
    this.mark();
  }

  /** Shows which files are chosen. */
  mark(): void {
    for (const [name, row] of this.rows) {
      const shown = this.comparison.names.includes(name) || (name === this.chosen?.name && this.chosen.kind !== "log");
      row.setAttribute("aria-pressed", String(shown));
    }
  }

  private group(title: string, files: readonly NamedFile[]): HTMLElement {
    const rows = files.map((file) => {
      const row = button("", () => this.choose(file));
      row.append(el("span", {}, file.name), " ", el("span", { class: "quiet" }, fileWords(file)));
      this.rows.set(file.name, row);
      return row;
    });
    return el("div", { class: "file-group", attrs: { role: "group", "aria-label": title } }, el("h3", {}, title), ...rows);
  }

  private choose(file: NamedFile): void {
    this.act(file);
    if (file.kind === "log") void this.session.attempt(() => this.comparison.choose(file.name));
  }

  /** Shows what can be done with a file. */
  private act(file: NamedFile | null): void {
    this.chosen = file;
    this.actionsOf = file?.name;
    this.asked.replaceChildren();
    this.actions.hidden = !file;
    this.mark();
    this.picture.hidden = true;
    if (!file) return;
    this.attempt(() => this.showPicture(file));
    this.actions.replaceChildren(
      el("h3", {}, file.name),
      ...this.uses(file),
      button("Download", () => this.attempt(() => this.download(file))),
      button("Rename", () => this.askForName(file)),
      button("Delete", () => this.askWhetherToDelete(file)));
  }

  /** A button for each verb that begins with such a file. */
  private uses({ name, kind }: NamedFile): readonly HTMLElement[] {
    return this.verbs.flatMap(({ verb, title, arguments: [first] }) => {
      if (!first || !(first.files.includes(kind) || first.kind === kind)) return [];
      return [button(title, () => this.open(verb, { [first.name]: first.many ? [name] : name }), { title: `Opens the form of ${verb}` })];
    });
  }

  private async showPicture(file: NamedFile): Promise<void> {
    const type = IMAGES[file.name.split(".").at(-1)!];
    if (!type) return;
    const content = await this.services.files.fetch(file.name);
    if (this.chosen !== file) return; // another was chosen meanwhile
    URL.revokeObjectURL(this.picture.src);
    this.picture.src = URL.createObjectURL(new Blob([content], { type }));
    this.picture.alt = file.name;
    this.picture.hidden = false;
  }

  private async download({ name }: NamedFile): Promise<void> {
    const address = URL.createObjectURL(await this.services.files.fetch(name));
    el("a", { href: address, attrs: { download: name.split("/").at(-1)! } }).click();
    URL.revokeObjectURL(address);
  }

  private askForName(file: NamedFile): void {
    const input = el("input", { type: "text", value: file.name, attrs: { "aria-label": "New name" } });
    const form = el("form", { class: "row", on: { submit: (event) => {
      event.preventDefault();
      this.attempt(async () => {
        await this.services.files.rename(file.name, input.value.trim());
        await this.comparison.drop(file.name);
        this.chosen = { ...file, name: input.value.trim() };
        await this.refresh();
      });
    } } }, input, el("button", { type: "submit" }, "Rename"), button("Cancel", () => this.asked.replaceChildren()));
    this.asked.replaceChildren(form);
    input.focus();
    input.setSelectionRange(0, file.name.lastIndexOf("."));
  }

  private askWhetherToDelete(file: NamedFile): void {
    this.ask(`Delete ${file.name} for good?`, [["Delete it", async () => {
      await this.services.files.remove(file.name);
      await this.comparison.drop(file.name);
      await this.refresh();
    }], ["Keep it", async () => undefined]]);
  }

  /** Asks in the page: a dialog of the browser would hold the page, and with it the motors' lease. */
  private ask(question: string, answers: readonly (readonly [string, () => Promise<void>])[]): void {
    const buttons = answers.map(([words, act]) => button(words, () => {
      this.asked.replaceChildren();
      this.attempt(act);
    }));
    this.asked.replaceChildren(el("p", {}, question), el("div", { class: "row" }, ...buttons));
    buttons.at(-1)!.focus();
  }

  private takeDrops(): void {
    const over = (is: boolean) => (event: DragEvent): void => {
      event.preventDefault();
      this.element.classList.toggle("dropping", is);
    };
    this.element.addEventListener("dragover", over(true));
    this.element.addEventListener("dragleave", over(false));
    this.element.addEventListener("drop", (event) => {
      over(false)(event);
      this.bringAll([...event.dataTransfer?.files ?? []]);
    });
  }

  /** Brings files one after the other; one whose name is taken waits for an answer, and those behind it too. */
  private bringAll([file, ...others]: readonly File[]): void {
    if (!file) return this.attempt(() => this.refresh());
    const bring = (ifThere: "refuse" | "replace" | "rename") => async (): Promise<void> => {
      const most = this.state?.most_upload_bytes ?? Infinity;
      if (file.size > most) throw new Error(`${file.name} has ${sizeWords(file.size)}, but a page brings at most ${sizeWords(most)}; copy it into the folder.`);
      await this.services.files.bring(file.name, file, ifThere);
      this.bringAll(others);
    };
    if (!this.rows.has(file.name)) return this.attempt(bring("refuse"));
    this.ask(`${file.name} is in the folder already.`, [
      ["Replace it", bring("replace")], ["Keep both", bring("rename")], ["Leave it out", async () => this.bringAll(others)],
    ]);
  }

  private attempt(act: () => Promise<void>): void {
    void this.session.attempt(act);
  }
}
