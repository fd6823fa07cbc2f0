# SPDX-License-Identifier: Apache-2.0
"""Pretty printers for gdb: values of Quintet's types instead of their internals (docs/debugging.md, "C++").

To add a type, add a row to TYPES. Structs of shaders/quintet/shared need no row: the headers there state which constants a
member has, and this script reads them. Strings and vectors are those of libstdc++, whose own printers show std::span,
std::vector and std::optional.
"""
import math
import re
import struct
from pathlib import Path

import gdb
import gdb.printing

SHARED = Path(__file__).resolve().parent.parent / "shaders" / "quintet" / "shared"


# ---- Scalars and containers -------------------------------------------------------------------------------------------


def short(number, is_double=False):
    """Returns the shortest decimals that give the same float or double."""
    if not is_double:
        for digits in range(1, 10):
            decimals = float(f"{number:.{digits}g}")
            try:
                if struct.unpack("f", struct.pack("f", decimals))[0] == number:
                    number = decimals
                    break
            except OverflowError:  # more than the largest float
                pass
    return repr(number).removesuffix(".0")


def scalar(value):
    """Returns the text of a number, a boolean or an enumerator."""
    kind = value.type.strip_typedefs()
    try:
        if kind.code == gdb.TYPE_CODE_FLT:
            return short(float(value), kind.sizeof > 4)
        if kind.code == gdb.TYPE_CODE_BOOL:
            return "true" if value else "false"
        if kind.code == gdb.TYPE_CODE_ENUM:
            return str(value).rsplit("::", 1)[-1]
        return str(int(value))
    except gdb.error as error:  # such as "value has been optimized out"
        return f"<{error}>"


def tuple_text(values):
    return f"({', '.join(scalar(v) for v in values)})"


def string(value):
    """Returns a std::string as text."""
    length = min(int(value["_M_string_length"]), 1000)
    return value["_M_dataplus"]["_M_p"].string(errors="replace", length=length)


def elements(value):
    """Returns the first element and the number of elements of a std::vector or a std::span."""
    fields = {field.name for field in value.type.strip_typedefs().fields()}
    if "_M_ptr" in fields:
        return value["_M_ptr"], int(value["_M_extent"]["_M_extent_value"])
    first = value["_M_impl"]["_M_start"]
    return first, int(value["_M_impl"]["_M_finish"] - first)


def count(value):
    return elements(value)[1]


def items(value, most=16):
    """Returns the first elements of a std::vector or a std::span, and whether there are more."""
    first, number = elements(value)
    return [first[i] for i in range(min(number, most))], number > most


def address(value):
    return hex(int(value))


# ---- Types. Each function returns a text, or a text and children (name, value). ---------------------------------------

PREFIXES = {"float": "", "double": "d", "int": "i", "unsigned int": "u", "bool": "b"}


def components(value):
    return [value[name] for name in "xyzw"[: int(value.type.strip_typedefs().template_argument(0))]]


def vector(value):
    kind = value.type.strip_typedefs()
    scalar_type = str(kind.template_argument(1).strip_typedefs())
    name = f"{PREFIXES[scalar_type]}vec" if scalar_type in PREFIXES else f"{scalar_type} vec"
    return f"{name}{int(kind.template_argument(0))}{tuple_text(components(value))}"


def matrix(value):
    kind = value.type.strip_typedefs()
    columns, rows = int(kind.template_argument(0)), int(kind.template_argument(1))
    name = f"mat{columns}" if columns == rows else f"mat{columns}x{rows}"
    return f"{name} by rows", [
        (f"row{r}", tuple_text(value["value"][c]["xyzw"[r]] for c in range(columns))) for r in range(rows)
    ]


def quaternion(value):
    w, x, y, z = (float(value[name]) for name in "wxyz")
    text = f"quat(w {short(w)}, x {short(x)}, y {short(y)}, z {short(z)})"
    sine = math.sqrt(x * x + y * y + z * z)
    if not abs(math.hypot(sine, w) - 1) < 1e-3:
        return f"{text}, not a unit quaternion"
    if sine < 1e-7:
        return f"{text}, no rotation"
    angle = math.degrees(2 * math.atan2(sine, w))
    return f"{text}, {angle:.4g}° about ({', '.join(f'{a / sine:.4g}' for a in (x, y, z))})"


def bounds(value):
    corners = [value[name] for name in ("min", "max")]
    if value.type.strip_typedefs().name == "quintet::Bounds":  # of the public API: std::array<float, 3>
        low, high = ([corner["_M_elems"][i] for i in range(3)] for corner in corners)
    else:
        low, high = (components(corner) for corner in corners)
    if not all(float(a) <= float(b) for a, b in zip(low, high)):
        return f"empty bounds, min {tuple_text(low)}, max {tuple_text(high)}"
    return f"bounds from {tuple_text(low)} to {tuple_text(high)}"


def transform(value):
    rows = value["rows"]["_M_elems"]
    return "transform by rows", [
        (f"row{r}", tuple_text(rows[r]["_M_elems"][c] for c in range(4))) for r in range(3)
    ]


def location(value):
    place = string(value["file"]) or "<unknown file>"
    for name in ("line", "column"):
        if int(value[name]) == 0:
            break
        place += f":{int(value[name])}"
    return place


def related(value):
    return f"{location(value)}: {string(value['text'])}"


def diagnostic(value):
    text = f"{location(value)}: {scalar(value['severity'])}: {string(value['text'])} [{string(value['id'])}]"
    others, more = items(value["related"])
    children = [("related", other) for other in others] + ([("related", "...")] if more else [])
    return (text, children) if children else text


def image(value):
    alpha = ", premultiplied" if value["premultiplied"] else ""
    channels = int(value["channels"])
    return (
        f"{int(value['width'])}x{int(value['height'])}, {channels} channel{'s' if channels != 1 else ''}, "
        f"{scalar(value['type'])}, {scalar(value['encoding'])}{alpha}, {count(value['data'])} bytes"
    )


def exr_image(value):
    channels, more = items(value["channels"], 64)
    names = [f"{string(c['name'])} ({scalar(c['type'])})" for c in channels] + (["..."] if more else [])
    return f"{int(value['width'])}x{int(value['height'])}, {count(value['channels'])} channels: {', '.join(names)}"


def buffer(value):
    if int(value["handle_"]) == 0:
        return "empty buffer"
    mapped = f", mapped to {address(value['mapped_'])}" if int(value["mapped_"]) else ""
    return f"buffer of {int(value['size_'])} bytes at {address(value['address_'])}{mapped}"


def gpu_image(value):
    options = value["options_"]
    if int(value["handle_"]) == 0:
        return "empty image"
    return f'image "{string(options["name"])}", {int(options["width"])}x{int(options["height"])}, {scalar(options["format"])}'


def context(value):
    """Context::Impl is known only if src/gpu/context.cpp has debug information."""
    try:
        pointer = gdb.lookup_type("quintet::gpu::Context::Impl").pointer().pointer()
        info = value["impl_"].address.cast(pointer).dereference()["found"]["info"]
    except gdb.error as error:
        return f"context, <{error}>"
    return f'context of device {int(info["index"])}, "{string(info["name"])}", {string(info["driver"])}'


def counts(*members):
    """Returns a function that prints the names of all lists with their numbers of elements, and the values of `members`."""

    def text(value):
        parts = []
        for field in value.type.strip_typedefs().fields():
            if (field.type.strip_typedefs().name or "").startswith("std::vector<"):
                number = count(value[field.name])
                parts += [f"{field.name}: {number}"] if number else []
            elif field.name == "name":
                parts.append(f'"{string(value["name"])}"')
        parts += [f"{name}: {scalar(value[name])}" for name in members]
        return ", ".join(parts) or "empty"

    return text


def instruction(value):
    operands, more = items(value["operands"])
    return (
        (f"%{int(value['result'])} = " if int(value["result"]) else "")
        + scalar(value["op"])
        + (f" %{int(value['type'])}" if int(value["type"]) else "")
        + (f" {tuple_text(operands)}" if operands else "")
        + (" ..." if more else "")
        + (f", line {int(value['line'])}" if int(value["line"]) else "")
    )


# Types without their namespace 'quintet', as regular expressions.
TYPES = [
    (r"glm::vec<.*>", vector),
    (r"glm::mat<.*>", matrix),
    (r"glm::qua<.*>", quaternion),
    (r"Bounds3?", bounds),
    (r"Transform", transform),
    (r"Hash", lambda value: f"{int(value['high']):016x}{int(value['low']):016x}"),
    (r"SourceLocation", location),
    (r"RelatedLocation", related),
    (r"Diagnostic", diagnostic),
    (r"io::Image", image),
    (r"io::ExrImage", exr_image),
    (r"gpu::Buffer", buffer),
    (r"gpu::Image", gpu_image),
    (r"gpu::Context", context),
    (r"scene::(Scene|Mesh)", counts()),
    (r"scene::Geometry", counts("material")),
    (r"spirv::Instruction", instruction),
    (r"shared::FixedSum", lambda value: fixed_sum(value)),
    (r"shared::\w+", lambda value: shared_struct(value)),
]

# Integers that are addresses on the device.
ADDRESSES = {"quintet::shared::Address", "VkDeviceAddress"}


# ---- Structs that C++ and GLSL share ----------------------------------------------------------------------------------


class SharedHeaders:
    """The constants of the headers, and which of them a member can have.

    `constants`: name → value. `members`: (struct, member) → names, from the comment "// Struct::member" above a group of
    constants. `sentinels`: the same for a single constant, from a comment behind the member: "or kNoLight".
    """

    def __init__(self, folder):
        self.constants, self.members, self.sentinels = {}, {}, {}
        for header in sorted(folder.glob("*.h")):
            self.read(header.read_text(encoding="utf-8").splitlines())
        first = self.constants.get("kMaterialTextureShift")
        if first is not None:  # a bit for each texture
            names = [n for n in self.constants if n.startswith("kTexture") and n != "kTextureCount"]
            for name in names:
                self.constants[name] = 1 << (first + self.constants[name])
            self.members.setdefault(("MaterialData", "flags"), []).extend(names)

    def read(self, lines):
        group, owner = [], ""
        for line in lines:
            if comment := re.match(r"// (?=[A-Z]\w+::[a-z])([^.]*)", line):
                group = re.findall(r"([A-Z]\w+)::([a-z]\w*)", comment[1])
            elif constant := re.match(r"QT_CONSTANT (k\w+) = (0[xX][0-9A-Fa-f]+|\d+)u?;", line):
                self.constants[constant[1]] = int(constant[2], 0)
                for member in group:
                    self.members.setdefault(member, []).append(constant[1])
            elif begin := re.match(r"struct (\w+) {", line):
                owner, group = begin[1], []
            elif member := re.match(r"  uint (\w+);.*\bor (k[A-Z]\w+)", line):
                self.sentinels[owner, member[1]] = member[2]
            elif not line.startswith("//"):
                group = []

    def text(self, owner, member, number):
        """Returns the names of the constants that the number consists of, or None if no constant is known."""
        sentinel = self.sentinels.get((owner, member))
        if sentinel and number == self.constants.get(sentinel):
            return sentinel
        names = self.members.get((owner, member), [])
        if member not in ("flags", "link"):
            return next((name for name in names if self.constants[name] == number), None)
        parts = []
        for name in names:
            mask = self.constants[name]
            if mask & (mask - 1):  # a mask of several bits: a number
                parts.append(f"{name} {number & mask}")
            elif number & mask:
                parts.append(name)
            number &= ~mask
        if number:
            parts.append(hex(number))
        return " | ".join(parts) or ("0" if names else None)


HEADERS = SharedHeaders(SHARED)


def snorm16(number, position):
    part = number >> (16 * position) & 0xFFFF
    return max((part - 0x10000 if part & 0x8000 else part) / 32767, -1.0)


def light_axis(node):
    """The same as render::unpackLightAxis (src/render/lights/light_tree.cpp)."""
    bits = int(node["axis"])
    x, y = snorm16(bits, 0), snorm16(bits, 1)
    z = 1 - abs(x) - abs(y)
    fold = max(-z, 0)
    axis = (x + (-fold if x >= 0 else fold), y + (-fold if y >= 0 else fold), z)
    length = math.hypot(*axis)
    return f"({', '.join(f'{a / length:.4g}' for a in axis)})"


def light_cone(node):
    angles = [math.degrees(math.acos(snorm16(int(node["cone"]), i))) for i in range(2)]
    return f"thetaO {angles[0]:.4g}°, thetaE {angles[1]:.4g}°"


def merged_map(instance):
    """The two words are an address if the element stands for several instances."""
    if not int(instance["flags"]) & HEADERS.constants.get("kInstanceMerged", 0):
        return None
    return f"address {hex(int(instance['firstLightSlot']) << 32 | int(instance['firstGeometry']))}"


def light_range(light):
    """A point light and a spot light have the bits of 1 / range in place of a geometry."""
    if HEADERS.text("LightData", "type", int(light["type"])) not in ("kLightPoint", "kLightSpot"):
        return None
    inverse = struct.unpack("f", struct.pack("I", int(light["geometry"])))[0]
    return f"range {1 / inverse:.6g}" if inverse else "unlimited range"


# Members whose bits have a meaning of their own: struct, member, function of the struct.
PACKED = {
    ("LightNode", "axis"): light_axis,
    ("LightNode", "cone"): light_cone,
    ("LightData", "geometry"): light_range,
    ("InstanceData", "firstGeometry"): merged_map,
    ("InstanceData", "firstLightSlot"): merged_map,
}


def fixed_sum(value):
    """The same as render::fixedToDouble (src/render/film/fixed_sum.cpp)."""
    total = sum(int(value["word"][i]) << (32 * i) for i in range(4))
    if total == 1 << 127:
        return "sum that is not finite"
    return f"sum {short((total - (1 << 128) if total >> 127 else total) / 2**64, is_double=True)}"


def shared_struct(value):
    owner = value.type.strip_typedefs().name.rsplit("::", 1)[-1]
    children = []
    for field in value.type.strip_typedefs().fields():
        member, child = field.name, value[field.name]
        if member == "padding":
            continue
        text = None
        if (owner, member) in PACKED:
            text = PACKED[owner, member](value)
        elif child.type.name == "quintet::shared::uint":
            text = HEADERS.text(owner, member, int(child))
        children.append((member, child if text is None else text))
    return None, children


# ---- Registration -----------------------------------------------------------------------------------------------------


class Text:
    def __init__(self, text):
        self.text = text

    def to_string(self):
        return self.text


class Tree(Text):
    def __init__(self, text, members):
        super().__init__(text)
        self.members = members

    def children(self):
        return iter(self.members)


COMPILED = [(re.compile(f"(quintet::)?({pattern})"), function) for pattern, function in TYPES]


def lookup(value):
    if value.type.code in (gdb.TYPE_CODE_REF, gdb.TYPE_CODE_RVALUE_REF):
        value = value.referenced_value()
    if value.type.unqualified().name in ADDRESSES:
        return Text(address(value))
    kind = value.type.strip_typedefs().unqualified()
    if kind.code != gdb.TYPE_CODE_STRUCT or not kind.name:
        return None
    for pattern, function in COMPILED:
        if pattern.fullmatch(kind.name):
            try:
                result = function(value)
            except gdb.error as error:  # such as a variable before its initialization
                return Text(f"<{error}>")
            return Tree(*result) if isinstance(result, tuple) else Text(result)
    return None


lookup.name = "quintet"  # in "info pretty-printer" and "disable pretty-printer"
lookup.enabled = True
gdb.printing.register_pretty_printer(None, lookup, replace=True)
