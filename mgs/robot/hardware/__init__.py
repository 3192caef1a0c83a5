"""Real servos: a bus of Dynamixel servos, and a player that streams goals to it.

Arrays of encoder ticks come in; what the motion was that they belong to is not known here. The
library dynamixel-sdk (extra `dynamixel`) is imported when a port is opened.
"""
