"""The score (docs/score.md): the cheapest way to simulate a scene at an error of the motion.

`settings` has a setting, its kinds and the axes on which settings differ; `scenes` the scenes with their draws; `runs`
simulates settings and keeps what they gave; `search` finds those that may be the cheapest of their kind; `sitting` times
these; `verdicts` has all statistics, `answers` the tables.
"""
