"""Judgement: margins, held-out motions, the least possible error, and the choice of candidates that go together."""
