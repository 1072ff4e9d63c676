"""The search: what it varies, what that costs on the training motions, optimisers in lockstep, and their journal."""
