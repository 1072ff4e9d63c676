// The page that the dashboard's server hands out: gets its token, opens the board, and shows the views; first the one that the
// address names (#view=live).

import "../page.css";
import { startTheme } from "../parts/theme";
import { Session } from "../session/session";
import { findAccess, type Access } from "../sources/access";
import { HostServices } from "../sources/host_services";
import { ServerBoard } from "../sources/server";
import { LiveView } from "../views/live/view";
import { Shell } from "../views/shell";
import { Views } from "./views";
import { letFollow } from "./when_disabled";

startTheme();
const asked = new URLSearchParams(location.hash.slice(1)).get("view"); // before the address loses its ticket
void findAccess().then(begin);

async function begin({ token, sentence }: Access): Promise<void> {
  const board = new ServerBoard(token, sentence);
  const session = new Session(board);
  if (!token) { // no board would help
    const live = new LiveView(session);
    new Shell(session, [live], "", live, () => undefined);
    return;
  }
  const services = new HostServices(token, () => board.page);
  let [sim, follows] = [false, false];
  await session.attempt(async () => { ({ sim, follows } = await services.state()); });
  const views = new Views({
    session, arm: services, services, bench: sim ? services.bench : null, flashed: null, port: null,
    predictor: services.predictor, tuner: services.tuner, calibration, docs: null,
    remedy: "Plug the board in by USB: this page takes it by itself. Without a board, start `greywhale dashboard --sim`: it brings a simulated arm with the real firmware.",
  });
  views.open(asked);
  if (follows) letFollow(session);
}

/** The rules of a calibration, a file beside the page. */
async function calibration(): Promise<ArrayBuffer> {
  const answer = await fetch(new URL("calibration.wasm", import.meta.url));
  if (!answer.ok) throw new Error(`calibration.wasm is missing beside this page (${answer.status})`);
  return answer.arrayBuffer();
}
