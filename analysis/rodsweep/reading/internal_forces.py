"""Forces and moments inside segments, from those of their joints.

A cut across a segment with axis a transmits a force n and a moment m, of the part beyond the cut on the part before it:

    tension N = n . a [N]      bending M = |m - (m . a) a| [N m]      torsion T = m . a [N m]
    stress = |N| / A + M r / I [Pa]

Tension is positive if the segment is pulled, torsion if it is a right-handed screw. The stress is the largest axial
stress at the surface of a solid circle or a tube with outer radius r, area A and second moment I.

n and m are the means of those at the segment's two ends. At an end they are the sum over its joints. An end without
joints, such as the free end of a rod, does not count, and neither do joints at a segment's middle, where rods cross.
"""

import numpy as np

QUANTITIES = {"tension": "N", "bending": "N m", "torsion": "N m", "stress": "Pa"}
SIGNED = ("tension", "torsion")


def of_segments(shown, frame):
    """{quantity: [segment]} of a trajectory.Trajectory. NaN for segments without joints at their ends, and in the first
    frame, which has no forces. There is no stress if the section is neither a solid circle nor a tube."""
    axes, count = shown.axes(frame), len(shown.length)
    pairs = shown.joint_segments()
    segment = np.concatenate([pairs[:, 0], pairs[:, 1]])
    action = np.concatenate([shown.joint_forces(frame), shown.joint_moments(frame)], axis=1)
    on_segment = np.concatenate([action, -action])
    place = np.einsum("ij,ij->i", np.tile(shown.joint_positions(frame), (2, 1)) - shown.centres(frame)[segment],
                      axes[segment])
    length = shown.length[segment]    # 0 for walls, which have no ends
    end = np.where((length > 0) & (np.abs(place) > length / 4), np.sign(place), 0)
    total = np.zeros((count, 6))
    np.add.at(total, segment, end[:, None] * on_segment)
    ends = sum((np.bincount(segment[end == side], minlength=count) > 0).astype(float) for side in (-1, 1))
    force, moment = np.split(total / np.where(ends > 0, ends, np.nan)[:, None], 2, axis=1)
    tension, torsion = (np.einsum("ij,ij->i", vector, axes) for vector in (force, moment))
    bending = np.linalg.norm(moment - torsion[:, None] * axes, axis=1)
    found = {"tension": tension, "bending": bending, "torsion": torsion}
    if shown.wall is not None:
        outer, inner = shown.radius, np.maximum(shown.radius - shown.wall, 0)
        area, second_moment = np.pi * (outer ** 2 - inner ** 2), np.pi / 4 * (outer ** 4 - inner ** 4)
        found["stress"] = np.abs(tension) / area + bending * outer / second_moment
    return found
