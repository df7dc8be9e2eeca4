#!/usr/bin/python3
"""A real Slurm with the hosts of hosts.py as nodes: slurmctld outside, a slurmd on each host, munge for all.

Run within alone.sh, which ends all of it. By hand, alone.sh slurm.py COMMAND... runs a command with Slurm up.
"""

import os
import shutil
import subprocess
import sys
import time

from hosts import HEAD, Hosts, run

LOST_AFTER_S = 8  # an unresponsive node is down after this time

CONFIGURATION = """\
ClusterName=test
SlurmctldHost={head}({address})
SlurmUser=root
AuthType=auth/munge
AuthInfo=cred_expire=5
CryptoType=crypto/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,batch_sched_delay=0
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
JobCompType=jobcomp/none
StateSaveLocation={folder}/state
SlurmctldPidFile={folder}/slurmctld.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdSpoolDir={folder}/%n
SlurmdPidFile={folder}/%n.pid
SlurmdLogFile={folder}/%n.log
SlurmdParameters=config_overrides
SlurmdTimeout={lost_after_s}
ReturnToService=2
KillWait=5
MinJobAge=3600
"""


def wait_until(what, seconds, ready):
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        found = ready()
        if found:
            return found
        time.sleep(0.1)
    raise AssertionError(f"{what}: not within {seconds} s")


class Slurm:
    def __init__(self, folder, cores=4, hosts=2):
        self.folder = os.path.abspath(folder)
        os.makedirs(os.path.join(self.folder, "state"))
        self.hosts = Hosts(os.path.join(self.folder, "hosts"), hosts)
        for name in ("OMPI_MCA_plm", "OMPI_MCA_plm_rsh_agent"):  # mpirun gets the hosts from Slurm
            os.environ.pop(name)
        self.start_munge()
        os.environ["SLURM_CONF"] = os.path.join(self.folder, "slurm.conf")
        with open(os.environ["SLURM_CONF"], "w", encoding="ascii") as file:
            file.write(CONFIGURATION.format(head=os.uname().nodename, address=HEAD, folder=self.folder,
                                            lost_after_s=LOST_AFTER_S))
            for host in self.hosts:
                file.write(f"NodeName={host.name} NodeAddr={host.address} CPUs={cores} Sockets=1 CoresPerSocket={cores} "
                           "ThreadsPerCore=1 State=UNKNOWN\n")
            file.write("PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP OverSubscribe=FORCE:4\n")
        run("slurmctld")
        for host in self.hosts:
            self.start_node(host)
        wait_until("all nodes idle", 30, lambda: self.states() == {host.name: "idle" for host in self.hosts})

    @staticmethod
    def start_munge():
        """With its own key, in folders that hide the machine's."""
        for folder in ("/etc/munge", "/var/log/munge", "/var/lib/munge"):
            run("mount", "-t", "tmpfs", "none", folder)
        for folder in ("/etc/munge", "/var/log/munge", "/var/lib/munge", "/run/munge"):
            os.makedirs(folder, exist_ok=True)
            shutil.chown(folder, "munge", "munge")
            os.chmod(folder, 0o755 if folder == "/run/munge" else 0o700)
        run("runuser", "-u", "munge", "--", "/usr/sbin/mungekey", "--create")
        run("runuser", "-u", "munge", "--", "/usr/sbin/munged")
        wait_until("munged", 10, lambda: subprocess.run(["munge", "-n"], capture_output=True, check=False).returncode == 0)

    def start_node(self, host):
        os.makedirs(os.path.join(self.folder, host.name), exist_ok=True)
        host.run("slurmd")

    @staticmethod
    def submit(*words):
        """Submits a job; returns its number."""
        said = subprocess.run(["sbatch", "--parsable", *words], capture_output=True, text=True, check=True)
        return said.stdout.strip()

    @staticmethod
    def job(number):
        """Slurm's data of a job: {key: text}."""
        said = subprocess.run(["scontrol", "--oneliner", "show", "job", number], capture_output=True, text=True,
                              check=True).stdout
        return dict(word.split("=", 1) for word in said.split() if "=" in word)

    def states(self):
        nodes = subprocess.run(["sinfo", "-h", "-N", "-o", "%N %T"], capture_output=True, text=True, check=False).stdout
        return dict(line.split() for line in nodes.splitlines())


if __name__ == "__main__":
    Slurm(os.environ.get("SLURM", "/run/slurm"))
    sys.exit(subprocess.run(sys.argv[1:], check=False).returncode)
