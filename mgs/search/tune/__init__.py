"""Search for the parameters of a walk that make it robust, fast or efficient.

`space` says which keys of a gait file are varied and how far, `objective` what is wanted of a
walk, `evaluate` judges one set of values in stages from the cheapest to the dearest, `study`
searches, and `compare` measures the result on random conditions that the search has not seen.
"""
