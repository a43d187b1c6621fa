# SPDX-License-Identifier: GPL-2.0-or-later
"""A Slurm of one node on 127.0.0.1, for as long as a test needs it; no systemd, no cgroups."""

import os
import pwd
import shutil
import signal
import socket
import subprocess
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path

NODE = "localhost"
PATIENCE = 60  # [s] for a daemon to answer or to end; one that hangs must not hang the test

CONFIGURATION = """\
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket={folder}/munge.socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SchedulerType=sched/builtin
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
SlurmdParameters=config_overrides
ReturnToService=2
KillWait=5
NodeName={node} NodeAddr=127.0.0.1 CPUs={cpus} RealMemory={memory}
PartitionName=all Nodes={node} Default=YES MaxTime=INFINITE State=UP
"""


class Slurm:
    """munged, slurmctld and slurmd of one's own, with key, sockets and spool in a new folder.

    A context: what is left of jobs and daemons ends with it, also if the test fails.

    Parameters
    ----------
    cpus : int
        Jobs of one processor that run at once; need not be those of the machine.
    memory : int
        For all jobs together [MB].

    Attributes
    ----------
    folder : Path
        Of configuration, logs and spool; gone at the end.
    environment : dict
        Environment variables with which Slurm's commands reach this one.
    """

    def __init__(self, cpus=2, memory=4000):
        self.cpus, self.memory = cpus, memory
        self.folder, self.environment = None, None

    def __enter__(self):
        with ExitStack() as stack:
            self.folder = Path(tempfile.mkdtemp(prefix="slurm-", dir="/tmp"))  # sockets: short path
            stack.callback(shutil.rmtree, self.folder, ignore_errors=True)
            stack.callback(self._kill_leftovers)
            self._configure()
            munged = self._daemon(stack, "munged", *self._munged_options())
            self._wait(munged, lambda: (self.folder / "munge.socket").exists())
            controller = self._daemon(stack, "slurmctld", "-D", "-i")
            node = self._daemon(stack, "slurmd", "-D", "-N", NODE)
            self._wait(controller, lambda: self.states() == ["idle"], node)
            stack.callback(self.cancel_all)
            self._stack = stack.pop_all()
        return self

    def __exit__(self, *error):
        self._stack.close()

    def _configure(self):
        with socket.socket() as one, socket.socket() as other:
            one.bind(("127.0.0.1", 0))
            other.bind(("127.0.0.1", 0))
            ports = one.getsockname()[1], other.getsockname()[1]
        configuration = self.folder / "slurm.conf"
        configuration.write_text(
            CONFIGURATION.format(
                host=socket.gethostname().split(".")[0],
                controller_port=ports[0],
                node_port=ports[1],
                user=pwd.getpwuid(os.getuid()).pw_name,
                folder=self.folder,
                node=NODE,
                cpus=self.cpus,
                memory=self.memory,
            )
        )
        for name in ("state", "spool"):
            (self.folder / name).mkdir()
        key = self.folder / "munge.key"
        key.touch(mode=0o600)
        key.write_bytes(os.urandom(128))
        self.environment = {**os.environ, "SLURM_CONF": str(configuration)}

    def _munged_options(self):
        names = {"key": "key", "socket": "socket", "pid": "pid", "log": "log", "seed": "seed"}
        files = [
            f"--{option}{'' if option == 'socket' else '-file'}={self.folder}/munge.{name}"
            for option, name in names.items()
        ]
        return ["--foreground", "--force", *files]  # forced: the folder is below /tmp

    def _daemon(self, stack, name, *options):
        """Start a daemon in the foreground; `stack` ends it."""
        log = stack.enter_context(open(self.folder / f"{name}.log", "w"))
        path = shutil.which(name, path=f"{os.environ['PATH']}:/usr/sbin:/sbin")
        if not path:
            raise RuntimeError(f"{name} is not installed")
        process = subprocess.Popen(
            [path, *options],
            env=self.environment,
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
            start_new_session=True,  # Ctrl-C ends the test, which ends the daemons in order
        )
        stack.callback(_end, process)
        return process

    def _wait(self, process, ready, *others):
        """Wait until `ready()`; RuntimeError with the logs if a daemon ends or time is up."""
        end = time.monotonic() + PATIENCE
        while not ready():
            if time.monotonic() > end or any(p.poll() is not None for p in (process, *others)):
                logs = "\n".join(p.read_text() for p in sorted(self.folder.glob("*.log")))
                raise RuntimeError(f"Slurm did not start:\n{logs}")
            time.sleep(0.1)

    def run(self, *command, check=True):
        """Standard output of one of Slurm's commands; RuntimeError with what it said."""
        done = subprocess.run(command, env=self.environment, capture_output=True, text=True)
        if check and done.returncode:
            raise RuntimeError(f"{' '.join(command)}: {done.stderr}")
        return done.stdout

    def states(self):
        """States of the nodes."""
        return self.run("sinfo", "--noheader", "--format=%T", check=False).split()

    def jobs(self):
        """(id, comment, state) of the jobs that wait or run."""
        lines = self.run("squeue", "--noheader", "--format=%i %k %T").splitlines()
        return [tuple(line.split()) for line in lines]

    def cancel_all(self):
        """End all jobs and wait until they have ended."""
        end = time.monotonic() + PATIENCE
        while (jobs := self.jobs()) and time.monotonic() < end:
            self.run("scancel", *(job for job, _, _ in jobs), check=False)
            time.sleep(0.2)

    def processes(self):
        """Ids of the living processes that were started for this Slurm or by it."""
        mark = f"SLURM_CONF={self.folder}/".encode()
        found = []
        for path in Path("/proc").glob("[0-9]*/environ"):
            try:
                if mark in path.read_bytes():
                    found.append(int(path.parent.name))
            except OSError:  # it has ended, or is another's
                pass
        return found

    def _kill_leftovers(self):
        for process in self.processes():
            try:
                os.kill(process, signal.SIGKILL)
            except ProcessLookupError:
                pass


def _end(process):
    """End a daemon, by force if it does not listen."""
    process.terminate()
    try:
        process.wait(PATIENCE)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
