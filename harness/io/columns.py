"""Names of columns as people write them, and --columns: which channel each means, times what, in which unit."""

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from harness.core.errors import InputError

ANGLES = frozenset({"angle", "theta", "phi", "roll", "pitch", "yaw"})
"""Names that say an angle; without a unit they are read in rad."""
RATES = frozenset(
    ["gx", "gy", "gz", "wx", "wy", "wz", "gyr", "gyro", "gyroscope", "omega", "theta_dot", "thetadot", "dtheta"]
)
"""Names that say how fast an angle changes; without a unit they are read in rad/s."""
_ANGULAR = ANGLES | RATES
_NAMES: dict[str, str] = {
    "t": "t ts time times stamp timestamp sec secs seconds elapsed",
    "x": "x q qpos pos position displacement disp angle theta phi roll pitch yaw",
    "v": "v dq qd qvel vel velocity speed omega theta_dot thetadot dtheta gx gy gz wx wy wz gyr gyro gyroscope rpm "
    "kph kmh kmph mph dps rps",
    "a": "a ddq qdd qacc acc accel acceleration accelerometer alpha theta_ddot ax ay az gfx gfy gfz",
    "u": "u f tau force torque effort",
}
_CHANNEL = {name: channel for channel, names in _NAMES.items() for name in names.split()}
COMMANDED = frozenset(
    {"cmd", "xcmd", "command", "commanded", "target", "goal", "desired", "des", "ref", "reference", "setpoint"}
    | {"error", "err", "action"}
)
"""Words of a name by which it is not what was measured."""
_CLOCKS = {
    "ms": "ms",
    "us": "us",
    "nanosec": "ns",
    "nsecs": "ns",
    "millis": "ms",
    "micros": "us",
    "msec": "ms",
    "usec": "us",
    "nsec": "ns",
}
"""Names of a time that say its unit."""
_OWN = (
    {"rpm": "rpm", "mph": "mile/hour", "dps": "deg/s", "rps": "rev/s"}
    | dict.fromkeys(("kph", "kmh", "kmph"), "km/h")
    | dict.fromkeys(("gfx", "gfy", "gfz"), "g")
)
"""Names that are a unit."""
ENDINGS: dict[str, dict[str, str]] = {
    channel: dict(zip(words.split()[::2], words.split()[1::2], strict=True))
    for channel, words in {
        "t": "s s sec s secs s second s seconds s ms ms msec ms millis ms milliseconds ms us us usec us micros us "
        "microseconds us ns ns nsec ns nanoseconds ns min min minutes min h h hours h",
        "x": "m m meters m metres m mm mm millimeters mm cm cm um um km km inch inch inches inch ft ft feet ft "
        "rad rad radians rad deg deg degrees deg mrad mrad rev rev revs rev turns rev revolutions rev",
        "v": "m_s m/s ms m/s mps m/s m_per_s m/s mm_s mm/s mmps mm/s mm_per_s mm/s cm_s cm/s cmps cm/s cm_per_s cm/s "
        "km_h km/h kmh km/h kmph km/h kph km/h km_per_h km/h mph mile/hour mi_h mile/hour ft_s ft/s fps ft/s "
        "knots knot kn knot kt knot kts knot rad_s rad/s rads rad/s rad_sec rad/s radps rad/s rad_per_s rad/s "
        "deg_s deg/s degs deg/s deg_sec deg/s degps deg/s dps deg/s deg_per_s deg/s "
        "rpm rpm rps rev/s rev_s rev/s rev_min rpm rev_per_min rpm",
        "a": "m_s2 m/s^2 m_s_2 m/s^2 ms2 m/s^2 mps2 m/s^2 m_per_s2 m/s^2 mm_s2 mm/s^2 cm_s2 cm/s^2 rad_s2 rad/s^2 "
        "deg_s2 deg/s^2 g g mg mg",
        "u": "n N mn mN kn kN nm N*m n_m N*m mnm mN*m mn_m mN*m ncm N*cm n_cm N*cm lbf lbf kgf kgf kg kgf gf gf",
    }.items()
}
"""Units that the ending of a name gives, by channel."""
_WORDS: dict[str, str] = {
    "t": "time zeit temps tiempo tempo tijd tid czas čas aika idő zaman timestamp clock millis время 时间 時間 시간",
    "x": "position displacement deflection distance angle theta height elongation encoder winkel weg auslenkung ort "
    "lage abstand strecke posición desplazamiento distancia ángulo angulo altura déplacement allongement posizione "
    "spostamento angolo posição posicao deslocamento positie verplaatsing hoek vinkel läge avstånd położenie kąt "
    "przemieszczenie poloha výchylka úhel sijainti kulma konum açı положение угол смещение перемещение 位置 位移 "
    "角度 変位 위치 변위 각도 abscisse",
    "v": "velocity speed gyroscope gyro omega geschwindigkeit drehrate vitesse velocidad velocità velocita "
    "velocidade snelheid hastighet prędkość rychlost nopeus hız скорость 速度 속도",
    "a": "acceleration accelerometer accel beschleunigung accélération aceleración aceleracion accelerazione "
    "aceleração versnelling przyspieszenie zrychlení kiihtyvyys ivme ускорение 加速度 가속도",
    "u": "force torque friction reibung frottement attrito rozamiento трение 摩擦 "
    "kraft drehmoment fuerza forza força kracht siła síla voima kuvvet tork сила момент couple 力 "
    "扭矩 转矩 トルク 힘 토크",
}
_WORD = {word: channel for channel, words in _WORDS.items() for word in words.split()}
"""Words that say a channel within a longer name, in a dozen languages; in compounds the last one does."""
_SHORT = 4
"""Letters of a word that must stand alone."""
_MARK = re.compile(r"^(?P<mark>[^:]{1,60}):\s*(?P<name>\S.*)$")
_AXIS = re.compile(r"^(?:[xyz]_(?=[a-z]))?(?P<front>[a-z]{3,40}?)(?:_?[xyz])?(?:_(?P<ending>[a-z0-9_]{1,12}))?$")
"""A name with the letter of an axis: acc_x, gyroZ, acc_x_g, x_pos."""
_DIGITS = re.compile(r"(?<!_s)\d+")
_RUN = re.compile(
    r"\(?\b(?:run|trial|series|serie|set|lauf|versuch|messung|essai|prova|ensayo)[\s_]{0,9}#?\s{0,9}(\d+)\)?\s*$",
    re.IGNORECASE,
)
"""Bounded, and without what parts it from the name: a header may have 50,000 blanks."""
_SHELLS = frozenset("'\"$`\\!")
"""Signs that would not come through quotes as they are."""
_INDEX = re.compile(r"(\[\d{1,4}\]|\.\d{1,4}|_\d{1,4})$")
_PLAIN = re.compile(r"^[^\W\d][\w.]*(?: [\w.]+)*$")


@dataclass(frozen=True, slots=True)
class Meaning:
    """What a column's name means: its channel, and the unit the name gives (None: it gives none)."""

    channel: str
    unit: str | None = None
    angle: bool = False


_SLOPE = re.compile(r"der\((?P<of>[^()]{1,100})\)")
_RAISED = {"x": "v", "v": "a"}
_OF_A_COMPONENT = {"s": "x", "w": "v"}
_ASKED = re.compile(
    r"(?<![^\W\d_])(?:soll|führungs|consign[ea]|riferimento|referencia|referência|zadan|żądan|заданн|уставка)"
    "|目标|目標|给定|設定値|设定|指令|목표|지령"
)
"""What was asked for, in other languages; German and Slavic ones put more behind it: Sollposition."""


def is_commanded(name: str) -> bool:
    """Whether a name says what was asked for, and not what was measured ("goal.position", "xcmd1_rad")."""
    return bool(COMMANDED & set(re.split(r"[^a-z]+", name.lower())) or _ASKED.search(name.lower()))


_ABSOLUTE = re.compile(r"^(?:abs(?:u|f|tau|effort|force|torque)?\d*(?![^\W_])|\|)|[\s_]abs$", re.IGNORECASE)


def is_magnitude(name: str) -> bool:
    """Whether a name says an absolute value ("absu1_Nm", "abs_torque", "|F|")."""
    return bool(_ABSOLUTE.search(name.strip()))


def meaning(name: str) -> Meaning | None:
    """The channel of a column ("Position 1", "/joint_states/position[0]", "x_rad"); None for any other name."""
    return None if is_commanded(name) or is_magnitude(name) else _of_modelica(name.strip()) or _by_words(name)


def _of_modelica(name: str) -> Meaning | None:
    """What Modelica's names mean: a derivative, der(mass.v), and the position and rate of turning of a component."""
    if slope := _SLOPE.fullmatch(name):
        of = meaning(slope["of"])
        return None if of is None or of.channel not in _RAISED else Meaning(_RAISED[of.channel], None, of.angle)
    _, point, last = name.rpartition(".")
    return Meaning(_OF_A_COMPONENT[last], None, last == "w") if point and last in _OF_A_COMPONENT else None


_OF_MESSAGES = {
    ("twist", "linear"): "v",
    ("twist", "angular"): "v",
    ("accel", "linear"): "a",
    ("accel", "angular"): "a",
}
"""What a field of ROS's messages is whose name says no channel, before its axis."""


def _by_words(name: str) -> Meaning | None:
    *before, last = re.split(r"[/.](?=[^\d])", name.strip())
    if last.lower() in ("x", "y", "z") and (of := tuple(word.lower() for word in before[-2:])) in _OF_MESSAGES:
        return Meaning(_OF_MESSAGES[of], None, of[1] == "angular")
    if before and last.lower() in ("x", "y", "z") and word_of(before[-1]):
        last = before[-1]  # an axis: pose.position.x
    stem = re.sub(r"[\s-]+", "_", _INDEX.sub("", last.strip().lower()).strip()).strip("_")
    stem = _INDEX.sub("", stem)
    of_axis = _AXIS.match(stem)
    if of_axis is not None and of_axis["front"] in _CHANNEL:
        stem = "_".join(filter(None, (of_axis["front"], of_axis["ending"])))
    if stem in _CLOCKS or _NANOSECONDS.search(stem):
        return Meaning("t", _CLOCKS.get(stem, "ns"))
    if stem in _CHANNEL:
        return Meaning(_CHANNEL[stem], _OWN.get(stem), stem in _ANGULAR)
    for cut in (i for i, letter in enumerate(stem) if letter == "_"):
        front, ending = _INDEX.sub("", stem[:cut]), stem[cut + 1 :]
        channel = _CHANNEL.get(front)
        if channel is not None and ending in ENDINGS[channel]:
            return Meaning(channel, ENDINGS[channel][ending], front in _ANGULAR)
    return None


_NANOSECONDS = re.compile(r"nano_?sec(?:onds?)?$|(?:^|_)nsecs?$")
"""At the end of a name: of a second, beside its whole seconds (ZeitNanoSec), or of a whole time."""


def word_of(name: str) -> str:
    """The channel that a word within a longer name says ("Winkelgeschwindigkeit", "位置"), "" where none does."""
    text = name.lower()
    ends: list[tuple[int, int, str]] = []
    for word, channel in _WORD.items():
        at = text.rfind(word)
        alone = at >= 0 and (at == 0 or not text[at - 1].isalpha()) and not text[at + len(word) :][:1].isalpha()
        if alone or (at >= 0 and (len(word) > _SHORT or not word.isascii())):
            ends.append((at + len(word), len(word), channel))
    return max(ends)[2] if ends else ""


_ANGLE = re.compile("angle|theta|winkel|ángulo|angolo|angulo|hoek|vinkel|kąt|úhel|açı|угол|角度|각도")


_RATE = re.compile(
    "(?:roll|pitch|yaw)[ _]?(?:rate|speed|vel)|gyro|drehrate|winkelgeschw|angular|angulaire|angolare|vinkelhast"
    "|角速度|각속도|угловая"
)


def is_rate(name: str) -> bool:
    """Whether a name says how fast an angle changes."""
    means = meaning(name)
    return bool(_RATE.search(name.lower())) or (means is not None and means.channel == "v" and means.angle)


_TORQUE = re.compile(r"torque|moment(?!um|an)|\bcouple\b|tork|扭矩|转矩|トルク|토크")


def is_torque(name: str) -> bool:
    """Whether a name says a torque."""
    return bool(_TORQUE.search(name.lower()))


_CURRENT = re.compile(r"current(?!ly)|strom|courant|corriente|电流|電流|전류|\bi_?q\b|\bi_?mot\b|motor_?i\b")


def is_current(name: str, unit: str) -> bool:
    """Whether a column, by its name and unit, is a motor's current."""
    return bool(_AMPERES.fullmatch(unit) if unit else _CURRENT.search(name.lower()))


_AMPERES = re.compile(r"[mµμk]?A|amp(?:ere)?s?", re.IGNORECASE)


_NO_MOTION = re.compile(
    r"temp[eé]rat|humid|humed|feucht|pressure|pression|presi[oó]n|druck|power|leistung|puissance|potencia|energy|current"
    r"|strom|courant|corriente|heart|price|latitude|longitude|volume|温度|湿度|气压|気圧|电流|電流|功率|온도|습도|전류"
    r"|(?<![a-z])(?:temp|lat|lon|hr|bpm|cof|load|weight|mass|soc|interval|duration|dauer|dt)"
    r"(?![a-z])"
)
"""Words of what neither moves nor is a clock, however its numbers rise or fall."""


def is_no_motion(name: str) -> bool:
    """Whether a name says another quantity, and no channel."""
    return not word_of(name) and bool(_NO_MOTION.search(name.lower()))


_PERIOD = re.compile(
    r"(?<![a-z])(?:period|periode|période|periodo)(?![a-z])|umlaufzeit|周期"
    r"|(?<![a-z])(?:rev(?:olution)?|turn|rotation)s?[\s_-]?(?:time|period|duration)(?![a-z])"
    r"|(?<![a-z])(?:time|sec|seconds?|s|ms|us|period)[\s_]?(?:per|a|of|/)[\s_]?(?:rev(?:olution)?|turn|rotation)(?![a-z])"
)
_OF_A_TURN = re.compile(r"(?<![a-z])(?:rev(?:olution)?|turn|rotation)s?(?![a-z])|umlaufzeit")


def is_period(name: str) -> bool:
    """Whether a name says how long a turn, or a swing, took."""
    return bool(_PERIOD.search(name.lower()))


def is_of_a_turn(name: str) -> bool:
    """Whether it says that it was a turn."""
    return bool(_OF_A_TURN.search(name.lower()))


def is_electrical(name: str) -> bool:
    """Whether a name says revolutions of a motor's field, pole pairs times those of its rotor."""
    return bool(re.search(r"(?<![a-z])e_?rpm(?![a-z])", name.lower()))


def is_angle(name: str) -> bool:
    """Whether a name says an angle."""
    return name.strip().lower() in ANGLES or bool(_ANGLE.search(name.lower()))


def marked(name: str) -> tuple[tuple[str, ...], str]:
    """What a run or a joint shares ("Run 1: Time", "Position #2", "theta1"), and the name without it."""
    found, run = _MARK.match(name), _RUN.search(name)
    if found is not None:
        return (found["mark"],), found["name"]
    if run is not None:
        return (run[1],), name[: run.start()].rstrip(" \t,_-")
    digits = tuple(_DIGITS.findall(name))
    return digits, _DIGITS.sub("", name).rstrip(" ._#") if digits else name


def unit_ending(name: str, channel: str = "") -> tuple[str, str] | None:
    """Channel and unit that the ending of a name gives ("x1_rad", "knee_deg_s"); None where it gives none."""
    stem = re.sub(r"[\s.-]+", "_", re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name.strip())).lower()
    for cut in (i for i, letter in enumerate(stem) if letter == "_"):
        tail = stem[cut + 1 :]
        for of in (channel,) if channel else CHANNELS:
            if len(tail) > 1 and tail in ENDINGS[of]:
                return of, ENDINGS[of][tail]
    return None


def candidates(names: Sequence[str]) -> dict[str, list[int]]:
    """Positions of the columns that may be each channel, by name; one that has the channel's own stands alone."""
    found: dict[str, list[int]] = {}
    for i, name in enumerate(names):
        means = meaning(name)
        if means is not None:
            found.setdefault(means.channel, []).append(i)
    for channel, positions in found.items():
        own = [i for i in positions if names[i] == channel or (channel == "u" and names[i] == "F")]
        found[channel] = own[:1] or positions
    return found


def quoted(name: str, position: int) -> str:
    """A column as --columns takes it between double quotes of a shell: its name, in quotes where it needs them, #N
    where it has none, a very long one, or one that holds what a shell reads.
    """
    name = name if len(name) <= _LONGEST_NAME else ""
    if _PLAIN.match(name):
        return name
    return f"'{name}'" if name and not _SHELLS & set(name) else f"#{position + 1}"


CHANNELS = ("t", "x", "v", "a", "u")
ACCEPTED = (
    "CHANNEL=PRODUCT[UNIT] with channel t, x, v, a or u and a product of column names, #N, #0 (the number of the row) "
    "and numbers, "
    "e.g. \"t=t,x=qm[m],u=vir*35.15[N]\"; a name with other signs in it stands in quotes, t='Time (s)'"
)

_NUMBER = re.compile(r"^[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?$")
_POSITION = re.compile(r"^#(?:0|[1-9]\d{0,5})$")
_QUOTED = re.compile(r"'([^']*)'|\"([^\"]*)\"")
_HELD = re.compile(r"^\x00(\d+)\x00$")


@dataclass(frozen=True, slots=True)
class Mapping:
    """One channel as a product: ``factor`` times the columns ``names``, in ``unit`` (None: what the header says)."""

    channel: str
    names: tuple[str, ...]
    factor: float = 1.0
    unit: str | None = None


_LONGEST, _LONGEST_NAME = 2000, 200
"""Characters of ``--columns``, and of a name that is printed in it."""


def _split(text: str) -> list[str]:
    """Split at the commas outside brackets."""
    parts, inside = [""], False
    for character in text:
        inside = character == "[" or (inside and character != "]")
        if character == "," and not inside:
            parts.append("")
        else:
            parts[-1] += character
    return parts


def _put_aside(text: str) -> tuple[str, list[str]]:
    """The text with a mark for each quoted name, and the names."""
    names: list[str] = []

    def mark(found: re.Match[str]) -> str:
        names.append((found[1] if found[1] is not None else found[2]).strip())
        return f"\x00{len(names) - 1}\x00"

    return _QUOTED.sub(mark, text.replace("\x00", "")), names


def _product(entry: str, text: str, quoted: list[str]) -> tuple[tuple[str, ...], float]:
    names: list[str] = []
    factor = 1.0
    for part in text.split("*"):
        item = part.strip()
        held = _HELD.match(item)
        if held and quoted[int(held[1])]:
            names.append(quoted[int(held[1])])
        elif _NUMBER.match(item):
            factor *= float(item)
        elif _POSITION.match(item) or _PLAIN.match(item):
            names.append(item)
        else:
            found = f"'{item or text}' in '{entry}' is no name, #N or number".replace("\x00", "'")
            raise InputError("--columns", found, ACCEPTED)
    if not names:
        raise InputError("--columns", f"'{entry}' names no column", ACCEPTED)
    if not math.isfinite(factor) or factor == 0.0:
        raise InputError("--columns", f"'{entry}' multiplies by {factor:g}", "a finite factor other than 0")
    return tuple(names), factor


def parse_columns(
    text: str, known: Callable[[str], bool] = CHANNELS.__contains__, accepted: str = ACCEPTED
) -> dict[str, Mapping]:
    """Parse ``--columns``; nothing is evaluated.

    known : whether there is a channel of this name. accepted : what a message says of them. Raises InputError for
    anything but a list of CHANNEL=PRODUCT[UNIT].
    """
    if len(text) > _LONGEST:
        raise InputError("--columns", f"{len(text)} characters", f"at most {_LONGEST}")
    found: dict[str, Mapping] = {}
    aside, quoted = _put_aside(text)
    for entry in (part.strip() for part in _split(aside)):
        channel, equals, rest = entry.partition("=")
        product, bracket, unit = rest.partition("[")
        stray = set("[]") & set(channel + product + unit[:-1])
        if not equals or stray or (bracket and not unit.endswith("]")):
            raise InputError("--columns", f"'{entry}'", accepted)
        channel = channel.strip()
        if not known(channel):
            raise InputError("--columns", f"unknown channel '{channel}' in '{entry}'", accepted)
        if channel in found:
            raise InputError("--columns", f"channel {channel} given twice", "each channel once")
        names, factor = _product(entry, product.strip(), quoted)
        found[channel] = Mapping(channel, names, factor, unit[:-1].strip() if bracket else None)
    return found
