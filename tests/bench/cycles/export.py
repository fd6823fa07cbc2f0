# SPDX-License-Identifier: Apache-2.0
# Runs in Blender: converts a glTF scene to a .blend file that Cycles renders like `quintet render`. Settings that make
# Cycles biased are turned off: clamping, blurred reflections, adaptive sampling, denoising. Cycles gets no punctual
# lights, whose units differ between versions of the importer.
#
#   blender -b --factory-startup --python export.py -- SCENE.glb OUT.blend WIDTH HEIGHT BOUNCES ENV INTENSITY [EYE AT FOV]
#
# ENV: an equirectangular image, or none. EYE, AT: x,y,z in the axes of glTF; FOV: vertical, degrees. Without them, the
# first camera of the file is used.
import json
import math
import struct
import sys

import bpy
import numpy
from mathutils import Matrix, Vector

# The importer of Blender 3.4 uses this name, which NumPy 1.24 of Debian 12 no longer has.
if not hasattr(numpy, "bool"):
    numpy.bool = bool


def gltf_json(path):
    with open(path, "rb") as file:
        magic, _, _, length, kind = struct.unpack("<4sIIII", file.read(20))
        if magic != b"glTF" or kind != 0x4E4F534A:
            raise SystemExit(f"{path}: not a binary glTF file")
        return json.loads(file.read(length))


def blender_axes(text):
    x, y, z = (float(part) for part in text.split(","))
    return Vector((x, -z, y))


def set_camera(scene, source, view):
    if view:
        eye, at, fov = blender_axes(view[0]), blender_axes(view[1]), math.radians(float(view[2]))
        camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        scene.collection.objects.link(camera)
        camera.matrix_world = Matrix.Translation(eye) @ (at - eye).to_track_quat("-Z", "Y").to_matrix().to_4x4()
    else:
        camera = next(o for o in scene.objects if o.type == "CAMERA")
        fov = gltf_json(source)["cameras"][0]["perspective"]["yfov"]
    camera.data.sensor_fit = "VERTICAL"
    camera.data.angle = fov
    camera.data.clip_start, camera.data.clip_end = 1e-3, 1e6
    scene.camera = camera


def set_world(scene, image, intensity):
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (0, 0, 0, 1)
    if image != "none":
        texture = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
        texture.image = bpy.data.images.load(image)
        world.node_tree.links.new(texture.outputs["Color"], background.inputs["Color"])
        background.inputs["Strength"].default_value = intensity
    scene.world = world


def set_cycles(scene, width, height, bounces):
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = width, height, 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_mode = "RGB"
    scene.render.image_settings.color_depth = "32"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.blur_glossy = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    # Quintet counts all scattering events, Cycles those after the first one.
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = bounces - 1
    cycles.transparent_max_bounces = max(8, bounces)


def main():
    source, target, width, height, bounces, image, intensity, *view = sys.argv[sys.argv.index("--") + 1 :]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
    bpy.ops.import_scene.gltf(filepath=source)
    scene = bpy.context.scene
    if any(o.type == "LIGHT" for o in scene.objects):
        raise SystemExit(f"{source}: has punctual lights")
    set_camera(scene, source, view)
    set_world(scene, image, float(intensity))
    set_cycles(scene, int(width), int(height), int(bounces))
    bpy.ops.file.pack_all()
    bpy.ops.wm.save_as_mainfile(filepath=target)


main()
