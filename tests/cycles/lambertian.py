"""Makes the materials of Blender's glTF importer Lambertian: base colour (factor, texture, vertex colours), alpha and
emission stay as they were imported; metal, gloss, glass and normal maps go. As `sunfleck reference --lambertian`."""

import math

import bpy

LUMINOUS_EFFICACY = 683.0  # glTF's nits over W/(sr m2)


def convert_all(entities):
    """`entities`: what a scene file says of its objects, by name."""
    for thing in list(bpy.data.objects):
        if thing.type != 'MESH':
            continue
        if not thing.data.materials:
            thing.data.materials.append(None)
        for index, material in enumerate(thing.data.materials):
            if material is None:
                thing.data.materials[index] = without_material()
    for thing in bpy.data.objects:
        if thing.type == 'MESH' and any(any(emission_of(slot.material)) for slot in thing.material_slots):
            divide(thing)
    lamps = materials_of(name for name, parts in entities.items() if 'AreaLight' in parts)
    passed = materials_of(name for name, parts in entities.items()
                          if not parts.get('ShadowCasting', {'casts': True})['casts'])
    for material in bpy.data.materials:
        if material.users > 0:
            convert(material, material.name in lamps, material.name in passed)


def divide(thing):
    """Emitting faces into small ones, for the same light: Cycles 3.4 samples a triangle that is large for its distance by
    solid angle, and loses several percent of light at grazing angles (docs/reference.md)."""
    levels = math.ceil(math.log(512 / max(len(thing.data.polygons), 1), 4))
    if levels > 0:
        modifier = thing.modifiers.new('small faces', 'SUBSURF')
        modifier.subdivision_type = 'SIMPLE'
        modifier.levels = modifier.render_levels = min(levels, 4)


def materials_of(names):
    """Their names. The built-in scenes have a material for each object."""
    things = [bpy.data.objects[name] for name in names if name in bpy.data.objects]
    return {slot.material.name for thing in things for slot in thing.material_slots}


def without_material():
    """What glTF prescribes where a file names none: white."""
    name = 'no material'
    if name in bpy.data.materials:
        return bpy.data.materials[name]
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.use_backface_culling = True
    principled(material).inputs['Base Color'].default_value = (1.0, 1.0, 1.0, 1.0)
    principled(material).inputs['Emission Strength'].default_value = 0.0
    return material


def principled(material):
    for node in material.node_tree.nodes:
        if node.type == 'BSDF_PRINCIPLED':
            return node
    raise SystemExit(f"error: material '{material.name}' is not one of metal and roughness")


def emission_of(material):
    """Radiance, W/(sr m2). Without KHR_materials_emissive_strength it has no unit, and scenes with such emission are
    not to be compared; nor are those with textures of emission, whose factor Blender's importer loses."""
    inputs = principled(material).inputs
    strength = inputs['Emission Strength'].default_value / LUMINOUS_EFFICACY
    if inputs['Emission'].is_linked:
        raise SystemExit(f"error: material '{material.name}' has a texture of emission")
    return tuple(channel * strength for channel in inputs['Emission'].default_value[:3])


def emits():
    return any(any(emission_of(material)) for material in bpy.data.materials if material.users > 0)


class Tree:
    """Shorthand for adding nodes to a material."""

    def __init__(self, material):
        self.tree = material.node_tree

    def node(self, kind, inputs=(), **properties):
        node = self.tree.nodes.new(kind)
        for name, value in properties.items():
            setattr(node, name, value)
        for index, value in inputs:
            self.set(node.inputs[index], value)
        return node

    def set(self, socket, value):
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(socket, value)
        else:
            socket.default_value = value

    def mix(self, factor, first, second):
        return self.node('ShaderNodeMixShader', [(0, factor), (1, first), (2, second)]).outputs[0]


def value_of(socket):
    """What feeds an input: a socket, or its own value."""
    if socket.is_linked:
        return socket.links[0].from_socket
    value = socket.default_value
    return tuple(value) if hasattr(value, '__len__') else value


def convert(material, is_lamp, is_passed):
    """is_lamp: an area light, which pictures of irradiance leave out. is_passed: light passes, it casts no shadow."""
    source = principled(material)
    tree = Tree(material)
    base, alpha = value_of(source.inputs['Base Color']), value_of(source.inputs['Alpha'])
    radiance = emission_of(material)
    from_camera = tree.node('ShaderNodeLightPath').outputs['Is Camera Ray']
    behind = tree.node('ShaderNodeNewGeometry').outputs['Backfacing']
    clear = tree.node('ShaderNodeBsdfTransparent').outputs[0]
    # The camera sees every surface white, so that a pass of light needs no division by a colour that may be black; and
    # lamps black, since the reference leaves them out. All other rays see the material.
    seen = 0.0 if is_lamp else 1.0
    colour = tree.node('ShaderNodeMixRGB', [(0, from_camera), (1, base), (2, (seen, seen, seen, 1.0))]).outputs[0]
    diffuse = tree.node('ShaderNodeBsdfDiffuse', [('Color', colour), ('Roughness', 0.0)]).outputs[0]
    surface = tree.mix(from_camera, clear, diffuse) if is_passed else diffuse
    if any(radiance):
        surface = with_emission(tree, surface, radiance, behind)
    if material.blend_method == 'CLIP':
        cut = tree.node('ShaderNodeMath', [(0, alpha), (1, material.alpha_threshold)], operation='LESS_THAN')
        surface = tree.mix(cut.outputs[0], surface, clear)
    elif material.blend_method == 'BLEND':
        surface = tree.mix(alpha, clear, surface)
    if material.use_backface_culling:
        # The camera looks through the back of a single-sided surface; light does not.
        unseen = tree.node('ShaderNodeMath', [(0, from_camera), (1, behind)], operation='MULTIPLY')
        surface = tree.mix(unseen.outputs[0], surface, clear)
    output = next(node for node in material.node_tree.nodes if node.type == 'OUTPUT_MATERIAL')
    tree.set(output.inputs['Surface'], surface)


def with_emission(tree, surface, radiance, behind):
    """Of the front side alone."""
    front = tree.node('ShaderNodeMath', [(0, 1.0), (1, behind)], operation='SUBTRACT')
    strength = max(radiance)
    glow = tree.node('ShaderNodeMath', [(0, front.outputs[0]), (1, strength)], operation='MULTIPLY')
    colour = tuple(channel / strength for channel in radiance) + (1.0,)
    emission = tree.node('ShaderNodeEmission', [('Color', colour), ('Strength', glow.outputs[0])])
    return tree.node('ShaderNodeAddShader', [(0, surface), (1, emission.outputs[0])]).outputs[0]
