"""The paper from end to end: every table and figure computed anew, beside what is printed.

`request` says how much is done, `tasks` lists the pieces of work, `work` does them, `run` keeps their results, `pages`
turns these into a document, with `pictures`, and `render` writes it as HTML and PDF.
"""
