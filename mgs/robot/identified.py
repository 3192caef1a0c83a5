"""Servos whose motor and friction have been measured.

Parameters identified by Duclusaud, Passault, Padois and Ly, "Extended Friction Models for the
Physics Simulation of Servo Actuators", IEEE Int. Conf. on Robotics and Automation (ICRA), 2025
(their model M6, values published with their project BAM under the Apache licence 2.0). The motor
is driven in proportion to the position error, by a duty cycle of the supply voltage:

    duty   = clip(gain * error_gain * (q_command - q), -max_duty, max_duty)
    torque = torque_constant (duty * supply - torque_constant v) / resistance

so that its stiffness, stall torque, no-load speed and damping follow. The friction law is that of
`mgs.robot.friction`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Motor:
    """A DC motor behind its gear, and the electronics that drive it."""

    torque_constant: float  # [N m/A]
    resistance: float  # [ohm]
    armature: float  # inertia of the rotor, reflected to the joint [kg m^2]
    supply: float  # voltage that it was identified at [V]
    gain: float  # proportional gain of the firmware that it was identified at
    error_gain: float  # duty cycle for each unit of gain and radian of error [1/rad]
    max_duty: float  # largest duty cycle

    def stall_torque(self, supply: float) -> float:
        """Torque at speed 0 and the largest duty cycle [N m]."""
        return self.max_duty * supply * self.torque_constant / self.resistance

    def no_load_speed(self, supply: float) -> float:
        """Speed at torque 0 and the largest duty cycle [rad/s]."""
        return self.max_duty * supply / self.torque_constant

    def stiffness(self, gain: float, supply: float) -> float:
        """Torque for each radian of error [N m/rad]."""
        return gain * self.error_gain * supply * self.torque_constant / self.resistance

    @property
    def damping(self) -> float:
        """Torque lost by the back-EMF [N m s/rad]."""
        return self.torque_constant**2 / self.resistance


@dataclass(frozen=True, kw_only=True)
class FrictionParameters:
    """Parameters of the friction law of `mgs.robot.friction` for one gear."""

    base: float  # [N m]
    stribeck: float  # [N m]
    motor: float
    external: float
    motor_stribeck: float
    external_stribeck: float
    motor_quadratic: float  # [1/(N m)]
    external_quadratic: float  # [1/(N m)]
    stribeck_speed: float  # [rad/s]
    stribeck_exponent: float
    viscous: float  # [N m s/rad]

    def scaled(self, torque: float, speed: float) -> FrictionParameters:
        """Parameters of a similar gear whose torques and speeds are larger by these factors."""
        return FrictionParameters(
            base=torque * self.base,
            stribeck=torque * self.stribeck,
            motor=self.motor,
            external=self.external,
            motor_stribeck=self.motor_stribeck,
            external_stribeck=self.external_stribeck,
            motor_quadratic=self.motor_quadratic / torque,
            external_quadratic=self.external_quadratic / torque,
            stribeck_speed=speed * self.stribeck_speed,
            stribeck_exponent=self.stribeck_exponent,
            viscous=torque / speed * self.viscous,
        )


NO_FRICTION = FrictionParameters(
    base=0.0,
    stribeck=0.0,
    motor=0.0,
    external=0.0,
    motor_stribeck=0.0,
    external_stribeck=0.0,
    motor_quadratic=0.0,
    external_quadratic=0.0,
    stribeck_speed=1.0,
    stribeck_exponent=1.0,
    viscous=0.0,
)

MOTORS = {
    "bam/mx64": Motor(
        torque_constant=1.6016832750318712,
        resistance=2.3164043271967447,
        armature=0.012265893049213158,
        supply=15.0,
        gain=32.0,
        error_gain=0.158,
        max_duty=0.9625,
    ),
    "bam/mx106": Motor(
        torque_constant=2.209828156174588,
        resistance=2.033661749312417,
        armature=0.026016184370993383,
        supply=15.0,
        gain=32.0,
        error_gain=0.158,
        max_duty=0.9625,
    ),
    "bam/xl320": Motor(
        torque_constant=1.0088269677439867,
        resistance=31.585877261639528,
        armature=0.0011629864934131363,
        supply=7.5,
        gain=32.0,
        error_gain=0.05048199,
        max_duty=1.0,
    ),
    "bam/xl330": Motor(
        torque_constant=0.36601349688984386,
        resistance=2.8113923539223227,
        armature=0.0018077432831600838,
        supply=7.5,
        gain=400.0,
        error_gain=4096.0 / (2.0 * math.pi) / (256.0 * 885.0),
        max_duty=1.0,
    ),
}

FRICTION = {
    "bam/mx64": FrictionParameters(
        base=6.217919698787649e-07,
        stribeck=0.12269525980968875,
        motor=0.3114720375111298,
        external=2.0462014258729542e-08,
        motor_stribeck=0.18774381222411038,
        external_stribeck=0.014065853481003015,
        motor_quadratic=0.006908512882777861,
        external_quadratic=0.009999980627672081,
        stribeck_speed=2.575277366960116,
        stribeck_exponent=0.8409018066017007,
        viscous=0.02533701181690149,
    ),
    "bam/mx106": FrictionParameters(
        base=1.0232526438525893e-05,
        stribeck=0.12195409579603411,
        motor=0.19800553725822115,
        external=0.022215529897348624,
        motor_stribeck=0.19859970173941574,
        external_stribeck=0.08710328264676681,
        motor_quadratic=0.009999930103371748,
        external_quadratic=7.326919843140997e-05,
        stribeck_speed=1.7463251741328727,
        stribeck_exponent=1.142827788004191,
        viscous=0.05071566473605552,
    ),
    "bam/xl320": FrictionParameters(
        base=4.333784350288425e-07,
        stribeck=0.016305511369376878,
        motor=3.0882140904620497e-06,
        external=0.158325301089096,
        motor_stribeck=5.965719077390517e-09,
        external_stribeck=0.24548304071888186,
        motor_quadratic=0.0036164099909151977,
        external_quadratic=0.00471092869180762,
        stribeck_speed=2.3010537332753387,
        stribeck_exponent=1.7067361543333317,
        viscous=0.007225172246502409,
    ),
    "bam/xl330": FrictionParameters(
        base=0.004771183165566,
        stribeck=0.004676345799486616,
        motor=0.2667860954283698,
        external=8.515871897059342e-06,
        motor_stribeck=1.0722918395099123e-05,
        external_stribeck=0.08077928978935671,
        motor_quadratic=0.009972471242139415,
        external_quadratic=0.004902565732332559,
        stribeck_speed=2.890372094130307,
        stribeck_exponent=8.683259907618984,
        viscous=0.005359668274599504,
    ),
}
