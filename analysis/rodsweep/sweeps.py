"""Sweeps: values of a job that vary over its tasks, as the job format writes them."""


def grid(*values):
    """Each of these values; several grids form a cross product. The values may be one list, range or array."""
    return {"grid": _listed(values)}


def zip(*values):
    """Each of these values, in step with all other zips of the job. The values may be one list, range or array."""
    return {"zip": _listed(values)}


def uniform(low, high):
    """Random values from this range, `samples` of them."""
    return {"uniform": [low, high]}


def log_uniform(low, high):
    """Random values from this range, uniform in the logarithm."""
    return {"log_uniform": [low, high]}


def integer(low, high):
    """Random whole numbers from this range, with both ends."""
    return {"integer": [low, high]}


def _listed(values):
    alone = len(values) == 1 and hasattr(values[0], "__iter__") and not isinstance(values[0], (str, dict))
    return list(values[0] if alone else values)
