"""Judgement: margins, motions held out, the least possible error, and which candidates go together."""
