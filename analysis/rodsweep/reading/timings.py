"""Times and speedups per simulation, from the rows of /timing: sums over a simulation, like CG ratios.

A row has the times of the parts of a solve: assembly, each guess and its CG to the job's tolerance, the direct solve.
Parts take microseconds, but the operating system's interruptions take milliseconds: one could exceed a simulation. A
row is left out, for all guesses, if a part took over INTERRUPTED times its usual time and FLOOR_S longer. Sums are
then scaled up to all rows. The usual time is a median per unit of work. Units of CG are iterations, with FIXED for the
cost of every solve. Units of a guess are products with A before the first iteration, plus one. Units of the rest of a
step are Newton iterations, plus one for prediction and velocities. The median is over the simulation's rows of the
same Newton iteration. A guess may differ between them (nearest data at the first, no history at a late one).
If they are fewer than FEW, the median of an earlier iteration or of all rows is used. Two kinds of parts are only
compared among themselves, and only if there are FEW: CG without an iteration, and parts that renewed a lagged
preconditioner or factor (/solves/renewed). Interruptions strike all parts: one that is long BY_DESIGN times as often as
the median part is not interrupted but slow by design, such as searches of nearest neighbours, and counts as it is.
CG has no time in a simulation where a solve missed the tolerance (unconverged.py).
Times.interrupted counts the rows left out. If they are at least FEW and interruptions took over SUSPICIOUS of the time,
interruptions() warns; each counts LONGEST_S at most, since a program that is suspended is no busy machine.
"""

from dataclasses import dataclass

import numpy as np

from rodsweep.reading import unconverged
from rodsweep.reading.measures import quotient

COLUMNS = ("/timing/solves/assemble_s", "/timing/solves/direct_s", "/timing/solves/guess_s", "/timing/solves/cg_s")
ROWS = ("/solves/newton", "/solves/iterations", "/solves/start_matvecs")
RENEWED = "/solves/renewed"
SPEEDUPS = {"cg": "CG only", "guess_cg": "guess + CG", "step": "whole step"}
INTERRUPTED = 5
FLOOR_S = 5e-6
LONGEST_S = 10e-3
FIXED = 4
FEW = 5
BY_DESIGN = 10
SUSPICIOUS = 0.1


@dataclass(frozen=True)
class Times:
    """Seconds summed over a simulation, [simulation, guess], over the solves that were timed for the guess.

    zero_* are the zero guess's times on the same solves (closed loop: in its own task); direct_s is NaN unless it was
    timed on all of them. cg_s is NaN if a solve missed the tolerance. rest_s belongs to all Newton iterations.
    """
    solves: np.ndarray
    interrupted: np.ndarray
    lost_s: np.ndarray  # what interruptions took, and what all parts of the other rows took
    kept_s: np.ndarray
    assemble_s: np.ndarray
    guess_s: np.ndarray
    cg_s: np.ndarray
    direct_s: np.ndarray
    rest_s: np.ndarray
    zero_assemble_s: np.ndarray
    zero_guess_s: np.ndarray
    zero_cg_s: np.ndarray
    zero_rest_s: np.ndarray


def timed(file):
    return bool(file.guesses) and all(file.has(path) for path in COLUMNS + ROWS)


def measured(by_newton):
    """Whether times() found a solve with its times."""
    return bool(np.isfinite(by_newton["all"].cg_s).any())


def times(file, sims):
    """{"first": Times, "all": Times} from one pass over the rows."""
    tasks, guesses, zero = sims.tasks(), len(file.guesses), file.zero
    names = ("solves", "kept", "lost_s", "kept_s", "assemble_s", "guess_s", "cg_s", "direct_s", "direct_kept",
             "zero_guess_s", "zero_cg_s")
    sums = {which: {name: np.zeros((file.task_count, guesses)) for name in names} for which in ("first", "later")}
    rung = timed_rung(file)
    optional = (RENEWED,) if file.has(RENEWED) else ()
    for owners, starts, rows in file.solve_blocks(tasks, COLUMNS + ROWS + optional):
        assemble, direct, guess, cg = (rows[path].astype(float) for path in COLUMNS)
        assemble, direct = assemble[:, None], direct[:, None]
        owner = np.repeat(owners, np.diff(np.append(starts, len(cg))))
        valid = np.isfinite(guess) & np.isfinite(cg) & np.isfinite(assemble)
        if zero is not None:  # in a paired sweep a guess and zero are compared on the same solves
            valid &= valid[:, [zero]] | (file.own_guess[owner] >= 0)[:, None]
        iterations = rows["/solves/iterations"][np.arange(len(cg)), :, rung[owner]].astype(float)
        parts = np.concatenate([assemble, direct, guess, cg], axis=1)
        work = np.ones(parts.shape)
        work[:, -2 * guesses:-guesses] = np.maximum(rows["/solves/start_matvecs"], 0) + 1.0
        work[:, -guesses:] = np.where(iterations >= 0, iterations + FIXED, np.nan)
        first = (rows["/solves/newton"] == 0)[:, None]
        apart = np.zeros(parts.shape, dtype=np.int8)
        apart[:, -guesses:] = iterations == 0
        if optional:
            apart[:, -2 * guesses:] += 2 * np.tile(rows[RENEWED] == 1, 2).astype(np.int8)
        lost = _lost_s(starts, parts, work, rows["/solves/newton"], apart)[:, None]
        all_s, smooth = np.nansum(parts, axis=1)[:, None], lost == 0
        for which, counted in (("first", valid & first), ("later", valid & ~first)):
            kept = counted & smooth
            with_direct = kept & np.isfinite(direct)
            parts = {"solves": counted, "kept": kept, "lost_s": np.where(counted, lost, 0),
                     "kept_s": np.where(kept, all_s, 0), "assemble_s": np.where(kept, assemble, 0),
                     "guess_s": np.where(kept, guess, 0), "cg_s": np.where(kept, cg, 0),
                     "direct_s": np.where(with_direct, direct, 0), "direct_kept": with_direct}
            if zero is not None:
                parts["zero_guess_s"] = np.where(kept, guess[:, [zero]], 0)
                parts["zero_cg_s"] = np.where(kept, cg[:, [zero]], 0)
            for name, values in parts.items():
                np.add.at(sums[which][name], owners, np.add.reduceat(values.astype(float), starts, axis=0))
    rest = np.broadcast_to(_rest_s(file, tasks)[:, None], (file.task_count, guesses))
    first, every = _scale(sums["first"]), _scale(sums["later"])  # in place: these arrays are most of the memory
    missed = unconverged.solves(file, "missed")
    found = {"first": _gathered(sims, zero, first, rest, missed)}
    for name in list(first):
        every[name] += first.pop(name)
    return {**found, "all": _gathered(sims, zero, every, rest, missed)}


def timed_rung(file):
    """Per task, the index of the tolerance that is nearest to that of the timed solves."""
    parameter = file.parameters.get("solve.tolerance")
    if parameter is None:
        return np.zeros(file.task_count, dtype=int)
    return np.argmin(np.abs(np.log(parameter.values[:, None] / file.tolerances[None, :])), axis=1)


def _lost_s(starts, parts, work, kind=None, apart=None):
    """What each row took longer in parts that took far longer than their median per work over the task's rows of that
    kind, and do not do so by design; 0 without an interruption. Parts with the same number above 0 in `apart` are only
    compared with each other."""
    lost = np.zeros(parts.shape)
    kind = np.zeros(len(parts)) if kind is None else kind
    apart = np.zeros(parts.shape, dtype=np.int8) if apart is None else apart
    none = np.full(parts.shape[1], np.nan)
    for begin, end in zip(starts, np.append(starts[1:], len(parts))):
        numbers, rate = apart[begin:end], parts[begin:end] / work[begin:end]
        usual = np.empty(rate.shape)
        for number in np.unique(numbers):
            of_number = np.where(numbers == number, rate, np.nan)
            medians = _medians(of_number, none, FEW if number else 1)
            for one in np.unique(kind[begin:end]):
                rows = kind[begin:end] == one
                if number == 0:
                    medians = _medians(of_number[rows], medians, FEW)
                usual[rows] = np.where(numbers[rows] == number, medians, usual[rows])
        expected = usual * work[begin:end]
        long = (parts[begin:end] > INTERRUPTED * expected) & (parts[begin:end] > expected + FLOOR_S)
        lost[begin:end] = np.where(long, np.minimum(parts[begin:end] - expected, LONGEST_S), 0)
    often = np.count_nonzero(lost, axis=0)
    by_design = often > BY_DESIGN * max(1, np.median(often))
    return np.where(by_design, 0, lost).sum(axis=1)


def _medians(rates, otherwise, fewest=1):
    """Median of each part's rates that are not NaN; `otherwise` if they are fewer than `fewest`. Called for every task
    and Newton iteration, so it must be fast: numpy.nanmedian takes five times as long."""
    ordered, count = np.sort(rates, axis=0), np.count_nonzero(~np.isnan(rates), axis=0)  # NaN last
    part = np.arange(rates.shape[1])
    middle = (ordered[(count - 1) // 2, part] + ordered[count // 2, part]) / 2
    return np.where(count >= fewest, middle, otherwise)


def _scale(sums):
    """Scales sums over the kept rows to all rows; direct_s is NaN unless all kept rows have it."""
    none = np.where(sums["solves"] > 0, np.nan, 1.0)
    scale = np.divide(sums["solves"], sums["kept"], out=none, where=sums["kept"] > 0)
    for name in sums.keys() - {"solves", "kept", "lost_s", "kept_s", "direct_kept"}:
        sums[name] *= scale
    sums["direct_s"][sums["direct_kept"] != sums["kept"]] = np.nan
    return sums


def _gathered(sims, zero, sums, rest, missed):
    """Sums of tasks by simulation and guess; NaN without solves, and of CG where a solve missed the tolerance."""
    solves = sims.gather(sums["solves"])

    def of(name, guess=None):
        return np.where(sims.gather(sums["solves"], guess) > 0, sims.gather(sums[name], guess), np.nan)

    def reached(cg_s, guess=None):
        return np.where(sims.gather(missed, guess) > 0, np.nan, cg_s)

    if zero is None:
        zero_assemble = zero_guess = zero_cg = zero_rest = np.full(sims.task.shape, np.nan)
    else:
        own = sims.own[:, None]
        zero_assemble = np.where(own, of("assemble_s", zero), of("assemble_s"))
        zero_guess = np.where(own, of("guess_s", zero), of("zero_guess_s"))
        zero_cg = reached(np.where(own, of("cg_s", zero), of("zero_cg_s")), zero)
        zero_rest = np.where(own, sims.gather(rest, zero), sims.gather(rest))
    lost_s, kept_s = sims.gather(sums["lost_s"]), sims.gather(sums["kept_s"])
    return Times(solves, solves - sims.gather(sums["kept"]), lost_s, kept_s, of("assemble_s"), of("guess_s"),
                 reached(of("cg_s")), of("direct_s"), sims.gather(rest), zero_assemble, zero_guess, zero_cg, zero_rest)


def _rest_s(file, tasks):
    """Seconds of the steps outside assembly and solves per task, without interruptions; NaN if not recorded."""
    total, kept, taken = (np.zeros(file.task_count) for _ in range(3))
    if file.has("/timing/steps/rest_s"):
        for owners, starts, rows in file.step_blocks(tasks, ["/timing/steps/rest_s", "/steps/newton_iterations"]):
            rest = rows["/timing/steps/rest_s"].astype(float)
            there = np.isfinite(rest)
            iterations = rows["/steps/newton_iterations"][:, None] + 1.0
            smooth = there & (_lost_s(starts, rest[:, None], iterations) == 0)
            for sums, values in ((total, np.where(smooth, rest, 0)), (kept, smooth), (taken, there)):
                np.add.at(sums, owners, np.add.reduceat(values.astype(float), starts))
    return np.divide(total * taken, kept, out=np.full(file.task_count, np.nan), where=kept > 0)


def speedups(by_newton, newton, against="zero"):
    """{"cg", "guess_cg", "step"}: [simulation, guess], time of zero-guess CG or of `direct` over the guess's time.

    The first two are over the chosen Newton iterations; the whole step always has all of them.
    """
    part, whole = by_newton[newton], by_newton["all"]
    step = whole.assemble_s + whole.guess_s + whole.cg_s + whole.rest_s
    if against == "direct":
        return {"cg": quotient(part.direct_s, part.cg_s), "guess_cg": quotient(part.direct_s, part.guess_s + part.cg_s),
                "step": quotient(whole.assemble_s + whole.direct_s + whole.rest_s, step)}
    zero_step = whole.zero_assemble_s + whole.zero_guess_s + whole.zero_cg_s + whole.zero_rest_s
    return {"cg": quotient(part.zero_cg_s, part.cg_s),
            "guess_cg": quotient(part.zero_guess_s + part.zero_cg_s, part.guess_s + part.cg_s),
            "step": quotient(zero_step, step)}


def direct_speedups(by_newton, newton, zero):
    """{"cg", "guess_cg", "step"}: [simulation], time of zero-guess CG over that of `direct` on the same systems."""
    return {name: quotient(1, values[:, zero]) for name, values in speedups(by_newton, newton, "direct").items()}


def direct_times(file, sims):
    """{"assemble_us", "direct_us"}: [simulation, 1], mean time per solve over all Newton iterations."""
    mean_us, _ = _direct_means(file, sims.tasks())
    return {name: mean_us[k][sims.any_task][:, None] for k, name in enumerate(("assemble_us", "direct_us"))}


def direct_step_us(file, sims):
    """[simulation]: mean time of a whole step with the direct solve; NaN if none was timed."""
    tasks = sims.tasks()
    mean_us, solves = _direct_means(file, tasks)
    step_us = (mean_us.sum(axis=0) * solves + 1e6 * _rest_s(file, tasks)) / np.maximum(file.steps, 1)
    return step_us[sims.any_task]


def _direct_means(file, tasks):
    """([assembly and direct solve, task] in us, [task] solves)"""
    sums, kept, solves = np.zeros((2, file.task_count)), np.zeros(file.task_count), np.zeros(file.task_count)
    paths = COLUMNS[:2]
    if all(file.has(path) for path in paths):
        for owners, starts, rows in file.solve_blocks(tasks, paths):
            both = np.stack([rows[path].astype(float) for path in paths], axis=1)
            there = np.isfinite(both).all(axis=1)
            smooth = there & (_lost_s(starts, both, np.ones(both.shape)) == 0)
            for part, values in zip(sums, both.T):
                np.add.at(part, owners, np.add.reduceat(np.where(smooth, values, 0), starts))
            for part, counted in ((kept, smooth), (solves, there)):
                np.add.at(part, owners, np.add.reduceat(counted.astype(float), starts))
    return np.divide(sums * 1e6, kept, out=np.full(sums.shape, np.nan), where=kept > 0), solves


def lost_share(part, sims):
    """The share of a Times that interruptions took; NaN if nothing was timed."""
    lost_s, kept_s = _total(part.lost_s, sims), _total(part.kept_s, sims)
    return float(quotient(lost_s, lost_s + kept_s))


def _total(values, sims):
    """Over simulations; guesses that are paired share their rows. NaN: what a simulation did not time."""
    return np.where(sims.own, np.nansum(values, axis=1), np.nan_to_num(values).max(axis=1, initial=0)).sum()


def interruptions(part, sims):
    """A sentence on the rows that a Times leaves out; empty if there are none."""
    solves, left_out = _total(part.solves, sims), _total(part.interrupted, sims)
    if not left_out:
        return ""
    found = (f"Left out: {left_out:.0f} of {solves:.0f} solves that the operating system interrupted "
             f"(a part lasted over {INTERRUPTED} times its median).")
    share = lost_share(part, sims)
    if left_out < FEW or share <= SUSPICIOUS:
        return found
    return (f"{found} Interruptions took {share:.0%} of the time: these times are not to be trusted. The machine "
            "was busy with other work, or some solves are slow by design.")
