"""The search: what is varied, what it costs on the training motions, optimisers in lockstep, and their journal."""
