# SPDX-License-Identifier: Apache-2.0
# Reads the corpus of mistakes and idioms (tests/check) for scripts: expands its cases, lists its programs, writes a program to
# a folder of its own, and writes the scene that its facts.toml describes. Python 3.11, no other packages.
import shutil
import subprocess
import tomllib
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent
LECTURE = "program.rt.glsl"


@dataclass(frozen=True)
class Entry:
    """One program of the expanded corpus. `repaired` selects the repaired version of a mistake."""

    folder: Path
    repaired: bool = False

    @property
    def name(self):
        return self.folder.name

    @property
    def id(self):
        return self.name[:4]

    def write(self, target):
        """Copies the program to the folder `target`. Returns the path of the program, and of its scene or None."""
        target.mkdir(parents=True)
        layers = [self.folder, self.folder / "repaired"] if self.repaired else [self.folder]
        for layer in layers:
            for file in layer.iterdir():
                if file.is_file():
                    shutil.copy(file, target)
        facts = target / "facts.toml"
        scene = None
        if facts.exists():
            scene = target / "facts.scene.toml"
            scene.write_text(scene_of(tomllib.loads(facts.read_text())))
        program = target / LECTURE if (target / LECTURE).exists() else target
        return program, scene


def expand(tool, target):
    """Writes all cases to the folders mistakes/NAME and idioms/NAME of `target`. `tool` is quintet_expand_cases."""
    for kind in ("mistakes", "idioms"):
        subprocess.run([tool, target / kind, *sorted((ROOT / kind).glob("*.case"))], check=True)


def mistakes(expanded, repaired=False):
    return [Entry(folder, repaired) for folder in sorted((expanded / "mistakes").iterdir())]


def idioms(expanded):
    return [Entry(folder) for folder in sorted((expanded / "idioms").iterdir())]


# One table of a scene file for each kind of geometry. The shapes are small, and all are seen by the default camera.
SHAPES = {
    "triangles": '[[mesh]]\nshape = "uv_sphere"\nradius = 0.6\nsegments = [8, 4]',
    "solids": "[[spheres]]\nitems = [{ radius = 0.6 }]",
    "csg": "[[csg]]\ntree = { union = [{ sphere = { radius = 0.5 } }, { box = {} }] }",
    "custom": "[[custom]]\nboxes = [{ min = [-0.6, -0.6, -0.6], max = [0.6, 0.6, 0.6] }]",
}


def scene_of(facts):
    """Returns a scene file with the geometries and instances of a facts.toml."""
    geometries = facts.get("geometry", [])
    text = []
    for index, geometry in enumerate(geometries):
        if geometry.get("alpha") or geometry.get("material"):
            name = geometry.get("material") or f"material{index}"
            # Several geometries can name one material; a scene file defines it once.
            first = next(i for i, g in enumerate(geometries) if (g.get("material") or f"material{i}") == name)
            if first == index:
                mode = '\nbase_color = [0.8, 0.8, 0.8, 0.4]\nalpha_mode = "mask"' if geometry.get("alpha") else ""
                text.append(f'[[material]]\nname = "{name}"{mode}')
    # Instances with the same geometries share an acceleration structure.
    names = [geometry.get("name") or f"geometry{index}" for index, geometry in enumerate(geometries)]
    objects = {}
    for instance in facts.get("instance", []):
        first, count = instance.get("first", 0), instance.get("count", 1)
        objects.setdefault((first, count), names[first] if count == 1 else f"object{first}")
    for (first, count), name in objects.items():
        for index in range(first, first + count):
            geometry = geometries[index]
            lines = [SHAPES[geometry["kind"]], f'name = "{names[index]}"']
            if count > 1:
                lines.append(f'object = "{name}"')
            if geometry.get("alpha") or geometry.get("material"):
                lines.append(f'material = "{geometry.get("material") or f"material{index}"}"')
            text.append("\n".join(lines))
    for index, instance in enumerate(facts.get("instance", [])):
        key = (instance.get("first", 0), instance.get("count", 1))
        flags = 'flags = ["force_opaque"]\n' if instance.get("force_opaque") else ""
        text.append(
            f'[[instance]]\nof = "{objects[key]}"\nname = "{instance.get("name") or f"instance{index}"}"\n'
            f'translate = [{1.5 * index}, 0, 0]\nmask = {instance.get("mask", 255)}\n'
            f'custom_index = {instance.get("custom_index", 0)}\n{flags}'.rstrip()
        )
    return "\n\n".join(text) + "\n"
