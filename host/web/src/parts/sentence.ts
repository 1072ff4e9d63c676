// The sentence that a person gets for an error.

export function sentenceOf(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}
