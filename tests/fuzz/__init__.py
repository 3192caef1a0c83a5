"""Random malformed inputs for every format that mgs reads, through the commands that read it.

`python -m tests.fuzz` runs any number of them and prints a table of what happened; `test_fuzz.py`
runs a few with every test. Each input is tried in a process of its own, so that a crash, a hang or
a memory leak is counted and does not end the run.
"""
