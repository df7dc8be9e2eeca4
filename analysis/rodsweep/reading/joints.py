"""Joined segments of a trajectory: those whose ends, or middles in a net, meet in the first frame."""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

NEAR = 1e-3   # points this close, as a share of the shortest segment's length, are one


def pairs(trajectory):
    """[joint, 2] numbers of segments of one rod that share an end or the middle in the first frame. If several meet,
    all are joined to the first of them."""
    points = np.concatenate([*trajectory.ends(0), trajectory.centres(0)])
    count = len(trajectory.length)
    near = NEAR * trajectory.length[trajectory.length > 0].min(initial=np.inf)
    close = cKDTree(points).query_pairs(near if np.isfinite(near) else 0, output_type="ndarray")
    a, b = close.T % count if len(close) else np.empty((2, 0), dtype=int)
    same = trajectory.rod[a] == trajectory.rod[b]
    links = coo_matrix((np.ones(same.sum()), tuple(close[same].T)), shape=(len(points), len(points)))
    point = connected_components(links, directed=False)[1]
    segment = np.arange(len(points)) % count
    order = np.lexsort((segment, point))
    first = np.r_[True, np.diff(point[order]) > 0]
    hub = segment[order][np.flatnonzero(first)[np.cumsum(first) - 1]]
    found = np.stack([hub, segment[order]], axis=1)[hub != segment[order]]
    return np.unique(found, axis=0)
