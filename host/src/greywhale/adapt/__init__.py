"""Adaptation: the controllers stay right while a person works with the arm. The paper's wish: online tuning."""
