// The page's entry: takes the token out of the address, opens the board, and shows the views.

import "./page.css";
import { ArmView } from "./arm3d/view";
import { LeaderHand } from "./bench/hand";
import { BenchView } from "./bench/view";
import { ControllerView } from "./controller/view";
import { DoView } from "./do/view";
import type { Host } from "./host";
import { LiveView } from "./live/view";
import { LogsView } from "./logs/view";
import { el } from "./parts/dom";
import { tabStore } from "./parts/storage";
import { startTheme } from "./parts/theme";
import { Session } from "./session";
import { Shell } from "./shell";
import { ServerBoard } from "./sources/server";
import { ServerHost } from "./sources/server_host";

const KEY = "greywhale-token";

/** The secret of the server, out of the address bar and kept for a reload of this tab; it stays there where nothing is kept. */
function takeToken(): string {
  const given = new URLSearchParams(location.hash.slice(1)).get("token");
  if (given && tabStore.write(KEY, given)) history.replaceState(null, "", location.pathname);
  return given ?? tabStore.read(KEY) ?? "";
}

startTheme();
const token = takeToken();
const board = new ServerBoard(token);
const session = new Session(board);
const shell = new Shell(session, [new LiveView(session)], [
  "Plug the board in by USB: this page takes it by itself. Without a board, start ", el("code", {}, "greywhale dashboard --sim"),
  ": it brings a simulated arm with the real firmware.",
]);
if (token) addHost(new ServerHost(token, () => board.page));

/** Adds what needs a host beside the board. */
function addHost(host: Host): void {
  const arm = new ArmView(session, host);
  for (const view of [arm, new ControllerView(session, host), new DoView(session, host), new LogsView(session, host)]) {
    shell.add(view);
  }
  void session.attempt(async () => {
    if (!(await host.state()).sim) return;
    const hand = new LeaderHand(host.bench, session);
    arm.leadBy(hand);
    shell.add(new BenchView(session, host.bench, hand, host));
  });
}
