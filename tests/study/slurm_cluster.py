"""A Slurm cluster with one node on the loopback device, in separate namespaces.

When the process that called enter() ends, nothing of the cluster remains. Its processes are in a
PID namespace, its files in a private tmpfs, and its ports in a network without a way out.
"""
import contextlib
import fcntl
import os
import pathlib
import shutil
import signal
import socket
import struct
import subprocess
import sys
import time

FOLDER = pathlib.Path("/run/slurm")
INSIDE = "BREAKWATER_INSIDE_SLURM"
NODE = socket.gethostname()
CPUS = 2
HANGS_S = 900  # nothing takes as long, even on a machine with much other work
ADDRESS = "10.7.7.7"
SIOCSIFFLAGS, SIOCSIFADDR, IFF_UP = 0x8914, 0x8916, 1  # <linux/sockios.h>, <net/if.h>

CONFIG = """\
ClusterName=breakwater
SlurmctldHost={node}({address})
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=cred_expire=5
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
MailProg=/bin/true
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=1,batch_sched_delay=1,bf_interval=1
SlurmdParameters=config_overrides
SlurmdTimeout=300
KillWait=2
MinJobAge=2
ReturnToService=2
MaxArraySize={max_array_size}
NodeName={node} NodeAddr={address} CPUs={cpus} State=UNKNOWN
PartitionName=main Nodes={node} Default=YES MaxTime=INFINITE State=UP
PartitionName=other Nodes={node} MaxTime=INFINITE State=UP
"""


def missing():
    """The reason why a cluster is impossible here; None if it is possible."""
    for program in ("munged", "slurmctld", "slurmd", "sbatch", "unshare"):
        if not shutil.which(program, path=os.environ["PATH"] + ":/usr/sbin"):
            return f"{program} is not installed (Debian: slurm-wlm, munge)"
    if os.geteuid() != 0:
        return "only root can start a Slurm of its own"
    probe = subprocess.run(NAMESPACES + ["mount", "-t", "tmpfs", "none", "/run"],
                           capture_output=True, text=True)
    if probe.returncode != 0:
        return f"no namespaces can be made here: {probe.stderr.strip()}"
    return None


NAMESPACES = ["unshare", "--pid", "--fork", "--kill-child", "--mount", "--mount-proc", "--net", "--"]


def enter():
    """Run this script again in new namespaces."""
    if os.environ.get(INSIDE):
        return
    os.environ[INSIDE] = "1"
    os.environ["PATH"] += ":/usr/sbin:/sbin"
    # The first process of a PID namespace must wait for orphans, as bash does.
    inside = 'mount -t tmpfs none /run && "$@"; exit $?'
    os.execvp(NAMESPACES[0],
              NAMESPACES + ["bash", "-c", inside, "bash", sys.executable, *sys.argv])


def wait_for(what, condition):
    end = time.monotonic() + HANGS_S
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > end:
            raise TimeoutError(f"not within {HANGS_S} s: {what}")
        time.sleep(0.1)


class Cluster:
    """Starts the cluster's processes and stops them at the end of `with`."""

    def __init__(self, max_array_size=1001):
        self.max_array_size = max_array_size
        self.daemons = {}

    def __enter__(self):
        raise_loopback()
        for folder in (FOLDER / "state", FOLDER / "spool", pathlib.Path("/run/munge")):
            folder.mkdir(parents=True, exist_ok=True)
        config = FOLDER / "slurm.conf"
        config.write_text(CONFIG.format(node=NODE, address=ADDRESS, folder=FOLDER, cpus=CPUS,
                                        max_array_size=self.max_array_size))
        os.environ["SLURM_CONF"] = str(config)
        key = FOLDER / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        self.start("munged", "--foreground", "--force", f"--key-file={key}",
                   f"--log-file={FOLDER}/munged.log", f"--seed-file={FOLDER}/munged.seed")
        wait_for("munged", lambda: self.says("munge", "-n"))
        self.start("slurmctld", "-D", "-i")
        self.start_node()
        return self

    def __exit__(self, kind, *_):
        if kind:
            for log in sorted(FOLDER.glob("*.log")):
                print(f"--- {log}", log.read_text()[-6000:], sep="\n", file=sys.stderr)
        for name in ("slurmd", "slurmctld", "munged"):
            daemon = self.daemons.pop(name, None)
            if daemon:
                daemon.kill()
                daemon.wait()
        kill_tasks()
        shutil.rmtree(FOLDER)

    def start(self, name, *options):
        output = open(FOLDER / f"{name}.out", "ab")
        self.daemons[name] = subprocess.Popen([name, *options], stdout=output, stderr=output,
                                              stdin=subprocess.DEVNULL, start_new_session=True)

    def start_node(self):
        self.start("slurmd", "-D")
        wait_for("the node is up",
                 lambda: self.node_state() in ("idle", "mixed", "allocated", "completing"))

    def kill_node(self):
        self.daemons["slurmd"].kill()
        self.daemons["slurmd"].wait()

    def give_up_node(self):
        """Do what the controller does after SlurmdTimeout. A short time would give up a node that is only slow."""
        self.says("scontrol", "update", f"NodeName={NODE}", "State=DOWN", "Reason=silent")

    @staticmethod
    def says(*words):
        return subprocess.run(words, capture_output=True, text=True).stdout

    def node_state(self):
        return self.says("sinfo", "--noheader", "--partition=main", "--format=%T").strip()

    def states(self, job):
        """The states of a job's tasks in the queue."""
        return self.says("squeue", "--noheader", "--array", "--format=%T",
                         f"--jobs={job},999999").split()


def raise_loopback():
    """Raise the loopback with a second address: with 127.0.0.1 alone glibc finds no address for
    Slurm."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        for name, request, value in (
                (b"lo", SIOCSIFFLAGS, struct.pack("h14x", IFF_UP)),
                (b"lo:1", SIOCSIFADDR,
                 struct.pack("hH4s8x", socket.AF_INET, 0, socket.inet_aton(ADDRESS)))):
            fcntl.ioctl(any_socket, request, struct.pack("16s16s", name, value))


def processes(wanted):
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            words = (entry / "cmdline").read_bytes().split(b"\0")
        except OSError:
            continue
        if wanted(words):
            found.append(int(entry.name))
    return found


def tasks():
    """Breakwater's task processes."""
    return processes(lambda words: b"--points" in words)


def stepds():
    return processes(lambda words: words[0].startswith(b"slurmstepd"))


def kill_tasks():
    """Kill the tasks and Slurm's processes that watch them."""
    for process in stepds() + tasks():
        with contextlib.suppress(ProcessLookupError):  # it has ended meanwhile
            os.kill(process, signal.SIGKILL)
