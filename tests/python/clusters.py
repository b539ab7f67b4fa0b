"""Clusters of this machine alone, for the tests that need one: a Slurm of one node (munged, slurmctld and slurmd with files, keys
and ports of their own, as root), a scheduler of Dask and its workers. Their processes end with them."""

import contextlib
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import time

#: package of Debian for each program
PROGRAMS = {"munged": "munge", "slurmctld": "slurm-wlm", "slurmd": "slurm-wlm", "sbatch": "slurm-wlm"}


def found(program):
    return shutil.which(program, path=os.environ["PATH"] + ":/usr/sbin:/sbin")


def missing():
    """Why there can be no Slurm here, or nothing."""
    packages = sorted({package for program, package in PROGRAMS.items() if found(program) is None})
    if packages:
        return f"{' and '.join(packages)} not installed (tools/install-dependencies --with-clusters)"
    return None if os.geteuid() == 0 else "Slurm's daemons need root"


def free_ports(count):
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        return [one.getsockname()[1] for one in sockets]


class Servers:
    """Processes that write what they say into a directory, and end in the order opposite to that in which they began."""

    def __init__(self, directory):
        self.directory = pathlib.Path(directory)
        self.processes = []
        self.environment = dict(os.environ)

    def __enter__(self):
        try:
            self._start()
        except BaseException:
            self.__exit__()
            raise
        return self

    def _run(self, program, *arguments):
        with open(self.directory / f"{len(self.processes)}.out", "wb") as out:
            self.processes.append(subprocess.Popen([program, *map(str, arguments)], env=self.environment,
                                                   stdin=subprocess.DEVNULL, stdout=out, stderr=out, start_new_session=True))

    def _wait(self, ready, what, seconds=300):
        end = time.monotonic() + seconds
        while not ready():
            logs = "".join(f"\n-- {log}\n{log.read_text()[-2000:]}" for log in self.directory.rglob("*")
                           if log.suffix in (".log", ".out") or log.name == "log")
            assert all(one.poll() is None for one in self.processes), f"{what} ended{logs}"
            assert time.monotonic() < end, f"{what} is not ready after {seconds} s{logs}"
            time.sleep(0.1)

    def __exit__(self, *_):
        for process in reversed(self.processes):
            process.send_signal(signal.SIGTERM)
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


class Slurm(Servers):
    def __init__(self, directory):
        super().__init__(directory)
        self.environment["SLURM_CONF"] = str(self.directory / "slurm.conf")

    def _start(self):
        d = self.directory
        d.chmod(0o755)
        for name in ("munge", "state", "spool"):
            (d / name).mkdir()
        (d / "munge" / "key").write_bytes(os.urandom(1024))
        (d / "munge" / "key").chmod(0o400)
        host = socket.gethostname().split(".")[0]
        controller, node = free_ports(2)
        (d / "slurm.conf").write_text(f"""ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
SlurmdPort={node}
AuthType=auth/munge
AuthInfo=socket={d}/munge/socket
CredType=cred/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation={d}/state
SlurmdSpoolDir={d}/spool
SlurmctldPidFile={d}/slurmctld.pid
SlurmdPidFile={d}/slurmd.pid
SlurmctldLogFile={d}/slurmctld.log
SlurmdLogFile={d}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
ReturnToService=2
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=1,batch_sched_delay=0,requeue_delay=0
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MinJobAge=300
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP OverSubscribe=NO
""")
        self._run(found("munged"), "--foreground", "--force", f"--key-file={d}/munge/key", f"--socket={d}/munge/socket",
                  f"--pid-file={d}/munge/pid", f"--log-file={d}/munge/log", f"--seed-file={d}/munge/seed")
        self._wait(lambda: (d / "munge" / "socket").exists(), "munged")
        self._run(found("slurmctld"), "-D", "-f", d / "slurm.conf")
        self._run(found("slurmd"), "-D", "-f", d / "slurm.conf", "-N", host)
        self._wait(lambda: self.ask("sinfo", "-h", "-o", "%t") == "idle", "slurmd")

    def ask(self, *command):
        return subprocess.run([str(part) for part in command], env=self.environment, text=True, capture_output=True,
                              check=False).stdout.strip()


class Dask(Servers):
    """`workers` of one thread each, which are started again when they die."""

    def __init__(self, directory, workers=2, environment=None):
        super().__init__(directory)
        self.workers = workers
        self.file = self.directory / "scheduler.json"
        self.environment.update(DASK_DISTRIBUTED__ADMIN__TICK__LIMIT="1h")  # busy machines are no reason to speak
        self.of_workers = environment

    def _start(self):
        module = [sys.executable, "-m"]
        self._run(*module, "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard",
                  "--scheduler-file", self.file)
        self._wait(self.file.exists, "the scheduler")
        if self.of_workers is not None:
            self.environment = self.of_workers
        for number in range(self.workers):
            self._run(*module, "distributed.cli.dask_worker", "--scheduler-file", self.file, "--nthreads", "1", "--no-dashboard",
                      "--memory-limit", "0", "--local-directory", self.directory / f"worker{number}")

    def client(self):
        import distributed

        one = distributed.Client(scheduler_file=str(self.file))
        if self.workers:
            one.wait_for_workers(self.workers)
        return one
