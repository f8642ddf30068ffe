"""Point lights, spots and suns of Blender's glTF importer as KHR_lights_punctual defines them, without extent; and the
light that Sunfleck gives to files without any.

The importer turns candela into the watts of a lamp by 4 pi / 683, and Cycles' point lamp of P watts has a radiant
intensity of P / (4 pi) W/sr: together, candela / 683. A sun's strength is the irradiance of a surface that faces it:
lux / 683. `floor` of scenes.json holds both to their closed form."""

import math

import bpy
from mathutils import Vector

# viewer::add_default_light: radiance of the sky, irradiance of the sun, and the direction towards it (Y up).
SKY = (0.28, 0.30, 0.34)
SUN = (2.0, 1.9, 1.7)
TOWARDS_SUN = (0.4, 1.0, 0.6)


def convert_all(something_emits):
    lamps = [thing for thing in bpy.data.objects if thing.type == 'LIGHT']
    for thing in lamps:
        kind = thing.data.type
        if kind == 'SUN':
            thing.data.angle = 0.0
        elif kind == 'POINT':
            thing.data.shadow_soft_size = 0.0
        elif kind == 'SPOT':
            convert_spot(thing)
    is_dark = not lamps and not something_emits
    set_world(SKY if is_dark else (0.0, 0.0, 0.0))
    if is_dark:
        add_sun()


def convert_spot(thing):
    """As a point light whose intensity falls off by (cos a - cos outer) / (cos inner - cos outer), squared: Blender's
    own spots fall off otherwise."""
    outer = 0.5 * thing.data.spot_size
    inner = outer * (1.0 - thing.data.spot_blend)
    axis = thing.matrix_world.to_3x3() @ Vector((0.0, 0.0, -1.0))
    thing.data.type = 'POINT'
    lamp = bpy.data.objects[thing.name].data  # of its new type
    lamp.shadow_soft_size = 0.0
    lamp.use_nodes = True
    tree = lamp.node_tree
    tree.nodes.clear()
    geometry = tree.nodes.new('ShaderNodeNewGeometry')  # Incoming: from the lamp to what it lights
    cosine = tree.nodes.new('ShaderNodeVectorMath')
    cosine.operation = 'DOT_PRODUCT'
    cosine.inputs[1].default_value = axis.normalized()
    tree.links.new(cosine.inputs[0], geometry.outputs['Incoming'])
    falloff = tree.nodes.new('ShaderNodeMapRange')
    falloff.clamp = True
    for name, value in (('From Min', math.cos(outer)), ('From Max', max(math.cos(inner), math.cos(outer) + 1e-3))):
        falloff.inputs[name].default_value = value
    tree.links.new(falloff.inputs['Value'], cosine.outputs['Value'])
    squared = tree.nodes.new('ShaderNodeMath')
    squared.operation = 'MULTIPLY'
    for socket in squared.inputs[:2]:
        tree.links.new(socket, falloff.outputs[0])
    emission = tree.nodes.new('ShaderNodeEmission')
    tree.links.new(emission.inputs['Strength'], squared.outputs[0])
    tree.links.new(tree.nodes.new('ShaderNodeOutputLight').inputs['Surface'], emission.outputs[0])


def set_world(radiance):
    world = bpy.data.worlds.new('world')
    world.use_nodes = True
    background = next(node for node in world.node_tree.nodes if node.type == 'BACKGROUND')
    background.inputs['Color'].default_value = radiance + (1.0,)
    background.inputs['Strength'].default_value = 1.0
    bpy.context.scene.world = world


def add_sun():
    lamp = bpy.data.lights.new('default sun', 'SUN')
    lamp.angle = 0.0
    lamp.energy = max(SUN)
    lamp.color = [channel / max(SUN) for channel in SUN]
    thing = bpy.data.objects.new('default sun', lamp)
    x, y, z = TOWARDS_SUN
    thing.rotation_mode = 'QUATERNION'
    thing.rotation_quaternion = Vector((x, -z, y)).to_track_quat('Z', 'Y')  # lamps shine along -Z
    bpy.context.scene.collection.objects.link(thing)
