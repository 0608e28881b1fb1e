"""What the words in the names of columns mean, in the languages and habits of their makers."""

from __future__ import annotations

import re

OTHERS = re.compile(
    r"acc|qdd|ddq|ddot|err|ext|grav|limit|temp(?!s)|volt|tcp|cart|wrench|jerk|collision|inertia|dist"
    r"|(?<![a-z])dst|resid|power|pose(?![a-z])|dtau|tau_?dot"
    r"|(?<!joint)(?<!joint_)(?<!jnt)(?<!jnt_)(?<!axis_)(?<!(?<![a-z])[aj]_)force"
    r"|mode(?!l)|control_output|load.?(?:factor|rate|ratio)|bias|passive|constraint|diff"
    r"|(?<![a-z])k[pid](?![a-z])|加速|温|電圧|負荷率|负载率|온도|전압|가속"
)
COMMANDED = re.compile(
    r"ref|cmd|comm|action|target|des|goal|set|soll|plan(?!e)|nominal|comput|aspos|[a-z]_d(?![a-z])"
    r"|(?<![a-z])opt(?![a-z])|(?<![a-z])output[./]|指令|目標|consigne"
)
_MEASURED = re.compile(r"act(?!uator|ion)|meas|msr|mes|real|(?<!wr)ist|fb|feed")
_STATE = "state"
"""of what is measured, too, but for what follows: the command of `franka_states/q_d`"""
TORQUE = (
    r"tau|τ|torq|trq|tq|mom|qfrc|(?<![a-z])(tor|couple|coppia|par)(?![a-z])"
    r"|トルク|扭矩|力矩|转矩|토크"
)
NEWTON_METRES = r"(?<![a-z])(?:[km]?n[ ·⋅.*-]?m|ncm)(?![a-z])"
TURNS = r"(?<![a-z])(rev|revs|turns|umdrehungen)(?![a-z/])"
TURNS_A_MINUTE = r"rpm|/min|min-(?=\W*$)"
DEGREE_OR_RAD = r"deg|°(?!c)|(?<!g)rad(?!i(?!an))|grad(?!i)"
PULSES = r"puls|counts"
CURRENT = (
    r"cur(?!rent_as_torque)|(?<![a-z])(courant|corrente|corriente|i_?q)(?![a-z])|電流|电流|전류"
    r"|(?<![a-z])i(?=_?(act|targ|meas))"
)
ANGLE = (
    r"pos|ang|(?<!e)q|theta|θ|rax|winkel|^([aj]|jt|mp)\W*$|state\W*$|角|각도|위치"
    rf"|{DEGREE_OR_RAD}|{TURNS}|{PULSES}"
)
OF_A_JOINT = (
    r"joint|jnt|axis|achse|(?<![a-z])(axe|asse|eje)(?![a-z])|軸|轴|关节|関節|관절"
    r"|(?<![a-z])j(?=\W*$)"
)
"""a joint's signal whose own word is not known may be its angle"""
QUANTITIES = {
    "tau": rf"{TORQUE}|{CURRENT}|(?<!co)eff|load|force|(?<![a-z])m_?(?=act|targ)|^m?t\W*$"
    rf"|(?<![a-z])u(?![a-z])|{NEWTON_METRES}",
    "qd": r"vel|speed|spd|dot|dq|dtheta|qd|qv|qp(?!os)|omega|ω|geschw|vitesse|速度|속도"
    rf"|(?:deg|rad|°)(?:/|p|_|_per_)s|{TURNS_A_MINUTE}",
    "q": rf"{ANGLE}|{OF_A_JOINT}",
}
"""what a name means, asked in this order"""
TIME = re.compile(
    r"(.*[^a-z])?(times?|ts|t|tm|tout|time_?stamps?|stamp|zeit|zeitstempel|tick|ipoc|sec|temps|tempo"
    r"|tiempo|時間|时间|時刻|时刻|시간)"
    r"([^a-z].*)?"
)
BARE = re.compile(r"\W*(a|j|jt)?\W*")
"""of a joint's number alone: an angle, or what a recorder counts by axes"""
AMPERE = re.compile(rf"{CURRENT}|(?<![a-z])(amp|amps|ampere|amperes)(?![a-z])")
"""words of a current"""
SURELY = re.compile(rf"{TORQUE}|nm")
"""words of what is none"""
MOTOR = re.compile(r"moto|moteur|resolver|rotor|(?<![a-z])(mot(?![a-z])|m(?=pos|vel))")
"""words of what may be on the motor's side"""


def is_measured(words: str) -> bool:
    """Whether a name, in small letters, says that it was measured."""
    _, state, behind = words.rpartition(_STATE)
    return _MEASURED.search(words) is not None or (bool(state) and not COMMANDED.search(behind))


def is_commanded(words: str) -> bool:
    """Whether it says that it was commanded."""
    return COMMANDED.search(words) is not None and not is_measured(words)


def meaning(pattern: str) -> tuple[str, int]:
    """What a name means, and how surely: 0 where it says measured, 2 of a commanded torque or a
    current; "" where it is of another thing, or does not tell."""
    # what is called as the joint itself is a signal of the joint
    words = re.sub(r"^\{name\}$", "joint", pattern)
    words = re.sub(r"\{(j0?|name)\}|\d", "", words).lower()
    meant = next((q for q, known in QUANTITIES.items() if re.search(known, words)), "")
    if not meant or OTHERS.search(words):
        return "", 3
    if is_measured(words):
        return meant, int(meant == "tau" and AMPERE.search(words) is not None)
    if COMMANDED.search(words):
        # some controllers record no other torque
        return {"q": ("q_ref", 1), "tau": ("tau", 2)}.get(meant, ("", 3))
    # beside a torque a current is the second choice, beside a position a name without a word
    if meant == "tau":
        return meant, 2 if AMPERE.search(words) else 1
    named = meant == "qd" or (re.search(ANGLE, words) and not BARE.fullmatch(words))
    return meant, 1 if named else 2
