"""Does a robot description make sense? Notes in plain words on what looks wrong."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.model.consistency import check
from irb2400_ctrl.model.model import Model
from irb2400_ctrl.robot import Body, Robot

FAR_M = 2.0
"""a centre of mass farther from its link's frame is more likely a slip of unit [m]"""
EARTH_M_S2 = (9.0, 10.5)
DENSEST_KG_M2 = 5.0
"""largest radius of gyration squared that a link may have [m2]"""
GYRATION = 0.7
"""and largest radius of gyration over the distances between the arm's axes"""
LIGHT_KG = 0.2
"""a body that weighs less may be small"""
LEAST_GYRATION_M = 2e-3
"""smallest radius of gyration of one that weighs more [m]"""
DENSEST_KG_M3 = 20_000.0
"""no body of tungsten has less inertia for its mass than a ball of this density"""
BESIDE = 0.5
"""distance of a centre of mass from its link over the distances between the arm's axes"""
POSTURES = 200
"""in which the arm's weight is felt"""
OVERLOADED = 3.0
"""weight over torque limit above which one of them has another unit"""
IDLE = 1.0 / 300.0
"""and below which, on the joint that feels it most"""
FELT = 1e-9
"""a joint that feels less of the largest torque stands along gravity [-]"""
STUCK = 0.5
"""friction over torque limit above which a joint would hardly move [-]"""
LONGEST_M = 10.0
"""a link longer than this is more likely a slip of unit [m]"""
LONGEST_CM = 300.0
"""one longer than this is that of no arm in centimetres, either [cm]"""
HEAVIEST_KG = 5000.0
"""so is a heavier one"""
FARTHEST_M = 15.0
"""so is an arm that reaches further"""
SHORTEST_M = 0.05
"""an arm that reaches less far is more likely a slip of unit [m]"""
CENTRED = (1e-6, 1e-3)
"""distances of all centres of mass from their frames over the reach: more than rounding leaves, and
less than any links have"""
OFF_CENTRE = 0.4
"""share of a link's largest moment from which that of its mass in the centre of mass tells about
which point it is [-]"""
FAST_DEG_S = 2000.0
SLOW_DEG_S = 13.0
"""two turns a second, taken for degrees: the slowest joints of large arms turn faster"""
WIDE_DEG = 1000.0
NARROW_DEG = 7.0


def plausibility(robot: Robot) -> list[str]:
    """What looks wrong, in the order of the file; empty when nothing does."""
    notes = _gravity(robot)
    reach = robot.reach
    most = min(DENSEST_KG_M2, (GYRATION * reach) ** 2) if reach > 0.0 else DENSEST_KG_M2
    lengths = [float(np.linalg.norm(link.frame.matrix()[:3, 3])) for link in robot.links]
    for link, length in zip(robot.links, lengths, strict=True):
        if length > LONGEST_M:
            unit = "mm" if length > LONGEST_CM else "mm or cm"
            notes.append(
                f"{link.name}: its joint is {length:.4g} m further on; it looks like {unit}"
            )
        notes += _body(link.name, link.body, most)
    notes += _masses(robot)
    notes += too_dense(robot)
    notes += _about_the_frames(robot)
    notes += _size(robot, max(lengths)) or _centred(robot)
    notes += _beside(robot) or _weight(robot)
    notes += _friction(robot)
    notes += _rotors(robot)
    if robot.tool is not None:
        notes += _body(robot.tool.name, robot.tool.body, most)
    notes += [issue.sentence for issue in check(robot) if issue.kind != "massless"]
    for joint in robot.joints:
        low, high = joint.limits.range_deg
        if max(abs(low), abs(high)) > WIDE_DEG:
            notes.append(f"{joint.name}: range {low:g} to {high:g} deg is several turns")
        if high - low < NARROW_DEG:
            notes.append(
                f"{joint.name}: range {low:g} to {high:g} deg is narrow; it looks like radians"
            )
    return notes + _fast(robot)


def _fast(robot: Robot) -> list[str]:
    """Speed limits that no joint comes to, or that are all of none."""
    speeds = {joint.name: joint.limits.speed_deg_s or 0.0 for joint in robot.joints}
    found = {name: f"{speed:g}" for name, speed in speeds.items() if speed > FAST_DEG_S}
    if not found:
        fastest = max(speeds.values())
        if not all(speeds.values()) or fastest > SLOW_DEG_S:
            return []
        return [
            f"no joint may turn faster than {fastest:.3g} deg/s; the speed limits look like rad/s"
        ]
    values = ", ".join(dict.fromkeys(found.values()))
    return [f"{', '.join(found)}: speed limit {values} deg/s is beyond any arm's"]


def _gravity(robot: Robot) -> list[str]:
    g = robot.gravity
    size = float(np.linalg.norm(g))
    low, high = EARTH_M_S2
    if not low < size < high:
        return [f"gravity is {size:.4g} m/s2, expected about 9.81"]
    if g[2] > 0.9 * size:
        return ["gravity points up in the base frame: the sign is wrong unless the arm hangs"]
    return []


def _beside(robot: Robot) -> list[str]:
    """Several centres of mass far from the way between the axes of their links."""
    found = {}
    frames = [*(link.frame for link in robot.links[1:]), robot.flange]
    for link, frame in zip(robot.links, frames, strict=True):
        com = np.array(link.body.com_m)
        end = frame.matrix()[:3, 3]
        length = float(end @ end)
        along = float(np.clip(com @ end / length, 0.0, 1.0)) if length else 0.0
        distance = float(np.linalg.norm(com - along * end))
        if link.body.mass_kg > 0.0 and 0.0 < BESIDE * robot.reach < distance <= FAR_M:
            found[link.name] = f"{distance:.2g}"
    if len(found) < 2:
        return []
    return [
        f"{', '.join(found)}: the centres of mass are {', '.join(found.values())} m beside their "
        "links; it looks like the base's frame, expected each in its own link's"
    ]


def _size(robot: Robot, longest: float) -> list[str]:
    """An arm that would stand on a fingertip, or one that reaches over houses though its longest
    link [m] is short."""
    if longest <= LONGEST_M and robot.reach > FARTHEST_M:
        return [
            f"the arm reaches {robot.reach:.3g} m; its lengths look like cm or dm read as metres"
        ]
    if not 0.0 < robot.reach < SHORTEST_M:
        return []
    return [f"the arm reaches {1e3 * robot.reach:.3g} mm; its lengths look like metres read as mm"]


def _centred(robot: Robot) -> list[str]:
    """Centres of mass that are all next to nothing beside the arm, or nothing."""
    far = max(float(np.linalg.norm(link.body.com_m)) for link in robot.links)
    least, most = (share * robot.reach for share in CENTRED)
    weighing = sum(link.body.mass_kg > 0.0 for link in robot.links)
    if far == 0.0 and weighing > 2 and not unknown_bodies(robot):
        return [
            "all centres of mass are in the origins of their links' frames: a placeholder, with "
            "which the weight is felt wrongly; expected each link's own"
        ]
    if not least < far < most:
        return []
    return [
        f"all centres of mass are within {1e3 * far:.2g} mm of their links' frames; they look like "
        "metres read as mm"
    ]


def _about_the_frames(robot: Robot) -> list[str]:
    """Inertias about the frames of the links, as CAD programs list them, too.

    Take off what the mass in its centre makes about the frame: what is left of such a one is a
    body that can exist. Of one about the centre of mass that is far from the frame it is none.
    """
    told = {}
    for link in robot.links:
        body = link.body
        com = np.array(body.com_m)
        shift = body.mass_kg * (com @ com * np.eye(3) - np.outer(com, com))
        largest = float(np.linalg.eigvalsh(body.tensor())[2])
        if body.mass_kg * com @ com > OFF_CENTRE * largest > 0.0:
            least, middle, most = np.linalg.eigvalsh(body.tensor() - shift)
            told[link.name] = least >= 0.0 and least + middle >= most
    if len(told) < 3 or not all(told.values()):
        return []
    return [
        f"{', '.join(told)}: the inertias look as if they were about the frames of the links: "
        "without what the distance of the centre of mass adds, all are still those of bodies; "
        "expected them about the centre of mass"
    ]


def _weight(robot: Robot) -> list[str]:
    """Torque limits that the arm's weight has nothing to do with: masses or limits of another
    unit."""
    if robot.weightless or np.isinf(robot.tau_bound).all():
        return []
    rng = np.random.default_rng(1)
    low = np.clip(robot.q_min, -np.pi, np.pi)
    high = np.clip(robot.q_max, -np.pi, np.pi)
    q = rng.uniform(np.minimum(low, high), np.maximum(low, high), (POSTURES, robot.n))
    still = np.zeros_like(q)
    torque = np.abs(Model(robot).inverse_dynamics(q, still, still, friction=False)).max(axis=0)
    share = torque / robot.tau_bound
    j = int(np.argmax(share))
    name = robot.joints[j].name
    asked = (
        f"{name}: the arm's weight asks for up to {torque[j]:.3g} of {robot.tau_bound[j]:.3g} Nm"
    )
    if share[j] > OVERLOADED:
        return [f"{asked}; masses look like grams, or limits like another unit"]
    if torque[j] > FELT * torque.max() and share[j] < IDLE:
        return [f"{asked}, and of no other joint for more; limits look like another unit"]
    return []


def _rotors(robot: Robot) -> list[str]:
    """Joints whose transmission states a rotor that nothing in the file adds to the dynamics."""
    said = {effect.joint for effect in robot.effects if effect.motor_inertia is not None}
    left_out = {
        joint.name: reflected
        for place, joint in enumerate(robot.joints, 1)
        if joint.transmission and (reflected := joint.transmission.reflected_inertia)
        if place not in said
    }
    if not left_out:
        return []
    return [
        f"{', '.join(left_out)}: motor_inertia_kgm2 and gear_ratio make "
        f"{', '.join(f'{J:.3g}' for J in left_out.values())} kg m2, which no torque holds before "
        'an effect of kind "rotor_inertia" states it'
    ]


def _friction(robot: Robot) -> list[str]:
    """Joints that have hardly any torque left beside their friction: a simulation's damping."""
    speed = np.minimum(1.0, [np.radians(j.limits.speed_deg_s or np.inf) for j in robot.joints])
    torque = robot.friction[:, 1] + robot.friction[:, 2] * speed
    much = [j for j in range(robot.n) if torque[j] > STUCK * robot.tau_bound[j]]
    if not much:
        return []
    j = much[0]
    return [
        f"{', '.join(robot.joints[k].name for k in much)}: friction is most of the torque limit "
        f"({torque[j]:.3g} of {robot.tau_bound[j]:.3g} Nm at {speed[j]:.2g} rad/s); is it the "
        "arm's, or damping that keeps a simulation steady?"
    ]


def _masses(robot: Robot) -> list[str]:
    """Links without mass, of which no torque shows the first alone; and placeholders."""
    without = [link.name for link in robot.links[1:] if not _weighs(link.body)]
    if without:
        verb = "have" if len(without) > 1 else "has"
        return [f"{', '.join(without)} {verb} no mass; expected a mass above zero"]
    if not robot.weightless and (why := unknown_bodies(robot)):
        return [
            f"{why}: torques mean nothing with them; expected those of the arm (irb2400 identify "
            "fits them to logs)"
        ]
    return _one_inertia([link.body for link in robot.links])


def too_dense(robot: Robot) -> list[str]:
    """Most links with less inertia than any matter of their mass has: another unit, whatever the
    size of the arm. One or two such links are measured ones, of which noise is left."""
    bodies = {link.name: link.body for link in robot.links if link.body.mass_kg > 0.0}
    # an inertia of zero says a point mass, or nothing
    stated = {name: body for name, body in bodies.items() if np.trace(body.tensor()) > 0.0}
    dense = {name: body for name, body in stated.items() if _density(body) > DENSEST_KG_M3}
    if len(dense) < 2 or 2 * len(dense) <= len(bodies):
        return []
    least = min(_density(body) for body in dense.values())
    return [
        f"{', '.join(dense)}: the inertias are too little for the masses: balls with them would "
        f"have {least:.2g} kg/m3 or more, and lead has 11000; are they in another unit? Expected "
        "kg m2 and kg"
    ]


def _density(body: Body) -> float:
    """Of the ball with this mass and mean inertia [kg/m3]; nothing that weighs as much with as
    little inertia, however it is shaped, has less."""
    radius = np.sqrt(2.5 * np.trace(body.tensor()) / 3.0 / body.mass_kg)
    return float(body.mass_kg / (4.0 / 3.0 * np.pi * radius**3))


def _one_inertia(bodies: list[Body]) -> list[str]:
    """Links of different weight that have one inertia, the last of which may carry a tool."""
    moments = np.array([np.linalg.eigvalsh(body.tensor()) for body in bodies])
    alike = moments[:-1] if len(bodies) > 3 else moments
    if len(alike) < 3 or not alike.any() or not np.allclose(alike, alike[0], rtol=1e-6, atol=0.0):
        return []
    return [
        f"all links have the same inertia ({alike.max():.4g} kg m2), whatever they weigh: a "
        "placeholder, with which torques of accelerations mean nothing; expected each link's own"
    ]


def unknown_bodies(robot: Robot) -> str:
    """Why the robot file says nothing of its links' bodies; empty where it does."""
    if robot.weightless:
        return "no link has a mass"
    bodies = [
        (link.body.mass_kg, tuple(link.body.com_m), tuple(link.body.inertia_kgm2))
        for link in robot.links
    ]
    if len(bodies) > 2 and len(set(bodies)) == 1:
        return "all links have the same mass data, placeholders"
    # a gripper or a flange is often part of the last
    if len(bodies) > 3 and len(set(bodies[:-1])) == 1:
        return "all links but the last have the same mass data, placeholders"
    return ""


def _weighs(body: Body) -> bool:
    """With a mass, or an inertia that is said already to have none."""
    return body.mass_kg > 0.0 or bool(np.any(body.inertia_kgm2))


def is_a_point(body: Body) -> bool:
    """Whether a body has less inertia than any of its mass: mostly none is stated."""
    inertia = float(np.abs(body.inertia_kgm2).max())
    return body.mass_kg > LIGHT_KG and inertia < LEAST_GYRATION_M**2 * body.mass_kg


def _body(name: str, body: Body, most: float) -> list[str]:
    """Notes on one body; `most`: radius of gyration squared that it may have [m2]."""
    notes = []
    inertia = float(np.abs(body.inertia_kgm2).max())
    if body.mass_kg == 0.0 and inertia > 0.0:
        notes.append(
            f"{name} has no mass but an inertia of {inertia:.4g} kg m2; expected a mass above zero"
        )
    distance = float(np.linalg.norm(body.com_m))
    if distance > FAR_M:
        notes.append(f"{name}: the centre of mass is {distance:.3g} m away; it looks like mm")
    if body.mass_kg > HEAVIEST_KG:
        notes.append(f"{name}: a mass of {body.mass_kg:.4g} kg; it looks like grams")
    if is_a_point(body):
        notes.append(
            f"{name}: inertia {inertia:.4g} kg m2 is too little for {body.mass_kg:.4g} kg, which "
            "would be a point; it looks like another unit, or is left out"
        )
    if body.mass_kg > 0.0 and inertia > most * body.mass_kg:
        notes.append(
            f"{name}: inertia {inertia:.4g} kg m2 is too much for {body.mass_kg:.4g} kg; it looks "
            "like another unit, one about the base, or a placeholder"
        )
    return notes
