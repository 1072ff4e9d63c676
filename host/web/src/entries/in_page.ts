// The page without a host: firmware, arm and a moving hand inside it, which follows as soon as the page is open, or is in
// the state that the address names; or a real board at a port, where the address says ?board=port. Its parts come as files
// beside it (site.ts) or within it (single.ts).

import "../page.css";
import { fragmentOf, stateOf, type PageState } from "./link_to_state";
import type { BenchWish } from "../session/services";
import { button, el, select } from "../parts/dom";
import { sentenceOf } from "../parts/sentence";
import { browserStore } from "../parts/storage";
import { startTheme } from "../parts/theme";
import { Session } from "../session/session";
import type { Shell } from "../views/shell";
import { PageBoard } from "../sources/in_page/board";
import type { BenchData } from "../sources/in_page/messages";
import { PagePredictor } from "../sources/in_page/predictor";
import { PageTuner } from "../sources/in_page/tuner";
import { SerialBoard } from "../sources/serial/board";
import type { TunerData } from "../tuner/data";
import { Views } from "./views";
import { whenDisabled } from "./when_disabled";

/** The files of which the page is made. */
type Folder = {
  readonly file: (name: string) => Promise<Response>;
  readonly worker: (name: "bench" | "tuner") => Worker; // a new one each time
  /** The folder of the documentation, where one lies beside the page. */
  readonly docs: string | null;
};
type Module<Data> = { readonly code: ArrayBuffer; readonly data: Data; readonly worker: Worker };
type Parts = ReturnType<typeof partsOf> & Module<BenchData>;

const THE_BENCHS = "This is the arm as the page begins with it: what was broken, loaded or changed on the bench is not in it.";
const NOT_YOURS = "This is greywhale's default arm, not yours. greywhale identify makes a model.toml of your own from a recording: give it here.";

/** Shows the page, or why its parts are not there; ends when they are. */
export async function openPage(folder: Folder): Promise<void> {
  startTheme();
  addEventListener("hashchange", () => location.reload());
  const bench = moduleOf<BenchData>(folder, "bench");
  bench.then((module) => (atPort() ? showPort : showBench)({ ...partsOf(folder), ...module })).catch((error: unknown) => {
    document.body.append(el("main", {}, el("p", {}, `${sentenceOf(error)}; load it again.`)));
  });
  await bench;
}

async function moduleOf<Data>({ file, worker: begun }: Folder, name: "bench" | "tuner"): Promise<Module<Data>> {
  const worker = begun(name); // starts while its module is on the way
  const [code, data] = await Promise.all([
    file(`${name}.wasm`).then((answer) => answer.arrayBuffer()),
    file(`${name}.json`).then((answer) => answer.json() as Promise<Data>),
  ]);
  return { code, data, worker };
}

/** The parts that are read when they are needed. */
function partsOf(folder: Folder) {
  const { file, docs } = folder;
  return {
    docs,
    tuner: () => moduleOf<TunerData>(folder, "tuner"),
    /** The rules of a calibration. */
    calibration: async () => (await file("calibration.wasm")).arrayBuffer(),
    /** The HEX file of a board, mega or nano. */
    firmware: async (board: string) => ({ name: `${board}.hex`, text: await (await file(`${board}.hex`)).text() }),
  };
}

function atPort(): boolean {
  return new URLSearchParams(location.search).get("board") === "port";
}

function fragment(): URLSearchParams {
  return new URLSearchParams(location.hash.slice(1));
}

/** The board that the page shows. Another one begins anew, so that nothing of the one before is taken for its own. */
function choice(): HTMLElement {
  const box = select("Board", [["", "Bench in this page"], ["port", "Board at a port"]], (board) => {
    location.href = `${location.pathname}${board && `?board=${board}`}`;
  });
  box.value = atPort() ? "port" : "";
  return box;
}

function showPort({ data, worker, tuner, calibration, firmware, docs }: Parts): void {
  worker.terminate();
  const port = new SerialBoard((navigator as { serial?: Serial }).serial, firmware);
  const session = new Session(port);
  const views = new Views({
    session, arm: { arm: async () => data.description }, services: null, bench: null, flashed: null, port,
    predictor: new PagePredictor(tuner, NOT_YOURS, true), tuner: new PageTuner(tuner), calibration, docs,
    remedy: "Plug the board in by USB and connect it in the view Port.",
  });
  offerOthers(views.open(fragment().get("view")), docs);
}

/** Other boards, and what there is to read. */
function offerOthers(shell: Shell, docs: string | null): void {
  shell.offer(choice());
  if (docs) shell.offer(el("a", { href: `${docs}index.html` }, "Documentation"));
}

async function showBench({ code, data, worker, tuner, calibration, firmware, docs }: Parts): Promise<void> {
  const board = new PageBoard(worker, code, data, firmware, browserStore);
  const session = new Session(board);
  const views = new Views({
    session, arm: { arm: async () => data.description }, services: null, bench: board, flashed: board, port: null,
    predictor: new PagePredictor(tuner, THE_BENCHS), tuner: new PageTuner(tuner), calibration, docs,
    remedy: "The firmware of a real board and a simulated arm run inside this page; they need a browser with WebAssembly. A board at a port needs none: choose it in the list Board.",
  });
  const { controller } = views;
  let state: PageState | null = null;
  let problem = "";
  try {
    state = stateOf(location.hash.slice(1), views.all.map(({ name }) => name), await board.controls());
  } catch (error) {
    problem = sentenceOf(error);
  }
  if (state) controller.showJoint(state.joint);
  const shell = views.open(state?.view ?? null);
  const copy = button("Copy link", () => void session.attempt(async () => copyLink(session, {
    view: shell.shown, joint: controller.shownJoint, ...board.condition(session.samples.newest("leader")), raw: await session.readParameters(),
  })), { title: "An address that opens this page as it is now", disabled: true });
  shell.offer(copy);
  offerOthers(shell, docs);
  whenDisabled(session, async () => {
    if (problem) session.tell(problem);
    await open(session, board, state);
    copy.disabled = false;
  });
}

/** The address bar has the link as well: not every browser lets a page write to the clipboard. */
async function copyLink(session: Session, state: PageState): Promise<void> {
  history.replaceState(null, "", `#${fragmentOf(state)}`);
  try {
    await navigator.clipboard.writeText(location.href);
    session.tell("The link is copied; it opens this page as it is now.", "info");
  } catch {
    session.tell("The link is in the address bar; copy it from there.", "info");
  }
}

/** Opens in a state, and enables: nobody stands near a simulated arm. But who has pressed Stop meant it. */
async function open(session: Session, board: PageBoard, state: PageState | null): Promise<void> {
  const change = (wishes: readonly BenchWish[]): Promise<boolean> => session.attempt(async () => {
    for (const wish of wishes) await board.change(wish);
  });
  if (state) {
    await change(state.sizes);
    await session.attempt(() => session.apply(state.raw));
  }
  if (!session.stopsAsked) await session.attempt(() => session.enable());
  if (state) await change(state.acts); // with the motors on, so that what comes of them is seen
}
