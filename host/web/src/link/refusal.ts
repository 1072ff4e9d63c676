// Words for a board's refusals and faults: what is wrong, with which joint or parameter, and the remedy.

import { Fault, LeadRefusal, NackCode, Refusal, State, TABLE, type Nack, type StatusReply } from "./schema";

const ENABLE_ERROR_RAD = 1 / 32; // one count of error_too_large

/** One sentence for a refused request, as the terminal has it. */
export function refusalSentence(request: string, nack: Nack): string {
  const code = NackCode.of(nack.code);
  const low = nack.detail & 0xff;
  let remedy = code.remedy;
  if (nack.code === NackCode.is.set_refused) remedy = Refusal.of(low).remedy;
  if (nack.code === NackCode.is.lead_refused) remedy = LeadRefusal.of(low).remedy;
  const detail = detailText(nack);
  return `The board refused "${request.replaceAll("_", " ")}": ${code.description}${detail && ` (${detail})`}: ${lowerFirst(remedy)}`;
}

function detailText({ code, detail }: Nack): string {
  const high = detail >> 8;
  const low = detail & 0xff;
  switch (code) {
    case NackCode.is.bad_index:
    case NackCode.is.out_of_range:
    case NackCode.is.inconsistent:
      return TABLE.parameters[detail]?.name ?? `index ${detail}`;
    case NackCode.is.set_refused:
      return `joint ${high}, ${Refusal.of(low).description}`;
    case NackCode.is.lead_refused:
      return `${low === LeadRefusal.is.limit ? `joint ${high}, ` : ""}${LeadRefusal.of(low).description}`;
    case NackCode.is.error_too_large:
      return `joint ${high}, ${(low * ENABLE_ERROR_RAD).toFixed(2)} rad${low === 0xff ? " or more" : ""}`;
    case NackCode.is.not_disabled:
      return `it is in state ${State.of(detail).name}`;
    case NackCode.is.in_fault:
      return Fault.of(detail).description;
    case NackCode.is.pot_bad:
      return potName(high);
    case NackCode.is.unknown_type:
    case NackCode.is.bad_length:
      return `${NackCode.of(code).detail} is ${detail}`;
    default:
      return "";
  }
}

/** The fault of a status in words, with where it is and the remedy. */
export function faultSentence(status: Pick<StatusReply, "fault" | "fault_where">): string {
  const fault = Fault.of(status.fault);
  const place = faultPlace(status);
  return `${upperFirst(fault.description)}${place ? ` (${place.words})` : ""}. ${fault.remedy}`;
}

/** The joint at which a fault sits, and its part there in words; null for a fault of the whole board. */
export function faultPlace({ fault, fault_where: where }: Pick<StatusReply, "fault" | "fault_where">): { joint: number; words: string } | null {
  if (where === 0xff) return null;
  const pots = [Fault.is.pot_low, Fault.is.pot_high, Fault.is.leader_jump].some((one) => one === fault);
  return { joint: where % 4, words: pots ? potName(where) : `joint ${where}` };
}

/** 0..3 are the leader's potentiometers, 4..7 the follower's. */
export function potName(number: number): string {
  return number < 4 ? `leader potentiometer ${number}` : `follower potentiometer ${number - 4}`;
}

export function upperFirst(text: string): string {
  return text.slice(0, 1).toUpperCase() + text.slice(1);
}

/** Makes a sentence fit inside another; a first word such as EEPROM keeps its capitals. */
function lowerFirst(text: string): string {
  return /^.[A-Z]/.test(text) ? text : text.slice(0, 1).toLowerCase() + text.slice(1);
}
