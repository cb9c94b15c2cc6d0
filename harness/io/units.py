"""Units of columns: what a header or ``--columns`` says, as a factor to SI. Imports pint only when it is asked."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from harness.core.errors import InputError
from harness.io.columns import ENDINGS, is_commanded, is_magnitude

SMALLEST, LARGEST = 1e-12, 1e7
"""In SI: from the picometre, picosecond and piconewton to the meganewton; larger are those of astronomers."""
STANDARD_GRAVITY = 9.80665
"""m/s^2; what ``[g]`` means on an acceleration (elsewhere ``g`` is the gram)."""

_GRAVITY = re.compile(r"^(?P<prefix>[mµμu]?)(?:g|G|gn|g_0|g0)$")
_TEMPERATURE = re.compile(r"^(?:°\s?C|degC|C|celsius|K|kelvin)$", re.IGNORECASE)
"""Of which differences alone count."""
_ONE_OF = {"mil": ("thou (0.001 inch) or mrad", "thou", "mrad"), "rd": ("rad, or rod (5.03 m)", "rad", "rod")}
_TWOFOLD = re.compile(rf"\b({'|'.join(_ONE_OF)})s?\b", re.IGNORECASE)
_PLAIN = re.compile(r"^[\w\s*/^().%°²³⁻¹·-]{1,60}$")
_LARGE_EXPONENT = re.compile(r"(?:\*\*|\^)[\s(+-]*(?:\d{2,}|[^\d\s])|\*\*[^*]*\*\*|\^[^^]*\^")

_LONGEST = 200
"""Characters of a header in which a unit is looked for behind the name."""
_BEHIND = re.compile(
    r"^(?P<name>[^\[(]*[^\[(\s])\s*[\[(](?P<unit>[^\[\]()\d][^\[\]()]*)[\])]\s*(?P<tail>[^\[\]()]*\d)$"
)
_BARE = re.compile(r"^(?P<name>\S.*?)(?P<sign>\s*/\s*|\s+in\s+|,\s+)(?P<unit>\S+)$")
_BEHIND_IN = {" in ": ("V", "mV", "A", "mA")}
"""Units beside those that stand without brackets, where a word leads to them."""
_USUAL_UNITS = (
    "s ms us µs ns min m mm cm km um µm rad deg ° mrad rev m/s mm/s cm/s km/h rad/s deg/s °/s rpm 1/min "
    "m/s^2 m/s² m/s2 m/s**2 mm/s² g mg rad/s^2 rad/s² deg/s^2 °/s² N mN kN Nm mNm Ncm N·m"
)
_WIDE = str.maketrans("（）［］【】", "()[][]")
"""Brackets as they are typed in Chinese and Japanese."""
_USUAL = frozenset(_USUAL_UNITS.split())
"""Units that are taken for one without brackets."""
_RUN_TOGETHER = re.compile(r"^(?P<force>[munµμkM]?N)(?P<length>m|cm|mm)$")
_BY_HYPHEN = re.compile(r"^(?P<one>[A-Za-z]+)(?P<sign>[-·*. ])(?P<other>[A-Za-z]+)$")
_WEIGHTS = {"lb": "lbf", "lbs": "lbf", "oz": "ozf", "kg": "kgf", "g": "gf"}
"""Masses that stand for their weight where a torque is meant."""

_ACCEPTED = {
    "t": "a unit of time such as s, ms or us",
    "x": "a unit of length or angle such as m, mm, rad or deg",
    "v": "a unit of speed such as m/s, mm/s, rad/s or rpm",
    "a": "a unit of acceleration such as m/s^2, g, mm/s^2 or rad/s^2",
    "u": "a unit of force, torque or force per mass such as N, lbf, Nm or m/s^2",
    "i": "a unit of current such as A or mA",
    "e": "a unit of voltage such as V or mV",
    "n": "no unit",
    "h": "degC or K",
}
_SCALED = {
    "x": '"x=#2*0.01[m]"',
    "v": '"v=#2*0.01[m/s]"',
    "a": '"a=#2*0.01[m/s^2]"',
    "u": '"u=#3*0.05[Nm]"',
}
"""A column by its number and what one of its units is worth: volts, counts, amperes."""
_WORDS = {
    "s": "second seconds sec secs sekunde sekunden seconde secondes segundo segundos secondo secondi saniye sn с сек "
    "秒 초",
    "ms": "millisecond milliseconds msec millisekunden millisecondes milisegundos мс 毫秒 ミリ秒 밀리초",
    "us": "microsecond microseconds usec mikrosekunden 微秒 マイクロ秒",
    "m": "meter meters metre metres mètre mètres metro metros metri м 米 メートル 미터",
    "mm": "millimeter millimeters millimetre millimetres millimètres milímetros мм 毫米 ミリメートル 밀리미터",
    "cm": "centimeter centimeters centimetre centimetres zentimeter centímetros см 厘米 センチメートル 센티미터",
    "rad": "radian radians radiant рад 弧度 ラジアン 라디안",
    "rpm": "1/min u/min /min min-1 min^-1 min⁻¹ tr/min t/min r/min tours/min giri/min obr/min об/мин",
    "deg": "degree degrees degs degré degrés grados gradi graus graden grader stopnie derece град 度 도",
    "turn": "rotation rotations umdrehung umdrehungen",
    "N": "newton newtons н 牛 牛顿 ニュートン 뉴턴",
    "N*m": "нм н·м н*м 牛米 牛·米",
    "s^2": "с² с^2 с2",
}
_WRITTEN = {word: unit for unit, words in _WORDS.items() for word in words.split()}
"""Units that are written out."""
_BY_POWERS = re.compile(
    r"^(?P<one>mm|cm|km|m|rad|deg|°)(?:[ .·*⋅]?s\^?(?:-|−|⁻)(?P<power>[12¹²])|/(?:s|sec)(?:\^|\*\*)?(?P<square>[2²]))$"
)
"""Speeds and accelerations with the power of the second: m s-1, ms^-2, rad·s⁻¹, m/s2."""
_KINDS = {"kilogram * meter ** 2 / ampere / second ** 3": "a voltage", "ampere": "a current"}
_BASE = {
    "t": ("second",),
    "x": ("meter", "radian"),
    "v": ("meter / second", "radian / second"),
    "a": ("meter / second ** 2", "radian / second ** 2"),
    "u": (
        "kilogram * meter / second ** 2",
        "kilogram * meter ** 2 / second ** 2",
        "meter / second ** 2",
        "radian / second ** 2",
    ),
    "i": ("ampere",),
    "e": ("kilogram * meter ** 2 / ampere / second ** 3",),
    "n": ("dimensionless",),
    "h": ("kelvin",),
}


_LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 0.01, "km": 1e3, "um": 1e-6, "µm": 1e-6, "rad": 1.0, "mrad": 1e-3}
_PLACES = _LENGTHS | dict.fromkeys(("deg", "°"), math.pi / 180.0)
_PER_SECOND_SQUARED = ("/s^2", "/s²", "/s**2")
_SIMPLE: dict[str, dict[str, float]] = {
    "t": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6},
    "x": _PLACES,
    "v": {f"{unit}/s": factor for unit, factor in _PLACES.items()},
    "a": {f"{unit}{per}": factor for unit, factor in _PLACES.items() for per in _PER_SECOND_SQUARED},
    "u": {"N": 1.0, "mN": 1e-3, "kN": 1e3, "Nm": 1.0, "mNm": 1e-3},
}
"""Factors of the units that most files have: the library of all others takes longer to begin than they to be read."""
_ANGLES = ("rad", "mrad", "deg", "°")
_ALL_SIMPLE = frozenset().union(*_SIMPLE.values())


_OF_A_TURN = re.compile(r"^(?P<time>[a-zµμ]{1,12})\s?/\s?(?:rev(?:olution)?|turn|rotation|U|Umdrehung)$")
"""A unit of periods, each that of a turn."""
_REMARKS = re.compile(
    r"abs(?:olute)?|actual|avg|bottom|calibrated|corrected|elapsed|encoder|epoch|estimated|filtered|front|gefiltert"
    r"|gemessen|gmt|ist|joint|laser|left|link|local|mean|meas(?:ured)?|motor|rear|rel(?:ative)?|right|sensor|simulated"
    r"|smooth(?:ed)?|top|total|unfiltered|unix|utc",
    re.IGNORECASE,
)
"""Words in brackets that say which column it is, and no unit."""
_SEVERAL_WORDS = re.compile(r"[^\W\d_]{2,30}(?:[ _-][^\W_]{1,30}){1,5}")


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit: its text, the factor to SI, and whether it measures an angle; of t, whether it is the time of a turn."""

    text: str
    factor: float
    angular: bool


SI = Unit("", 1.0, False)
"""No unit given: SI."""


def split_header(header: str) -> tuple[str, str | None]:
    """Split ``x [mm]`` or ``Time (s)`` into name and unit; the unit is None when there are no brackets.

    ``position[0]`` is the name of an element, and stays whole. What stands behind the brackets, ``Time (s) Run #1``,
    belongs to the name; ``w / rad``, ``Weg in mm`` and ``t, ms`` are of the same kind, and ``km/h`` is both. Words that
    are no unit, ``time (since start)``, are left out, but for those by which it is not what was measured.
    """
    name, said = _in_brackets(header)
    counted = next(filter(STEPS.match, re.split(r"[ _-]", said or "")), None)
    if said is None or counted == said or not _is_remark(said):
        return name, said
    if counted is not None:
        return name, counted
    return (header.strip(), None) if is_commanded(said) or is_magnitude(said) else (name, None)


def _is_remark(said: str) -> bool:
    """Whether what stands in brackets is no unit but says which column it is: (since start), [filtered]."""
    return bool(_REMARKS.fullmatch(said) or (_SEVERAL_WORDS.fullmatch(said) and not is_unit(said)))


def _in_brackets(header: str) -> tuple[str, str | None]:
    """Name of a column and what stands in the brackets of its header; None where there are none."""
    text = header.strip().translate(_WIDE)
    if len(text) > 1 and (unit := text.removeprefix("in ")) in _USUAL:  # an oscilloscope's time is in s
        return unit, unit
    if text.startswith("der("):  # Modelica's derivative
        return text, None
    short = text if len(text) <= _LONGEST else ""
    if behind := _BEHIND.match(short):
        return f"{behind['name']} {behind['tail']}", behind["unit"].strip()
    if (bare := _BARE.match(short)) and (
        _stands_bare(bare["unit"]) or bare["unit"] in _BEHIND_IN.get(bare["sign"], ())
    ):
        return bare["name"], bare["unit"]
    for opening, closing in ("[]", "()"):
        name, bracket, unit = text[:-1].rpartition(opening)
        if text.endswith(closing) and bracket and name.strip() and closing not in unit and not unit.strip().isdigit():
            return name.strip(), unit.strip()
    return text, None


def _stands_bare(unit: str) -> bool:
    """Whether a unit is taken for one without brackets."""
    written = not unit.isascii() and all(word in _WRITTEN for word in unit.lower().split("/"))
    return written or unit in _USUAL or bool(_BY_POWERS.match(unit))


def split_headers(headers: Sequence[str]) -> tuple[list[str], dict[int, str]]:
    """Names of columns, and by position the units of those that say one."""
    split = [split_header(header) for header in headers]
    return [name for name, _ in split], {i: unit for i, (_, unit) in enumerate(split) if unit is not None}


@cache
def _registry() -> Any:
    import pint

    registry: Any = pint.UnitRegistry(cache_folder=None)
    registry.define("@alias revolution = rev")
    return registry


def _torque(text: str) -> str:
    """A torque as it is written on motors (Nm, mNm, oz-in, ft-lb, kg.cm) as a product; any other text as it is."""
    together, parted = _RUN_TOGETHER.match(text), _BY_HYPHEN.match(text)
    if together:
        return f"{together['force']}*{together['length']}"
    if parted:
        words = (word.lower() if len(word) > len("mNm") else word for word in (parted["one"], parted["other"]))
        return "*".join(_WEIGHTS.get(word.lower(), word) for word in words)
    return text


def _spelled(channel: str, text: str) -> str:
    """A unit as the library spells it: kmh, Nm."""
    if channel == "u" and (product := _torque(text)) != text:
        return product
    return text if text in _registry() else ENDINGS.get(channel, {}).get(text.strip().lower(), text)


def _in_short(word: str) -> str:
    """A unit that is written out, in short. Grad is a degree in German; grad is a gon."""
    return "deg" if word.strip() == "Grad" else _WRITTEN.get(word.strip().lower(), word)


class NoUnitError(InputError):
    """A text that is no unit of its channel."""


class TwofoldUnitError(InputError):
    """A text that is one unit to some and another to others. meant : which, the likelier first."""

    meant: tuple[str, ...] = ()


class OtherUnitError(InputError):
    """A unit of another kind, or a sensor's own, of which a scale makes one of the channel's."""


def parse_unit(where: str, channel: str, text: str | None) -> Unit:
    """The unit ``text`` of a channel (t, x, v, a, u, or i, e and h: current, voltage, temperature); SI when None.

    Raises InputError naming ``where``: NoUnitError when it is not a unit, OtherUnitError for one of another dimension.
    """
    if text is None:
        return SI
    text = text.strip() or text
    if factor := _SIMPLE.get(channel, {}).get(text):
        return Unit(text, factor, channel != "u" and text.startswith(_ANGLES))
    accepted = f"{_ACCEPTED[channel]} for {channel}"
    if channel == "t" and (time := of_a_turn(text)):
        return replace(parse_unit(where, channel, time), text=text, angular=True)
    if powers := _BY_POWERS.match(text):
        text = f"{powers['one']}/s" + ("^2" if powers["square"] or powers["power"] in "2²" else "")
    gravity = _GRAVITY.match(text)
    if channel == "a" and gravity:
        prefix = {"": 1.0, "m": 1e-3}.get(gravity["prefix"], 1e-6)
        return Unit(text, prefix * STANDARD_GRAVITY, False)
    if channel == "h" and _TEMPERATURE.match(text):
        return Unit(text, 1.0, False)
    two = _TWOFOLD.search(text)
    if two:
        accepted, *meant = _ONE_OF[two[1].lower()]
        found = f"'{text}' is a length to some and an angle to others ({accepted})"
        twofold = TwofoldUnitError(where, found, accepted)
        twofold.meant = tuple(_TWOFOLD.sub(one, text) for one in meant)
        raise twofold
    if not text.strip() or not _PLAIN.match(text) or _LARGE_EXPONENT.search(text):
        raise NoUnitError(where, f"'{text}' is not a unit", accepted)
    if STEPS.match(text) and channel in _SCALED:
        accepted += f"; what one is worth brings it, as {_SCALED[channel]} in --columns"
        raise OtherUnitError(where, f"'{text}' is what a sensor counts", accepted)
    registry = _registry()
    text = _WRITTEN.get(text.lower()) or "/".join(map(_in_short, text.split("/")))
    try:
        base = registry.Quantity(1.0, registry.parse_units(_spelled(channel, text)))
        base = base.to_base_units()
    except Exception:  # pint raises from its tokenizer up; whatever it is, this text is not a unit
        raise NoUnitError(where, f"'{text}' is not a unit", accepted) from None
    if str(base.units) not in _BASE[channel]:
        kind = "a pure number" if base.dimensionless else _KINDS.get(str(base.units), str(base.units))
        if channel in _SCALED:
            accepted += f"; a sensor's or a motor's own scale brings it, as {_SCALED[channel]} in --columns"
        raise OtherUnitError(where, f"'{text}' is a unit of another kind ({kind})", accepted)
    return Unit(text, _of_a_machine(where, text, float(base.magnitude), accepted), "radian" in str(base.units))


def _of_a_machine(where: str, text: str, factor: float, accepted: str) -> float:
    if not SMALLEST <= factor <= LARGEST:
        raise NoUnitError(where, f"'{text}' is no unit of a machine: {factor:.4g} in SI units", accepted)
    return factor


_STEPS = (
    r"(?:counts?|cnts?|cts|ticks?|steps?|raw|lsb|adu|pulses?|incs?|increments?|inkremente?|qc|digits?|px|pixels?)"
    r"(?:/(?:s|sec)(?:\^?2|²)?)?"
)
STEPS = re.compile(rf"^{_STEPS}$", re.IGNORECASE)
"""Units of sensors that count."""
RAW = re.compile(rf"^(?:{_STEPS}|a\.?u\.?|m?v|volts?|%|-|1)?$", re.IGNORECASE)
"""Units of sensors that give no unit of motion."""


def of_a_turn(unit: str) -> str:
    """The unit of time in one of periods of a turn, s/rev; "" for any other."""
    found = _OF_A_TURN.match(unit)
    return found["time"] if found else ""


_BESIDE_A_MOTION = (
    "°C degC °F A mA W kW Hz kHz bar mbar Pa hPa kPa MPa psi l/min l/h g/s lux lx dB dBA ppm pH sats ratio #"
)
_OF_OTHERS = frozenset(_BESIDE_A_MOTION.split())
"""Units of what stands beside a motion, in a line of units."""


def is_unit(text: str) -> bool:
    """Whether a text is a unit of any channel, one of a sensor as it stands, or one of what stands beside a motion."""
    known = bool(RAW.match(text)) or text in _USUAL or text in _OF_OTHERS
    return known or (len(text) > 1 and any(is_unit_of(channel, text) for channel in _BASE))


def is_unit_of(channel: str, text: str) -> bool:
    """Whether a text is a unit of a channel."""
    if text in _ALL_SIMPLE and channel != "u":
        return text in _SIMPLE.get(channel, {})
    try:
        parse_unit("", channel, text)
    except InputError:
        return False
    return True
