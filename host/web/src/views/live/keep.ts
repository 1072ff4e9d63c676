// Where a recording of the page is kept: in the host's folder, as the verb record does, or as a download.

import { logText, type Episode } from "../../files/log";
import { download } from "../../parts/dom";
import type { Services } from "../../session/services";
import type { Session } from "../../session/session";

export interface Keeper {
  /** Where, as the end of a sentence. */
  readonly where: string;
  /** The names that are taken, as far as the page can know. */
  names(): Promise<readonly string[]>;
  /** Keeps a log: the name that it got, and the place as the end of a sentence. */
  keep(name: string, text: string): Promise<{ readonly name: string; readonly place: string }>;
  /** Deletes a log; null where only a person can. */
  readonly discard: ((name: string) => Promise<void>) | null;
}

export const DOWNLOADS: Keeper = {
  where: "downloads it as a file that greywhale reads",
  names: async () => [],
  keep: async (name, text) => {
    download(name, text);
    return { name, place: "among your browser's downloads" };
  },
  discard: null,
};

/** Keeps recordings where `greywhale record` does. */
export function inFolder(services: Pick<Services, "files" | "state">): Keeper {
  return {
    where: "keeps it in the folder of the view Files",
    names: async () => (await services.state()).files.map(({ name }) => name),
    keep: async (name, text) => {
      const [kept, { folder }] = [await services.files.bring(name, new Blob([text]), "rename"), await services.state()];
      return { name: kept, place: `in ${folder}, and in the view Files` };
    },
    discard: (name) => services.files.remove(name),
  };
}

/** Keeps the samples from `from` to before `to` as a log, and says where; its name, "" where no sample came. */
export async function keepLog(session: Session, keeper: Keeper, name: string, from: number, to: number, episode?: Episode): Promise<string> {
  const { samples, hello } = session;
  const lost = from < samples.first ? " This page keeps the last ten minutes: the log begins with them." : "";
  const begin = Math.max(from, samples.first);
  if (to <= begin) return "";
  const text = logText(samples, begin, to, { hello, raw: await session.readParameters() }, episode);
  const kept = await keeper.keep(name, text);
  session.tell(`${kept.name} is ${kept.place}.${lost}`, "info");
  return kept.name;
}
