"""Where Sunfleck's movers are at step 0, which glTF does not say (engine/simulation/path_movers.cpp)."""

import math

import bpy
from mathutils import Quaternion, Vector


def in_blender(vector):
    """From glTF's Y up to Blender's Z up."""
    return Vector((vector[0], -vector[2], vector[1]))


def pose_all(entities):
    for name, parts in entities.items():
        mover = parts.get('Mover', {})
        if mover.get('path', 'none') != 'none' and mover['activation'] == 'clock':
            pose(bpy.data.objects[name], mover, parts)


def pose(thing, mover, parts):
    share = mover['phase'] % 1.0
    axis = in_blender(mover['axis']).normalized()
    centre = in_blender(mover['centre'])
    thing.rotation_mode = 'QUATERNION'
    if mover['path'] == 'line':
        thing.location += along(mover['easing'], share) * in_blender(mover['travel'])
    elif mover['path'] == 'spline':
        on_spline(thing, parts['SplinePath'], share)
    elif mover['path'] == 'spin':
        thing.rotation_quaternion = Quaternion(axis, 2.0 * math.pi * share) @ thing.rotation_quaternion
    elif mover['path'] == 'circle':
        thing.location = centre + Quaternion(axis, 2.0 * math.pi * share) @ (thing.location - centre)
    elif mover['path'] == 'hinge':
        turn = Quaternion(axis, along(mover['easing'], share) * mover['angle'])
        thing.location = centre + turn @ (thing.location - centre)
        thing.rotation_quaternion = turn @ thing.rotation_quaternion


def along(easing, share):
    """Place on a line or hinge, -1 to 1."""
    if easing == 'sine':
        return math.sin(2.0 * math.pi * share)
    triangle = 4.0 * abs((share - 0.25) % 1.0 - 0.5) - 1.0
    if easing == 'linear':
        return triangle
    half = 0.5 * min(max(2.0 * triangle, -1.0), 1.0) + 0.5
    return 2.0 * half * half * (3.0 - 2.0 * half) - 1.0


def on_spline(thing, path, share):
    if share != 0.0:
        raise SystemExit(f"error: {thing.name}: a spline is known at its start only")
    points = [Vector(path[f'point_{i + 1}']) for i in range(path['count'])]
    thing.location = in_blender(points[0])
    direction = points[1] - points[-1]
    if path['face_travel']:
        thing.rotation_quaternion = Quaternion((0.0, 0.0, 1.0), math.atan2(-direction.x, -direction.z))
