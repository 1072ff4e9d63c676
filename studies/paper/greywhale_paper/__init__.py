"""The paper from end to end: every table and figure computed anew, beside what is printed; and its optimisers compared.

`request` says how much is done, `tasks` lists the pieces of work, `work` does them, `run` keeps their results, `pages`
turns these into a document, with `pictures`, and `render` writes it as HTML and PDF. `optimisers` compares methods on
standard functions. `verbs` names what `greywhale` finds here, `cli` holds it.
"""
