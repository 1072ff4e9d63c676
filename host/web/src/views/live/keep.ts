// Where a recording of the page is kept: in the host's folder, as the verb record does, or as a download.

import { download } from "../../parts/dom";
import type { Services } from "../../session/services";

export interface Keeper {
  /** Where, as the end of a sentence. */
  readonly where: string;
  /** Keeps a log, and says where it is. */
  keep(name: string, text: string): Promise<string>;
}

export const DOWNLOADS: Keeper = {
  where: "downloads it as a file that greywhale reads",
  keep: async (name, text) => {
    download(name, text);
    return `${name} is among your browser's downloads.`;
  },
};

/** Keeps recordings where `greywhale record` does. */
export function inFolder(services: Pick<Services, "files" | "state">): Keeper {
  return {
    where: "keeps it in the folder of the view Files",
    keep: async (name, text) => {
      const [kept, { folder }] = [await services.files.bring(name, new Blob([text]), "rename"), await services.state()];
      return `${kept} is in ${folder}, and in the view Files.`;
    },
  };
}
