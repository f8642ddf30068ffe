#!/usr/bin/env python3
"""glTF-Validator's own test files, each read and rendered. They are not part of this project: give it a folder with them,
such as `test` of github.com/KhronosGroup/glTF-Validator. Beside each file lies what the validator says of it
(NAME.report.json).

Usage: validator_cases.py BUILD_FOLDER FOLDER [FIRST LAST]     of the files in order of their names; default: all
A valid file has to be rendered, except those in REFUSED. An invalid one has to be refused, or rendered with a note of what
was left out, except those in HARMLESS, of which nothing is. Prints those that are not so, those that an exception is wrong
about, and with --all every file, with what was said.
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

# Valid files that are refused, by a message that has this in it.
REFUSED = {"asset/min_version_valid.gltf": "it is glTF 2.1; version 2.0 is needed"}

# Notes that tell nothing of what the file says: its whole content is there.
GENERAL = ("it has no scene: all its nodes are imported", "the scene has no lights: lit by the default sky and sun",
           "animations, 'animation 0' is played")

# Invalid files of which nothing is left out, by the reason, which is one for all of its files.
HARMLESS = {
    "an empty list or object says as much as none at all": """
        accessor/empty_array animation/empty_array buffer/empty_array buffer_view/empty_array camera/empty_array
        image/empty_array material/empty_array mesh/empty_array node/empty_array node/empty_children_array
        sampler/empty_array scene/empty_array scene/empty_nodes_array skin/empty_array texture/empty_array
        KHR_lights_punctual/light/empty_lights_array KHR_lights_punctual/light/empty_object
        KHR_materials_variants/primitive/empties KHR_materials_variants/variant/empty_array
        KHR_materials_variants/variant/empty_object""",
    "nothing uses the part that is wrong, and it is right as far as it is read": """
        accessor/byteoffset_no_bufferview accessor/float_normalized accessor/invalid_sparse_count_and_stride
        accessor_data/invalid_elements_float buffer_view/invalid_stride_too_big buffer_view/invalid_stride_wrong_target
        camera/extra_type camera/orthographic_xy camera/orthographic_z camera/perspective_z image/invalid_image_data
        image/png_eos mesh/accessor_attribute_uint32 mesh/invalid_attribute mesh/invalid_attribute_escaped_name
        mesh/invalid_indexed_attribute mesh/morph_attribute_no_base mesh/morph_unequal_targets_count
        mesh/morph_weights_wrong_count mesh/unequal_joints mesh_data/colors_non_clamped
        mesh_data/index_buffer_primitive_restart mesh_data/normals_tangents_non_unit_invalid_sign
        skin/empty_joints_array skin/no_common_root skin/skeleton_invalid skin_data/invalid_ibm
        EXT_texture_webp/texture/undeclared_extension KHR_lights_punctual/light/spot_invalid_angles
        KHR_materials_emissive_strength/material/out_of_range KHR_materials_ior/material/out_of_range
        KHR_materials_specular/material/out_of_range KHR_materials_variants/primitive/dependency
        KHR_materials_variants/primitive/non_unique KHR_materials_variants/primitive/unresolved_references
        KHR_texture_transform/textureInfo/uv_sets""",
    "bounds are computed from the elements, whatever the file says or does not say of them": """
        accessor_data/out_of_range_elements_float accessor_data/out_of_range_elements_sint16
        accessor_data/out_of_range_elements_sint8 accessor_data/out_of_range_elements_uint16
        accessor_data/out_of_range_elements_uint32 accessor_data/out_of_range_elements_uint8
        animation/sampler_input_no_bounds mesh/morph_position_accessor_no_bounds mesh/position_accessor_no_bounds""",
    "rotations are made to have unit length": """
        animation_data/quaternion_cubic_non_unit_values animation_data/quaternion_non_unit_values
        node/rotation_non_unit""",
    "a node's matrix is taken apart as it is read, so that what is animated takes the place of its part":
        "animation/channel_node_matrix",
    "the bytes are read, whatever type or parameter they are labelled with":
        "buffer/invalid_uri_data.gltf buffer/invalid_uri_data_mime image/invalid_data_uri_mime_type",
    "a byte order mark is skipped": "glb/bom json/bom",
    "all chunks are read: the binary one wherever it stands, and lengths need no alignment":
        "glb/misplaced_bin_chunk glb/unaligned_chunk",
    "a child named by a scene is drawn as such; its parent is not of that scene": "scene/non_root_node",
    "said twice or not said, an extension is known or it isn't": """
        root/duplicate_extension_entry root/extensions_undeclared_wrong_pointer EXT_texture_webp/image/undeclared_extension
        KHR_mesh_quantization/primitive/non_required""",
    "a variant without a name has its number for one": "KHR_materials_variants/variant/invalid_name",
    "an extension means nothing in that place": """
        KHR_lights_punctual/node/unexpected_extension KHR_materials_emissive_strength/material/unexpected_extension
        KHR_materials_ior/material/unexpected_extension KHR_materials_specular/material/unexpected_extension
        KHR_materials_transmission/material/unexpected_extension KHR_materials_unlit/material/unexpected_extension
        KHR_materials_variants/primitive/unexpected_extension KHR_mesh_quantization/primitive/unexpected_extension
        KHR_node_visibility/node/unexpected_extension KHR_texture_transform/textureInfo/unexpected_extension""",
}
HARMLESS_NAMES = {name for names in HARMLESS.values() for name in names.split()}


def verdict(build, file, folder):
    """What render makes of it: rendered or refused, and its notes."""
    command = [str(build / "bin/sunfleck"), "render", str(file), "-o", str(folder / "p.png"), "--size", "16x9", "--lights",
               "8", "--warmup", "0", "--frames", "1"]
    try:
        run = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
                             timeout=60)
    except subprocess.TimeoutExpired:
        return "hung", []
    said = [line for line in run.stdout.splitlines() if "error:" in line or "warning:" in line]
    left = [name for name in os.listdir(folder) if name != "p.png"]
    if run.returncode == 0 and not left:
        return "rendered", said
    if run.returncode == 1 and any("error:" in line for line in said) and not left and not (folder / "p.png").exists():
        return "refused", said
    return f"wrong: exit {run.returncode}, {left}", [run.stdout[-300:]]


def short_name(file, root):
    """Without the folders that all of them have: accessor/alignment.gltf, KHR_materials_ior/material/out_of_range.gltf."""
    return "/".join(part for part in file.relative_to(root).parts if part not in ("test", "base", "ext", "data"))


def judge(valid, outcome, said, name):
    """A column of the table, and what is wrong with it, if anything is."""
    if outcome not in ("rendered", "refused"):
        return "wrong", outcome
    if valid and outcome == "refused":
        known = REFUSED.get(name, "no reason for that is known")
        return ("refused, as listed", "") if known in said[-1] else ("wrong", known)
    if valid or outcome == "refused":
        return outcome, "" if name not in REFUSED else "it is listed as one that is refused"
    notes = [line for line in said if not line.endswith(GENERAL)]
    harmless = not HARMLESS_NAMES.isdisjoint((name, name.rsplit(".", 1)[0]))
    if notes:
        return "rendered, with a note of what was left out", "it is listed as harmless" if harmless else ""
    return ("rendered, nothing left out, as listed", "") if harmless else ("wrong", "nothing says what was left out")


def main():
    arguments = [a for a in sys.argv[1:] if a != "--all"]
    build, root = pathlib.Path(arguments[0]).resolve(), pathlib.Path(arguments[1]).resolve()
    files = sorted(file for kind in ("*.gltf", "*.glb") for file in root.rglob(kind))
    first, last = (int(a) for a in arguments[2:4]) if len(arguments) > 3 else (1, len(files))
    counts, wrong = {}, 0
    for file in files[first - 1:last]:
        report = file.with_name(file.name + ".report.json")
        valid = not report.exists() or json.loads(report.read_text())["issues"]["numErrors"] == 0
        name = short_name(file, root)
        with tempfile.TemporaryDirectory() as folder:
            outcome, said = verdict(build, file, pathlib.Path(folder))
        column, problem = judge(valid, outcome, said, name)
        key = "valid" if valid else "invalid", column
        counts[key] = counts.get(key, 0) + 1
        wrong += problem != ""
        if problem or "--all" in sys.argv:
            print(f"{key[0]}, {column}: {name}: {problem}: {'; '.join(said)}", flush=True)
    for (kind, column), number in sorted(counts.items()):
        print(f"| {kind} | {column} | {number} |")
    print(f"{sum(counts.values())} tried, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
