#!/usr/bin/python3
"""Hosts on one machine: kernel namespaces on a bridge. Each has its own processes, network and name; they share all
files. A host can be cut off (all packets are dropped, none is rejected) or die with all its processes.

Run within alone.sh. By hand, alone.sh hosts.py COMMAND... runs a command with three hosts up. The environment has
the settings of mpirun; $HOSTS/hostfile has the names of the hosts.
"""

import os
import signal
import subprocess
import sys

AGENT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "agent.sh")
NETWORK, HEAD = "10.77.0.0/24", "10.77.0.254"


def run(*words):
    subprocess.run(words, check=True, capture_output=True, text=True)


def children_of(pid):
    with open(f"/proc/{pid}/task/{pid}/children", encoding="ascii") as file:
        return [int(child) for child in file.read().split()]


class Host:
    def __init__(self, number, folder):
        self.name, self.address = f"h{number}", f"10.77.0.{number}"
        self.link, self.folder = f"to-h{number}", folder
        self.up()

    def up(self):
        # The first process of the namespace reaps orphans, like init.
        self.process = subprocess.Popen(
            ["unshare", "--net", "--pid", "--uts", "--mount", "--fork", "--kill-child", "--mount-proc",
             "bash", "-c", 'hostname "$0"; ip link set lo up; echo up; sleep infinity & wait', self.name],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        assert self.process.stdout.readline() == "up\n", f"{self.name} does not come up"
        self.first = children_of(self.process.pid)[0]
        run("ip", "link", "add", self.link, "type", "veth", "peer", "name", "eth0", "netns", str(self.first))
        run("ip", "link", "set", self.link, "master", "bridge", "up")
        self.run("ip", "addr", "add", self.address + "/24", "dev", "eth0")
        self.run("ip", "link", "set", "eth0", "up")
        with open(os.path.join(self.folder, self.name), "w", encoding="ascii") as file:
            file.write(str(self.first))

    def inside(self, *words):
        return ["nsenter", "--target", str(self.first), "--net", "--pid", "--uts", "--mount", "--", *words]

    def run(self, *words):
        run(*self.inside(*words))

    def cut_off(self):
        run("ip", "link", "set", self.link, "down")

    def die(self):
        """Kills the host with all its processes; its network goes with it."""
        if self.process.poll() is None:
            os.kill(self.first, signal.SIGKILL)
            self.process.wait()
            self.process.stdout.close()
            subprocess.run(["ip", "link", "del", self.link], capture_output=True, check=False)  # unless the kernel did


class Hosts(list):
    def __init__(self, folder, count=3, slots=2):
        self.folder = os.path.abspath(folder)
        os.makedirs(self.folder, exist_ok=True)
        run("ip", "link", "add", "bridge", "type", "bridge")
        run("ip", "addr", "add", HEAD + "/24", "dev", "bridge")
        run("ip", "link", "set", "bridge", "up")
        names = [f"127.0.0.1 localhost\n{HEAD} {os.uname().nodename}\n"]
        names += [f"10.77.0.{number} h{number}\n" for number in range(1, count + 1)]
        with open(os.path.join(self.folder, "names"), "w", encoding="ascii") as file:
            file.writelines(names)
        run("mount", "--bind", file.name, "/etc/hosts")
        super().__init__(Host(number, self.folder) for number in range(1, count + 1))
        self.file = os.path.join(self.folder, "hostfile")
        with open(self.file, "w", encoding="ascii") as file:
            file.writelines(f"{host.name} slots={slots}\n" for host in self)
        os.environ.update(self.environment())

    def environment(self):
        """The environment for mpirun."""
        settings = {"plm": "rsh", "plm_rsh_agent": AGENT, "oob_tcp_if_include": NETWORK, "btl_tcp_if_include": NETWORK,
                    "btl": "tcp,self,vader"}
        return {"HOSTS": self.folder, **{"OMPI_MCA_" + name: value for name, value in settings.items()}}


if __name__ == "__main__":
    Hosts(os.environ.get("HOSTS", "/run/hosts"))
    sys.exit(subprocess.run(sys.argv[1:], check=False).returncode)
