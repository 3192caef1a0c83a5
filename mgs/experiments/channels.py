"""Balance motions with the amplitude and speed of their waves multiplied."""

from __future__ import annotations

from mgs.gait import BalanceGait

AMPLITUDES = ("amplitude", "width", "height")  # keys of sines and figure eights


def scaled_waves(gait: BalanceGait, amplitude: float, speed: float) -> BalanceGait:
    """Gait with the waves of its channels multiplied; constant and ramp channels remain.

    Args:
        gait: motion on both feet.
        amplitude: factor on amplitudes, or on width and height of a figure eight.
        speed: factor on frequencies.
    """
    factors = {**dict.fromkeys(AMPLITUDES, amplitude), "frequency": speed}
    channels = []
    for channel in gait.balance.channels:
        keys = type(channel).model_fields.keys() & factors.keys()
        change = {key: factors[key] * getattr(channel, key) for key in keys}
        channels.append(channel.model_copy(update=change))
    balance = gait.balance.model_copy(update={"channels": channels})
    return gait.model_copy(update={"balance": balance})
