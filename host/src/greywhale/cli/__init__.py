"""The command line: `greywhale VERB`. One module a verb; `entry` turns every failure into a sentence and an
exit code.
"""
