"""Joined segments of a trajectory: those whose ends, or middles in a net, meet in the first frame."""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

NEAR = 1e-3   # points this close, as a share of the shortest segment's length, are one


def meeting(points, rod, reach):
    """(number of places, the place of each point): points of one rod that are at most `reach` apart are one place."""
    near = cKDTree(points).query_pairs(reach, output_type="ndarray").reshape(-1, 2)
    near = near[rod[near[:, 0]] == rod[near[:, 1]]]
    links = coo_matrix((np.ones(len(near)), tuple(near.T)), shape=(len(points), len(points)))
    return connected_components(links, directed=False)


def pairs(trajectory):
    """[joint, 2] numbers of segments of one rod that share an end or the middle in the first frame. If several meet,
    all are joined to the first of them."""
    points = np.concatenate([*trajectory.ends(0), trajectory.centres(0)])
    count = len(trajectory.length)
    near = NEAR * trajectory.length[trajectory.length > 0].min(initial=np.inf)
    _, point = meeting(points, np.tile(trajectory.rod, 3), near if np.isfinite(near) else 0)
    segment = np.arange(len(points)) % count
    order = np.lexsort((segment, point))
    first = np.r_[True, np.diff(point[order]) > 0]
    hub = segment[order][np.flatnonzero(first)[np.cumsum(first) - 1]]
    found = np.stack([hub, segment[order]], axis=1)[hub != segment[order]]
    return np.unique(found, axis=0)
