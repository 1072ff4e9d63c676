"""The paper from end to end: every table and figure computed anew, beside what is printed.

`request` says how much is done, `tasks` lists the pieces of work, `work` does them, `pages` turns the results into a
document, and `render` writes that as HTML and PDF.
"""
