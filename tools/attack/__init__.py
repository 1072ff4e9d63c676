"""Attacks: the same measurement over so many random trials that a table of counts can be published."""
