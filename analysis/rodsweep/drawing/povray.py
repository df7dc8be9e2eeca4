"""A frame as a scene for POV-Ray, and its picture.

Segments and obstacles are cylinders with spheres of the same radius at their ends; a held segment without length is a
plate. The floor is a disc that takes shadows and fades into the white background. A slope is a disc with an edge,
which is glass from behind. Vectors need no conversion: POV-Ray's camera takes right, up and direction in any
handedness. The picture comes through a pipe; the scene is a temporary file, since POV-Ray cannot read one from a pipe.
"""

import subprocess
import tempfile

import numpy as np

from rodsweep.drawing import staging
from rodsweep.reading.errors import ToolError

SETTINGS = ("-D", "-V", "-GA", "+O-", "+FN8", "-J")
EDGES = {False: ("+A0.2", "+AM2", "+R2"), True: ("+A0.05", "+AM1", "+R3")}   # antialiasing; fine: three times slower
LAMP = 0.4    # width of the lamp as a share of the scene's extent; sets how soft its shadows are
PLATE = 0.3   # thickness of a wall's plate as a share of the radius of the sphere around it
STONE = "pigment{srgb <0.80, 0.78, 0.74>} finish{ambient 0.14 diffuse 0.75}"
GLASS = "pigment{srgbt <0.80, 0.78, 0.74, 0.8>} finish{ambient 0.14 diffuse 0.75} no_shadow"
BUSY, TRIES = b"Timed out waiting for worker thread startup", 5   # POV-Ray's message on a busy machine
SLAB = 0.02   # thickness of a slope's disc as a share of its radius


def scene(trajectory, stage, colours, frame):
    """The text of one frame. colours: those of tints.colours()."""
    return (surroundings(stage) + obstacles(stage, trajectory.time_s[frame]) +
            tubes(trajectory, colours, frame))


def surroundings(stage):
    """Camera, lights, and the floor unless it is seen from below."""
    seen, up = stage.camera, stage.up
    across, upwards = (2 * tangent for tangent in seen.tangents)
    lamp = stage.centre + stage.extent * (2.4 * up - 0.8 * seen.right - 0.6 * seen.forward)
    fill = stage.centre + stage.extent * (0.6 * up + 1.6 * seen.right - 2.0 * seen.forward)
    wide = LAMP * stage.extent
    text = f"""#version 3.7;
global_settings {{ assumed_gamma 1 max_trace_level 3 }}
background {{ rgb 1 }}
camera {{ perspective location {vector(seen.eye)} direction {vector(seen.forward)}
  right {vector(across * seen.right)} up {vector(upwards * seen.up)} }}
light_source {{ {vector(lamp)} rgb 0.95 area_light {vector(wide * seen.right)}, {vector(wide * seen.up)},
  5, 5 adaptive 1 circular orient }}
light_source {{ {vector(fill)} rgb 0.3 shadowless }}
"""
    if stage.floor is None or seen.eye @ up < stage.floor:   # from below, the floor would hide everything
        return text
    under = stage.centre + (stage.floor - stage.centre @ up) * up
    return text + f"""plane {{ {vector(up)}, 0
  texture {{ cylindrical texture_map {{
    [0 pigment {{ rgb 1 }} finish {{ ambient 0 diffuse 0 emission 1 }}]
    [0.7 pigment {{ rgb 0.97 }} finish {{ ambient 0 diffuse 0.6 emission 0.4 }}] }}
    scale {number(2.5 * stage.extent)} {turned_from_y(up)} }}
  translate {vector(under)} }}
"""


def turned_from_y(up):
    """Rotation of POV-Ray's cylindrical pattern from its axis y to `up`."""
    if abs(up[1]) > 0.9:
        return ""
    return "rotate 90*x" if abs(up[2]) > 0.9 else "rotate 90*z"


def obstacles(stage, time_s=0.0):
    """Balls, capsules and slopes at a time."""
    parts = []
    for solid in (solid.at(time_s) for solid in stage.solids):
        ends = [f"sphere{{{vector(end)},{number(solid.radius)}}}" for end in (solid.start, solid.end)]
        body = f"cylinder{{{vector(solid.start)},{vector(solid.end)},{number(solid.radius)}}}"
        parts.append(f"union{{{' '.join([*ends, body])} {STONE}}}\n" if (solid.start != solid.end).any() else
                     f"object{{{ends[0]} {STONE}}}\n")
    for slope in (slope.at(time_s) for slope in stage.slopes):
        middle, radius = slope.disc(stage.centre, stage.extent)
        behind = (stage.camera.eye - middle) @ slope.normal < 0
        parts.append(f"cylinder{{{vector(middle - SLAB * radius * slope.normal)},{vector(middle)},{number(radius)} "
                     f"{GLASS if behind else STONE}}}\n")
    return "".join(parts)


def tubes(trajectory, colours, frame):
    colour = colours.numbers(frame)
    low, high = trajectory.ends(frame)
    parts = []
    for k in np.unique(colour):
        mine = (colour == k) & (trajectory.length > 0)
        radius = trajectory.radius[mine, None]
        body = many("cylinder{<%.7g,%.7g,%.7g>,<%.7g,%.7g,%.7g>,%.7g}\n", low[mine], high[mine], radius)
        body += "".join(many("sphere{<%.7g,%.7g,%.7g>,%.7g}\n", ends[mine], radius) for ends in (low, high))
        walls = (colour == k) & (trajectory.length <= 0)
        if walls.any():
            radius = staging.drawn_radius(trajectory)[walls, None]
            behind = low[walls] - PLATE * radius * trajectory.axes(frame)[walls]
            body += many("cylinder{<%.7g,%.7g,%.7g>,<%.7g,%.7g,%.7g>,%.7g}\n", behind, low[walls],
                         np.sqrt(1 - PLATE ** 2) * radius)
        parts.append(f"union{{\n{body}pigment{{srgb {vector(colours.palette[k])}}} "
                     "finish{ambient 0.14 diffuse 0.78 specular 0.18 roughness 0.03}}\n")
    return "".join(parts)


def many(shape, *columns):
    """`shape` for every row of the columns. All numbers are formatted in one operation, which is fast."""
    rows = np.concatenate(columns, axis=1)
    return (shape * len(rows)) % tuple(rows.ravel().tolist())


def vector(values):
    return "<" + ", ".join(number(v) for v in values) + ">"


def number(value):
    return f"{value:.12g}"


def picture(text, size, threads=1, fine=False):
    """PNG bytes. Raises ToolError with POV-Ray's message if it fails."""
    with tempfile.NamedTemporaryFile("w", suffix=".pov", encoding="ascii") as scene_file:
        scene_file.write(text)
        scene_file.flush()
        command = ["povray", *SETTINGS, *EDGES[fine], f"+I{scene_file.name}", f"+W{size[0]}", f"+H{size[1]}",
                   f"+WT{threads}"]
        for _ in range(TRIES):
            done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, check=False)
            if BUSY not in done.stderr:
                break
    if done.returncode or not done.stdout.startswith(b"\x89PNG"):
        said = [line for line in done.stderr.decode("utf-8", "replace").splitlines() if line.strip()]
        raise ToolError("povray failed: " + " ".join(said[-8:]))
    return done.stdout
