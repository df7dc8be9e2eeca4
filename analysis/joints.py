"""Which segments of a trajectory are joined, found from where their ends meet at the start."""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

NEAR = 1e-3   # of the shorter segment's length: ends this close are one point


def pairs(trajectory):
    """[joint, 2] numbers of segments of one rod that share an end in the first frame; where several do, all are joined
    to the first of them."""
    ends = np.concatenate(trajectory.ends(0))
    count = len(trajectory.length)
    near = NEAR * trajectory.length[trajectory.length > 0].min(initial=np.inf)
    close = cKDTree(ends).query_pairs(near if np.isfinite(near) else 0, output_type="ndarray")
    a, b = close.T % count if len(close) else np.empty((2, 0), dtype=int)
    same = trajectory.rod[a] == trajectory.rod[b]
    # Ends that meet are one point; a point joins all segments that have an end there.
    links = coo_matrix((np.ones(same.sum()), tuple(close[same].T)), shape=(2 * count, 2 * count))
    point = connected_components(links, directed=False)[1]
    segment = np.tile(np.arange(count), 2)
    order = np.lexsort((segment, point))
    first = np.r_[True, np.diff(point[order]) > 0]
    hub = segment[order][np.flatnonzero(first)[np.cumsum(first) - 1]]
    found = np.stack([hub, segment[order]], axis=1)[hub != segment[order]]
    return np.unique(found, axis=0)
