#!/usr/bin/python3
"""jobs/slurm/sweep.sbatch with Slurm's environment, and with replacements of Slurm and of the program. For a real Slurm
see tests/cluster.

Run by CTest in an empty folder, with SOURCE_DIR in the environment.
"""

import os
import subprocess
import unittest

SCRIPT = os.path.join(os.environ["SOURCE_DIR"], "jobs", "slurm", "sweep.sbatch")


def stand_in(name, text):
    os.makedirs("bin", exist_ok=True)
    path = os.path.abspath(os.path.join("bin", name))
    with open(path, "w", encoding="ascii") as file:
        file.write("#!/bin/sh\n" + text + "\n")
    os.chmod(path, 0o755)
    return path


class SlurmScript(unittest.TestCase):
    def setUp(self):
        with open("job.json", "w", encoding="ascii") as file:
            file.write('{"kind": "sweep"}')
        stand_in("squeue", "date -d '+1 hour' +%FT%T")
        stand_in("scontrol", 'echo "scontrol $*"')
        stand_in("sleep", 'echo "sleep $*"')
        stand_in("mpirun", 'echo "mpirun $*"; exit ${CODE:-0}')
        self.program = os.path.abspath("rodsweep")

    def run_script(self, *words, code=0, **slurm):
        slurm = {"SLURM_JOB_ID": 7, "SLURM_NTASKS": 4, "SLURM_JOB_NUM_NODES": 2, "CODE": code, "RODSWEEP": self.program,
                 "PATH": os.path.abspath("bin") + os.pathsep + os.environ["PATH"], **slurm}
        ran = subprocess.run(["bash", SCRIPT, "job.json", *words], capture_output=True, text=True, timeout=600, check=False,
                             env={**os.environ, **{name: str(value) for name, value in slurm.items()}})
        self.assertEqual(ran.returncode, code, ran.stderr)
        return ran.stdout + ran.stderr

    def array(self, number, least, most, **slurm):
        return self.run_script("out.h5", SLURM_ARRAY_TASK_ID=number, SLURM_ARRAY_TASK_COUNT=most - least + 1,
                               SLURM_ARRAY_TASK_MIN=least, SLURM_ARRAY_TASK_MAX=most, **slurm)

    def test_a_sweep_has_a_master_beside_its_workers_and_what_is_left_of_the_time(self):
        said = self.run_script("out.h5", "--worker-timeout", "9")
        self.assertRegex(said, r"mpirun -n 5 --oversubscribe .* run job.json -o out.h5 --time-limit 3[34]\d\d --resume "
                               r"--worker-timeout 9\n")
        self.assertNotIn("scontrol", said)
        self.assertIn("scontrol requeue 7", self.run_script(code=4))

    def test_a_run_that_dies_is_repeated_and_one_that_ends_is_not(self):
        said = self.run_script("--retry-failed", code=137)
        self.assertEqual((said.count("mpirun "), said.count("--retry-failed")), (10, 1))
        for code in (0, 2, 3, 4, 5):
            self.assertEqual(self.run_script(code=code).count("mpirun "), 1)

    def test_a_limit_that_was_short_only_after_a_crash_is_no_reason_to_give_up(self):
        stand_in("mpirun", 'echo "mpirun $*"; [ -e crashed ] && exit 5; touch crashed; exit 137')
        self.assertIn("scontrol requeue 7", self.run_script(code=4))
        stand_in("mpirun", "exit 5")
        self.assertNotIn("scontrol", self.run_script(code=5))

    def test_a_requeued_job_waits_for_a_node_that_still_writes(self):
        said = self.run_script(code=2, SLURM_RESTART_COUNT=1)
        self.assertEqual((said.count("mpirun "), said.count("sleep 30")), (10, 10))
        self.assertNotIn("sleep", self.run_script(code=2))

    def test_exit_codes_are_those_of_the_program_whatever_the_user_has_set(self):
        self.assertIn("--mca orte_enable_recovery 0", self.run_script(OMPI_MCA_orte_enable_recovery=1))

    def test_an_array_is_shards_and_some_shards_again_need_to_be_told_of_how_many(self):
        self.assertIn("-o out-3of16.h5 --shard 3/16", self.array(3, 1, 16))
        self.assertIn("-o out-3of16.h5 --shard 3/16", self.array(3, 3, 3, RODSWEEP_SHARDS=16))
        for least, most in ((3, 3), (0, 15), (2, 5)):
            said = self.array(least, least, most, code=2)
            self.assertIn("--array=1-N", said)
            self.assertNotIn("--shard ", said)

    def test_failed_tasks_are_repeated_by_the_first_run_alone(self):
        words = ("--retry-failed", "--task-time-limit", "60")
        self.assertIn("--resume --retry-failed --task-time-limit 60", self.run_script(*words))
        self.assertIn("--resume --task-time-limit 60", self.run_script(*words, SLURM_RESTART_COUNT=1))


if __name__ == "__main__":
    unittest.main()
