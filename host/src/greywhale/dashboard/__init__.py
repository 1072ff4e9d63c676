"""The page's server: one board shared among pages, the verbs as jobs, and the bench's hands."""
