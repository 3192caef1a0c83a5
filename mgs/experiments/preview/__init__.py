"""ZMP preview control: the example of the paper, closed-loop analysis, and any gait's generator.

ZMP is the zero-moment point; the method is that of Kajita et al., "Biped walking pattern generation
by using preview control of zero-moment point", ICRA, 2003. The study repeats the example of the
paper, a cart-table with two preview windows, and the compensation of the model error on walks of
two robots. It also shows the response to a step of the reference that is known in advance, and the
influence of the weight of the jerk on fast steps. `mgs.experiments.preview.design` analyses the
generator of any gait with python-control.

The text of the paper is not part of this project. Its sentences are restated from the published
paper from memory, so that their wording and section numbers could not be compared with the text.
"""

from mgs.experiments.preview.claims import all_claims
from mgs.experiments.preview.study import solve
from mgs.experiments.preview.variants import VARIANTS

__all__ = ["VARIANTS", "all_claims", "solve"]
