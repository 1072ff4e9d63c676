"""The verbs that `greywhale` finds here: reproduce and compare."""
