"""Numbers that turn the words of the article into comparisons; fixed before any result was seen."""

SIGNIFICANT = 0.10  # least relative reduction that is "significant", largest that is "slight"
ENCODER_STEP = 300.0 / 1024.0  # [deg] of both types of servo; a joint that moves less stands still
LAST_STRIDES = 5  # number of strides at the end of the long walk that are compared: ten steps
