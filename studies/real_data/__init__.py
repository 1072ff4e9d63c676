"""Reads recordings of other people's rigs: what is published of each rig, and its files as records of one joint."""
