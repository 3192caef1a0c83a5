"""Limits on what mgs reads and makes, so that no input costs much more than it asks for.

docs/security.md lists every limit with its reason; a test compares the two.
"""

from __future__ import annotations

# Files
MAX_FILE = 1_000_000  # [bytes] of a gait, robot.yaml, sweep or table
MAX_URDF = 20_000_000  # [bytes] of a URDF
MAX_MESH = 200_000_000  # [bytes] of a mesh that `mgs robot init` reads
MAX_LOG = 50_000_000  # [bytes] of a CSV log of a robot
MAX_NESTING = 30  # of lists and mappings in a YAML file

# URDF
MAX_XML_ELEMENTS = 100_000
MAX_XML_NESTING = 50  # of elements in a URDF
MAX_LINKS = 1000  # of a robot; as many joints
MAX_CHAIN = 100  # joints, fixed ones included, between the root link and any other link
MAX_SHAPES = 200  # collision shapes in a robot folder; the number of pairs grows with the square
MAX_INCLUDES = 100  # files that an MJCF includes

# Gaits
MAX_STEPS = 20_000  # of a walk
MAX_SAMPLES = 2_000_000  # of one motion, a sequence included; their arrays take about 5 GB
MAX_PARTS = 1000  # of a sequence
MAX_RATE = 10_000  # [Hz] of an export, which is faster than any bus of servos

# Motion files
MAX_RECORD = 1 << 28  # [bytes] of a record or an unpacked chunk
MAX_SUMMARY = 1 << 24  # [bytes] of the index at the end of the file
MAX_RATIO = 100  # largest ratio of the unpacked size of all chunks to the size of the file
MAX_ATTACHMENT = 2_000_000  # [bytes] of the gait in a motion file, which has all defaults
MAX_BOXES = 100  # on the floor
MAX_CROWD = 5  # boxes that touch one square of 0.1 m x 0.1 m
MAX_BALLS = 10  # on the floor
MAX_RECORDING = 1_000_000_000  # [bytes] of a motion in a format of another program, unpacked
MAX_VALUE = 1e9  # of a number of such a motion, in units of SI
MAX_CHANNELS = 3000  # columns of such a motion, or joints or links of it

# Searches
MAX_JOURNAL = 100_000_000  # [bytes] of the journal of `mgs tune`; a walk takes about 3 kB

# Sweeps and gait libraries
MAX_GAITS = 1_000_000  # of a library
MAX_VALUES = 5_000_000  # gaits times varied keys
MAX_CONDITION = 2000  # [characters] of a filter or of --where
MAX_CONDITION_NESTING = 25  # the parser of SQLite accepts about 100 brackets
MAX_QUERY_STEPS = 2_000_000_000  # instructions of SQLite in one query
