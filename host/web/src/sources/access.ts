// Gets a page its server's token: for the ticket in its address, from its own tab, or from another page that is open.

const CHANNEL = "greywhale-token";
const NAME = "greywhale-token:";
const NEWEST = "newest:"; // before a token that a ticket gave just now
const ANSWER_MS = 300; // from another page of this browser

export type Access = { readonly token: string; readonly sentence: string };

/** The token, "" where there is none, and why, in a sentence. The address loses its ticket before anything else happens. */
export async function findAccess(): Promise<Access> {
  const ticket = new URLSearchParams(location.hash.slice(1)).get("ticket");
  history.replaceState(null, "", location.pathname);
  addEventListener("hashchange", () => location.reload()); // a new address in the tab of the old one
  let sentence = "This address opens no page; press Enter in the terminal of `greywhale dashboard`, and open the address that it prints then.";
  let token = "";
  if (ticket) {
    const answer = await exchange(ticket);
    if (answer.ok) ({ token } = await answer.json() as { token: string });
    else sentence = await answer.text();
  }
  const newest = token !== "";
  token ||= window.name.startsWith(NAME) ? window.name.slice(NAME.length) : await fromOthers();
  if (token) {
    // For a reload. It lasts as long as the tab, and a foreign page there gets another one; no file keeps it, as the tab's storage.
    window.name = NAME + token;
    tellOthers(token, newest);
  }
  return { token, sentence };
}

async function exchange(ticket: string): Promise<Response> {
  try {
    return await fetch("/enter", { method: "POST", headers: { "X-Greywhale-Ticket": ticket } });
  } catch {
    return new Response("The dashboard's server does not answer; start `greywhale dashboard` again.", { status: 503 });
  }
}

function fromOthers(): Promise<string> {
  const channel = new BroadcastChannel(CHANNEL);
  return new Promise<string>((found) => {
    channel.onmessage = ({ data }: MessageEvent<string>) => {
      if (data && !data.startsWith(NEWEST)) found(data);
    };
    setTimeout(() => found(""), ANSWER_MS);
    channel.postMessage("");
  }).finally(() => channel.close());
}

/**
 * Answers pages of this browser that ask, as a second tab or a copied address does. Pages of a server that was there before
 * at this address hear the `newest` token, and begin anew with it.
 */
function tellOthers(token: string, newest: boolean): void {
  const channel = new BroadcastChannel(CHANNEL);
  channel.onmessage = ({ data }: MessageEvent<string>) => {
    if (!data) channel.postMessage(token);
    if (!data.startsWith(NEWEST) || data === NEWEST + token) return;
    window.name = NAME + data.slice(NEWEST.length);
    location.reload();
  };
  if (newest) channel.postMessage(NEWEST + token);
}
