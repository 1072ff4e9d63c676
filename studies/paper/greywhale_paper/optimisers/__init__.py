"""Optimisers side by side on standard functions, at equal budgets."""
