"""Renders a scene of Lightloom with Mitsuba 3 (https://mitsuba-renderer.org): a row of a study by `External(…)`.

Reads the scene as `{scene}` gives it (glTF binary, KHR_lights_punctual) and the camera of `{camera}` (JSON). Surfaces are
diffuse where they are matte, and Mitsuba's `principled` where not; textures are left out but for their factors. Time is
spent in passes of one sample for each pixel.
"""

import argparse
import json
import math
import os
import struct
import tempfile
import time

import mitsuba as mi

mi.set_variant("scalar_rgb")

COMPONENTS = {5121: "B", 5123: "H", 5125: "I", 5126: "f"}
SIZES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class Glb:
    """A binary glTF file, as Lightloom writes it: each buffer view holds one accessor, in world space."""

    def __init__(self, path):
        with open(path, "rb") as file:
            data = file.read()
        if data[:4] != b"glTF":
            raise SystemExit(f"{path}: expected a .glb file")
        (length,) = struct.unpack_from("<I", data, 12)
        self.json = json.loads(data[20 : 20 + length])
        self.binary = data[28 + length :]

    def bytes(self, index):
        """Returns the bytes of an accessor, and the number of its elements."""
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        start = view.get("byteOffset", 0)
        return self.binary[start : start + view["byteLength"]], accessor["count"]

    def numbers(self, index):
        accessor = self.json["accessors"][index]
        data, count = self.bytes(index)
        return struct.unpack(f"<{count * SIZES[accessor['type']]}{COMPONENTS[accessor['componentType']]}", data)


def write_ply(path, positions, normals, indices):
    """Writes the triangles that `indices` names, each vertex once."""
    used = {}
    triangles = [used.setdefault(index, len(used)) for index in indices]
    with open(path, "wb") as file:
        fields = "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
        file.write(
            f"ply\nformat binary_little_endian 1.0\nelement vertex {len(used)}\n{fields}"
            f"element face {len(triangles) // 3}\nproperty list uchar int vertex_index\nend_header\n".encode()
        )
        for index in used:
            at = slice(3 * index, 3 * index + 3)
            file.write(struct.pack("<6f", *positions[at], *normals[at]))
        for first in range(0, len(triangles), 3):
            file.write(struct.pack("<B3i", 3, *triangles[first : first + 3]))


def backs(positions, normals, indices):
    """Returns the same triangles, seen from behind, and a little behind."""
    gap = 1e-5 * max(max(positions[axis::3]) - min(positions[axis::3]) for axis in range(3))
    positions = [position - gap * normal for position, normal in zip(positions, normals)]
    return positions, [-normal for normal in normals], indices[::-1]


def rgb(values):
    return {"type": "rgb", "value": [float(value) for value in values]}


def bsdf(material):
    pbr = material.get("pbrMetallicRoughness", {})
    color = pbr.get("baseColorFactor", [1, 1, 1, 1])[:3]
    metallic, roughness = pbr.get("metallicFactor", 1.0), pbr.get("roughnessFactor", 1.0)
    specular = material.get("extensions", {}).get("KHR_materials_specular", {})
    reflects = specular.get("specularFactor", 1.0) * max(specular.get("specularColorFactor", [1, 1, 1]))
    if metallic == 0 and (roughness == 1 or reflects == 0):
        own = {"type": "diffuse", "reflectance": rgb(color)}
    else:
        # Half of Mitsuba's `specular` is a reflectance of 0.04 at normal incidence.
        own = {"type": "principled", "base_color": rgb(color), "metallic": metallic, "roughness": max(roughness, 0.02)}
        own["specular"] = min(0.5 * reflects, 1.0)
    return {"type": "twosided", "bsdf": own}


def emission(material):
    strength = material.get("extensions", {}).get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1.0)
    return [strength * factor for factor in material.get("emissiveFactor", [0, 0, 0])]


def falloff(inner, outer):
    """Returns the falloff of KHR_lights_punctual as a picture over the square around the cone."""
    side = 256
    values = []
    for y in range(side):
        for x in range(side):
            u, v = (2 * (x + 0.5) / side - 1, 2 * (y + 0.5) / side - 1)
            cosine = 1 / math.sqrt(1 + (u * u + v * v) * math.tan(outer) ** 2)
            ramp = (cosine - math.cos(outer)) / (math.cos(inner) - math.cos(outer))
            values.append(min(max(ramp, 0), 1) ** 2)
    data = mi.TensorXf(values, (side, side, 1))
    return {"type": "bitmap", "bitmap": mi.Bitmap(data), "raw": True, "wrap_mode": "clamp"}


def emitter(light, node):
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])
    # A light of glTF shines along −z of its node.
    direction = mi.ScalarVector3f(-2 * (x * z + w * y), -2 * (y * z - w * x), -(1 - 2 * (x * x + y * y)))
    position = mi.ScalarPoint3f(node.get("translation", [0, 0, 0]))
    intensity = [light.get("intensity", 1.0) * channel for channel in light.get("color", [1, 1, 1])]
    if light["type"] == "directional":
        return {"type": "directional", "direction": direction, "irradiance": rgb(intensity)}
    if light["type"] == "point":
        return {"type": "point", "position": position, "intensity": rgb(intensity)}
    inner, outer = light["spot"].get("innerConeAngle", 0.0), light["spot"].get("outerConeAngle", math.pi / 4)
    outer = min(outer, math.radians(89))
    inner = min(inner, outer)
    up = [0, 1, 0] if abs(direction.y) < 0.9 else [1, 0, 0]
    spot = {"type": "spot", "intensity": rgb(intensity), "cutoff_angle": math.degrees(outer)}
    # The whole cone has the same intensity here; what falls off is a picture before it.
    spot["beam_width"] = spot["cutoff_angle"]
    spot["to_world"] = mi.ScalarTransform4f().look_at(origin=position, target=position + direction, up=up)
    if inner < 0.999 * outer:
        spot["texture"] = falloff(inner, outer)
    return spot


def scene_of(glb, camera, folder):
    view = mi.ScalarTransform4f().look_at(origin=camera["position"], target=camera["target"], up=camera["up"])
    scene = {
        "type": "scene",
        "sensor": {
            "type": "perspective",
            "fov": math.degrees(camera["vertical_fov"]),
            "fov_axis": "y",
            "near_clip": camera["near"],
            "to_world": view,
            "sampler": {"type": "independent"},
            # A pixel is the mean over its square.
            "film": {
                "type": "hdrfilm",
                "width": camera["width"],
                "height": camera["height"],
                "pixel_format": "rgb",
                "component_format": "float32",
                "rfilter": {"type": "box"},
            },
        },
    }
    if "environment" in camera:
        # The middle of a row of Lightloom's maps is −z, and here it is +z.
        turn = 180 + math.degrees(camera["environment"]["rotation"])
        to_world = mi.ScalarTransform4f().rotate([0, 1, 0], turn)
        scene["sky"] = {"type": "envmap", "filename": camera["environment"]["file"], "to_world": to_world}
    materials = glb.json.get("materials", [])
    for number, mesh in enumerate(glb.json.get("meshes", [])):
        for part, primitive in enumerate(mesh["primitives"]):
            attributes = primitive["attributes"]
            triangles = [glb.numbers(attributes["POSITION"]), glb.numbers(attributes["NORMAL"])]
            sides = [(*triangles, glb.numbers(primitive["indices"]))]
            material = materials[primitive["material"]]
            # Surfaces emit on both sides; a shape of Mitsuba emits on one.
            emits = any(emission(material))
            if emits:
                sides.append(backs(*sides[0]))
            for side, triangles in enumerate(sides):
                name = f"mesh_{number}_{part}_{side}"
                path = os.path.join(folder, f"{name}.ply")
                write_ply(path, *triangles)
                scene[name] = {"type": "ply", "filename": path, "bsdf": bsdf(material)}
                if emits:
                    scene[name]["emitter"] = {"type": "area", "radiance": rgb(emission(material))}
    lights = glb.json.get("extensions", {}).get("KHR_lights_punctual", {}).get("lights", [])
    for number, node in enumerate(glb.json.get("nodes", [])):
        index = node.get("extensions", {}).get("KHR_lights_punctual", {}).get("light")
        if index is not None:
            scene[f"light_{number}"] = emitter(lights[index], node)
    return mi.load_dict(scene)


def main():
    parser = argparse.ArgumentParser(description="Render a scene of Lightloom with Mitsuba 3.")
    parser.add_argument("scene")
    parser.add_argument("camera")
    parser.add_argument("out")
    parser.add_argument("--output", choices=["image", "direct", "indirect"], default="indirect")
    parser.add_argument("--bounces", type=int, default=1, help="bounces of indirect light")
    parser.add_argument("--samples", type=int, default=1 << 20, help="the most samples for each pixel")
    parser.add_argument("--seconds", type=float, default=math.inf, help="the time after which it ends")
    parser.add_argument("--seed", type=int, default=0)
    args = parser.parse_args()
    mi.set_log_level(mi.LogLevel.Error)
    with open(args.camera) as file:
        camera = json.load(file)
    with tempfile.TemporaryDirectory() as folder:
        scene = scene_of(Glb(args.scene), camera, folder)

    def path(depth):
        return mi.load_dict({"type": "path", "max_depth": depth, "rr_depth": 1 << 20})

    # Paths of two edges are direct light. Both begin with the same random numbers, and so with the same direct light, which the
    # difference is without: no noise of it is left.
    plus = path(2 if args.output == "direct" else args.bounces + 2)
    minus = path(2) if args.output == "indirect" else None
    begun, total, samples = time.perf_counter(), None, 0
    while samples < args.samples and (samples == 0 or time.perf_counter() - begun < args.seconds):
        seed = (args.seed << 20) + samples
        picture = mi.render(scene, integrator=plus, spp=1, seed=seed)
        if minus:
            picture = picture - mi.render(scene, integrator=minus, spp=1, seed=seed)
        total = picture if total is None else total + picture
        samples += 1
    elapsed = time.perf_counter() - begun
    bitmap = mi.Bitmap(total / samples)
    bitmap.metadata()["software"] = f"Mitsuba {mi.__version__}"
    bitmap.metadata()["samples"] = samples
    bitmap.write(args.out)
    print(f"{samples} samples in {elapsed:.2f} s")
    print(f"lightloom: ms {1000 * elapsed:.3f}")


if __name__ == "__main__":
    main()
