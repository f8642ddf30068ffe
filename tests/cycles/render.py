"""Renders scenes of scenes.json with Blender's Cycles and stores their irradiance. Run by Blender (README.md):

    blender --background --factory-startup --python-exit-code 1 --python render.py -- --built-in FOLDER [NAME...]

For each scene it writes NAME.exr (irradiance, W/m2, half floats) and NAME.json (what it was made with).
"""

import argparse
import importlib.util
import json
import math
import os
import pathlib
import sys
import time

import bpy
from mathutils import Matrix, Vector

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
sys.dont_write_bytecode = True  # this folder is the project's

import lambertian  # noqa: E402 (beside this file)
import lights  # noqa: E402
import poses  # noqa: E402

# Where the files of scenes.json are, by what comes before the colon in their names.
PLACES = {
    'own': HERE,
    'assimp': pathlib.Path('/usr/share/assimp/models/glTF2'),
    'shared': HERE.parents[2] / 'shared' / 'assets',
}
TEMPORARY = '.partial.exr'


def arguments():
    parser = argparse.ArgumentParser(prog='render.py')
    parser.add_argument('names', nargs='*', metavar='NAME', help='scenes of scenes.json (default: all)')
    parser.add_argument('--built-in', type=pathlib.Path, help='folder of the built-in scenes: BUILD/scenes')
    parser.add_argument('--output', type=pathlib.Path, default=HERE / 'pictures', help='folder to write to')
    parser.add_argument('--size', help='WIDTHxHEIGHT, in place of what scenes.json says')
    parser.add_argument('--samples', type=int, help='a pixel, in place of what scenes.json says')
    parser.add_argument('--seed', type=int, help='in place of what scenes.json says')
    return parser.parse_args(sys.argv[sys.argv.index('--') + 1:] if '--' in sys.argv else [])


def cases(options):
    with open(HERE / 'scenes.json', encoding='utf-8') as file:
        stored = json.load(file)
    result = []
    for case in stored['scenes']:
        case = {**stored['settings'], **case}
        for name in ('size', 'samples', 'seed'):
            if getattr(options, name) is not None:
                case[name] = getattr(options, name)
        if not options.names or case['name'] in options.names:
            result.append(case)
    unknown = set(options.names) - {case['name'] for case in result}
    if unknown:
        sys.exit(f"error: scenes.json has no scene {', '.join(sorted(unknown))}")
    return result


def locate(name, options):
    """The glTF file, and what its scene file says of its nodes beyond glTF."""
    place, path = name.split(':', 1)
    if place != 'built_in':
        return PLACES[place] / path, {}
    if options.built_in is None:
        sys.exit(f"error: --built-in is needed for '{name}'")
    with open(options.built_in / (path + '.scene.json'), encoding='utf-8') as file:
        scene = json.load(file)
    return options.built_in / scene['gltf'], scene['entities']


def load(path, entities):
    """An empty Blender scene with the file's geometry, Lambertian, and its lights."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(path), merge_vertices=False, convert_lighting_mode='SPEC')
    for thing in bpy.data.objects:
        if thing.type == 'MESH':
            # Cycles shifts rays near smooth silhouettes; the reference does not.
            thing.cycles.shadow_terminator_offset = 0.0
            thing.cycles.shadow_terminator_geometry_offset = 0.0
    poses.pose_all(entities)
    lambertian.convert_all(entities)
    lights.convert_all(lambertian.emits())


def place_camera(text):
    """px,py,pz,tx,ty,tz,fov, as of the tool's --camera."""
    numbers = [float(number) for number in text.split(',')]
    position, target = poses.in_blender(numbers[0:3]), poses.in_blender(numbers[3:6])
    back = (position - target).normalized()
    right = Vector((0.0, 0.0, 1.0)).cross(back).normalized()
    camera = bpy.data.cameras.new('camera')
    camera.sensor_fit = 'VERTICAL'
    camera.angle = math.radians(numbers[6])
    distance = (position - target).length
    camera.clip_start, camera.clip_end = distance * 1e-4, distance * 1e4
    thing = bpy.data.objects.new('camera', camera)
    thing.matrix_world = Matrix.Translation(position) @ Matrix((right, back.cross(right), back)).transposed().to_4x4()
    bpy.context.scene.collection.objects.link(thing)
    bpy.context.scene.camera = thing


def set_cycles(case):
    """Nothing that biases the picture."""
    scene = bpy.context.scene
    scene.render.engine = 'CYCLES'
    scene.render.resolution_x, scene.render.resolution_y = (int(side) for side in case['size'].split('x'))
    scene.render.resolution_percentage = 100
    settings = {
        'device': 'CPU', 'samples': case['samples'], 'seed': case['seed'], 'pixel_filter_type': 'BOX',
        'use_adaptive_sampling': False, 'use_denoising': False, 'light_sampling_threshold': 0.0,
        'sample_clamp_direct': 0.0, 'sample_clamp_indirect': 0.0, 'blur_glossy': 0.0, 'use_fast_gi': False,
        'max_bounces': case['bounces'], 'diffuse_bounces': case['bounces'], 'glossy_bounces': case['bounces'],
        'transmission_bounces': case['bounces'], 'transparent_max_bounces': 64,
    }
    for name, value in settings.items():
        setattr(scene.cycles, name, value)
    return settings


def write_irradiance():
    """The compositor makes irradiance of the passes: pi (direct + indirect), times the share of the pixel that shows a
    surface. That share is the diffuse colour, since the camera sees every surface white (lambertian.py), and passes
    without colour are divided by it."""
    scene = bpy.context.scene
    layer = scene.view_layers[0]
    layer.use_pass_diffuse_direct = layer.use_pass_diffuse_indirect = layer.use_pass_diffuse_color = True
    scene.use_nodes = True
    tree = scene.node_tree
    tree.nodes.clear()
    passes = tree.nodes.new('CompositorNodeRLayers')

    def combine(operation, first, second):
        node = tree.nodes.new('CompositorNodeMixRGB')
        node.blend_type = operation
        for socket, value in zip(node.inputs[1:], (first, second)):
            if isinstance(value, bpy.types.NodeSocket):
                tree.links.new(socket, value)
            else:
                socket.default_value = value
        return node.outputs[0]

    light = combine('ADD', passes.outputs['DiffDir'], passes.outputs['DiffInd'])
    covered = combine('MULTIPLY', light, passes.outputs['DiffCol'])
    irradiance = combine('MULTIPLY', covered, (math.pi, math.pi, math.pi, 1.0))
    tree.links.new(tree.nodes.new('CompositorNodeComposite').inputs['Image'], irradiance)


def set_file(path):
    render = bpy.context.scene.render
    render.filepath, render.use_file_extension = str(path), False
    image = render.image_settings
    image.file_format, image.color_mode, image.color_depth, image.exr_codec = 'OPEN_EXR', 'RGB', '16', 'ZIP'
    for name in dir(render): # nothing of this machine or day in the file
        if name.startswith('use_stamp_'):
            setattr(render, name, False)


def render(case, options):
    path, entities = locate(case['file'], options)
    if not path.exists():
        sys.exit(f"error: {case['name']}: '{path}' does not exist")
    load(path, entities)
    place_camera(case['camera'])
    settings = set_cycles(case)
    write_irradiance()
    options.output.mkdir(parents=True, exist_ok=True)
    partial = options.output / (case['name'] + TEMPORARY)
    set_file(partial)
    began = time.monotonic()
    bpy.ops.render.render(write_still=True)
    of_tests = ('reference_samples', 'short')  # no part of how the picture was made
    facts = {**{name: value for name, value in case.items() if name not in of_tests},
             'blender': bpy.app.version_string, 'cycles': settings, 'seconds': round(time.monotonic() - began, 1)}
    os.replace(partial, options.output / (case['name'] + '.exr'))
    (options.output / (case['name'] + '.json')).write_text(json.dumps(facts, indent=2) + '\n', encoding='utf-8')
    print(f"{case['name']}: {facts['seconds']} s", flush=True)


def main():
    options = arguments()
    if importlib.util.find_spec('numpy') is None:
        print("skipped: Blender's glTF importer needs Python's numpy (Debian: python3-numpy)")
        sys.exit(77)
    import numpy
    if 'bool' not in vars(numpy):
        numpy.bool = numpy.bool_  # Blender 3.4's importer uses it; NumPy 1.24, beside it in Debian, has dropped it
    for case in cases(options):
        render(case, options)


main()
