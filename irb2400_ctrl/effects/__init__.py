"""Physical effects that the base model may lack, one file each."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from irb2400_ctrl.effects.added_body import LinkInertia, Payload
from irb2400_ctrl.effects.balancer import Balancer
from irb2400_ctrl.effects.base import Effect, Signals
from irb2400_ctrl.effects.base_tilt import BaseTilt
from irb2400_ctrl.effects.cable_spring import CableSpring
from irb2400_ctrl.effects.coulomb_asymmetry import CoulombAsymmetry
from irb2400_ctrl.effects.coulomb_change import CoulombChange
from irb2400_ctrl.effects.elastic_joint import ElasticJoint
from irb2400_ctrl.effects.encoder_zero import EncoderZero
from irb2400_ctrl.effects.gear_ripple import GearRipple
from irb2400_ctrl.effects.hysteresis import Hysteresis
from irb2400_ctrl.effects.linkage_inertia import LinkageInertia
from irb2400_ctrl.effects.load_friction import LoadFriction
from irb2400_ctrl.effects.process_force import ProcessForce
from irb2400_ctrl.effects.rotor_inertia import RotorInertia
from irb2400_ctrl.effects.time_delay import TimeDelay
from irb2400_ctrl.effects.torque_gain import TorqueGain
from irb2400_ctrl.effects.torque_offset import TorqueOffset
from irb2400_ctrl.effects.transmission_backlash import TransmissionBacklash
from irb2400_ctrl.effects.viscous_change import ViscousChange
from irb2400_ctrl.effects.viscous_power import ViscousPower
from irb2400_ctrl.effects.viscous_warmup import ViscousWarmup
from irb2400_ctrl.effects.wrist_coupling import WristCoupling

LIBRARY: dict[str, type[Effect]] = {
    effect.model_fields["kind"].default: effect
    for effect in (
        Balancer,
        BaseTilt,
        CableSpring,
        CoulombAsymmetry,
        CoulombChange,
        ElasticJoint,
        EncoderZero,
        GearRipple,
        Hysteresis,
        LinkInertia,
        LinkageInertia,
        LoadFriction,
        Payload,
        ProcessForce,
        RotorInertia,
        TimeDelay,
        TorqueGain,
        TorqueOffset,
        TransmissionBacklash,
        ViscousChange,
        ViscousPower,
        ViscousWarmup,
        WristCoupling,
    )
}

AnyEffect = Annotated[
    Balancer
    | BaseTilt
    | CableSpring
    | CoulombAsymmetry
    | CoulombChange
    | ElasticJoint
    | EncoderZero
    | GearRipple
    | Hysteresis
    | LinkInertia
    | LinkageInertia
    | LoadFriction
    | Payload
    | ProcessForce
    | RotorInertia
    | TimeDelay
    | TorqueGain
    | TorqueOffset
    | TransmissionBacklash
    | ViscousChange
    | ViscousPower
    | ViscousWarmup
    | WristCoupling,
    Field(discriminator="kind"),
]
"""what a robot file may hold under [[effects]]"""

__all__ = ["LIBRARY", "AnyEffect", "Effect", "Signals"]
