"""Programs that run elsewhere: behind ssh, behind Slurm's srun, with the same world as here."""

import contextlib
import getpass
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import time

import sailor
from sailor import BIN, PROGRAMS, SOURCE, Case, children, descendants, until


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def answers(port):
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


class Elsewhere(Case):
    """Sessions whose programs are started by a launcher, to be compared with the same ones started here."""

    STEPS = 40

    def daemon(self, *command, **options):
        """A server that ends with the test, with all that it started."""
        process = subprocess.Popen(list(map(str, command)), cwd=self.folder, stdin=subprocess.DEVNULL, start_new_session=True, **options)

        def end():
            everything = descendants(process.pid)
            process.terminate()
            try:
                process.wait(5)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
            for pid in everything:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)

        self.addCleanup(end)
        return process

    def walk(self, launcher=""):
        """A manager with two programs behind a launcher, some steps taken."""
        behind = f" with {launcher}" if launcher else ""
        manager = self.manager("--seed", "3")
        for line in ("create node probe", f"start {PROGRAMS}/walker{behind}", f"start {BIN}/wave{behind}", "create walker w", "create wave v height 0.4",
                     "create walker u reach 0.5"):
            manager.must(line, timeout=60)
        manager.must(f"step {self.STEPS}", timeout=60)
        manager.must("jump u", timeout=60)
        manager.must(f"step {self.STEPS}", timeout=60)
        return manager, manager.hash()

    def scene(self, launcher=""):
        """The hash at the end of the reach scene without pictures, its four programs behind a launcher."""
        programs = ("arm_ik", "head_ik", "eye_control", "render")
        missing = [name for name in programs if not (BIN / name).exists()]
        if missing:
            self.skipTest(f"{missing[0]} is not built")
        behind = f" with {launcher}" if launcher else ""
        text = re.sub(r"(?m)^start (\w+)$", lambda found: f"start {BIN}/{found[1]}{behind}", (SOURCE / "scripts/scenes/reach.dlg").read_text())
        self.assertEqual(text.count(f"start {BIN}/"), len(programs))
        text = re.sub(r"(?m)^snapshot .*$", "", text)
        self.file("reach.dlg", text + "hash\n")
        done = self.run_manager("reach.dlg", timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.strip()


class Ssh(Elsewhere):
    def setUp(self):
        super().setUp()
        server = shutil.which("sshd", path="/usr/sbin:/usr/local/sbin:" + os.environ["PATH"])
        if not server or not shutil.which("ssh"):
            self.skipTest("no OpenSSH server")
        # the server's own rule: nobody else may write to where its keys lie
        os.chmod(self.folder, 0o700)
        for name in ("host_key", "user_key"):
            subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", self.folder / name], check=True)
        shutil.copy(self.folder / "user_key.pub", self.folder / "authorized_keys")
        port = free_port()
        host_key = " ".join((self.folder / "host_key.pub").read_text().split()[:2])
        self.file("known_hosts", f"[127.0.0.1]:{port} {host_key}\n")
        self.file("server", f"Port {port}\nListenAddress 127.0.0.1\nHostKey {self.folder}/host_key\nAuthorizedKeysFile {self.folder}/authorized_keys\n"
                            "UsePAM no\nPasswordAuthentication no\nKbdInteractiveAuthentication no\nPermitRootLogin prohibit-password\n"
                            f"PidFile none\nStrictModes no\nAllowUsers {getpass.getuser()}\nMaxStartups 100\n")
        self.config = self.file("client", f"Host elsewhere\n HostName 127.0.0.1\n Port {port}\n User {getpass.getuser()}\n"
                                          f" IdentityFile {self.folder}/user_key\n IdentitiesOnly yes\n UserKnownHostsFile {self.folder}/known_hosts\n"
                                          " GlobalKnownHostsFile none\n StrictHostKeyChecking yes\n BatchMode yes\n LogLevel ERROR\n")
        if os.geteuid() == 0 and not pathlib.Path("/run/sshd").exists():
            # where the server locks itself in before it knows who asks
            os.mkdir("/run/sshd", 0o755)
            self.addCleanup(os.rmdir, "/run/sshd")
        self.log = self.folder / "log"
        self.server = self.daemon(server, "-D", "-f", self.folder / "server", "-E", self.log)
        until(lambda: answers(port) or self.server.poll() is not None, "the server answers")
        self.ssh = f"ssh -F {self.config} elsewhere"
        tried = subprocess.run([*self.ssh.split(), "true"], capture_output=True, timeout=30, check=False)
        if tried.returncode:
            self.skipTest(f"the server does not let us in: {tried.stderr.decode()} {self.log.read_text()[-300:]}")

    def test_a_session_gives_the_same_world(self):
        here, expected = self.walk()
        there, got = self.walk(self.ssh)
        self.assertEqual(got, expected)
        programs = [pid for pid in descendants(self.server.pid) if b"walker" in pathlib.Path(f"/proc/{pid}/cmdline").read_bytes()]
        self.assertTrue(programs, "the walker does not run behind the server")
        self.assertEqual(there.finish(), 0)
        for pid in programs:
            until(lambda pid=pid: not sailor.alive(pid), "the program outlived its session")

    def test_the_reach_scene_gives_the_same_world(self):
        self.assertEqual(self.scene(self.ssh), self.scene())

    def test_a_connection_that_breaks_leaves_no_trace(self):
        _, expected = self.walk()
        for at in ("client", "server", "program"):
            with self.subTest(at):
                manager = self.manager("--seed", "3")
                for line in ("create node probe", f"start {PROGRAMS}/walker with {self.ssh}", f"start {BIN}/wave with {self.ssh}", "create walker w",
                             "create wave v height 0.4", "create walker u reach 0.5", "step 10"):
                    manager.must(line, timeout=60)
                manager.send(f"@run step {self.STEPS - 10}\n".encode())
                time.sleep(0.01)
                # the end nearest to us, the one in between, the farthest
                victims = {"client": children(manager.pid)[:1], "server": children(self.server.pid)[:1],
                           "program": [pid for pid in descendants(self.server.pid)
                                       if b"walker" in pathlib.Path(f"/proc/{pid}/cmdline").read_bytes()][-1:]}[at]
                self.assertTrue(victims)
                for pid in victims:
                    os.kill(pid, signal.SIGKILL)
                self.assertTrue(manager.answer("run", 60).ok)
                manager.must("jump u", timeout=60)
                manager.must(f"step {self.STEPS}", timeout=60)
                self.assertEqual(manager.hash(), expected)
                manager.event("restarted")
                self.assertEqual(manager.finish(), 0)
                until(lambda: not descendants(self.server.pid), "programs outlived their session")

    def test_a_host_that_cannot_be_reached_is_told(self):
        manager = self.manager()
        manager.must("create node probe")
        before = manager.hash()
        for launcher in (f"ssh -F {self.config} -p {free_port()} elsewhere", f"ssh -F {self.config} -o BatchMode=yes nobody@elsewhere"):
            reply = manager.ask(f"start {BIN}/wave with {launcher}", timeout=60)
            self.assertEqual(reply.kind, "gone", repr(reply))
            self.assertRegex(reply.sentence, "255")
            self.assert_recovered(manager, before)
        reply = manager.ask(f"start /no/such/program with {self.ssh}", timeout=60)
        self.assertEqual(reply.kind, "gone", repr(reply))
        self.assertIn("127", reply.sentence)
        self.assert_recovered(manager, before)


class Cluster(Elsewhere):
    """Needs munge and Slurm's daemons, and root to run them; a cluster of one machine."""

    def setUp(self):
        super().setUp()
        sbin = "/usr/sbin:/usr/local/sbin:" + os.environ["PATH"]
        tools = {name: shutil.which(name, path=sbin) for name in ("munged", "slurmctld", "slurmd", "srun", "sinfo", "scontrol")}
        if not all(tools.values()):
            self.skipTest("Slurm is not installed")
        if os.geteuid() != 0:
            self.skipTest("its daemons need root")
        os.chmod(self.folder, 0o755)
        for name in ("munge", "state", "spool"):
            (self.folder / name).mkdir(mode=0o755)
        key = self.file("munge/key", os.urandom(128))
        os.chmod(key, 0o400)
        munge_socket = self.folder / "munge/socket"
        self.daemon(tools["munged"], "--foreground", "--force", f"--socket={munge_socket}", f"--key-file={key}", f"--pid-file={self.folder}/munge/pid",
                    f"--log-file={self.folder}/munge/log", f"--seed-file={self.folder}/munge/seed", stderr=subprocess.DEVNULL)
        host = socket.gethostname().split(".")[0]
        control, node = free_port(), free_port()
        conf = self.file("slurm.conf", f"""ClusterName=one
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={control}
SlurmdPort={node}
AuthType=auth/munge
AuthInfo=socket={munge_socket}
CredType=cred/munge
SlurmUser=root
StateSaveLocation={self.folder}/state
SlurmdSpoolDir={self.folder}/spool
SlurmctldPidFile={self.folder}/slurmctld.pid
SlurmdPidFile={self.folder}/slurmd.pid
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=batch_sched_delay=0,sched_min_interval=0
MpiDefault=none
ReturnToService=2
KillWait=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={os.cpu_count()} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP OverSubscribe=FORCE:16
""")
        self.environ = sailor.environment(self.folder, SLURM_CONF=str(conf))
        self.tools = tools
        until(munge_socket.exists, "munge listens", 20)
        for name in ("slurmctld", "slurmd"):
            with open(self.folder / f"{name}.log", "wb") as log:
                self.daemon(tools[name], "-D", env=self.environ, stdout=log, stderr=log)
        until(lambda: b"idle" in self.tool("sinfo", "-h", "-o", "%t").stdout, "the node is idle", 40)

    def tool(self, name, *words):
        return subprocess.run([self.tools[name], *words], env=self.environ, capture_output=True, timeout=60, check=False)

    def manager(self, *arguments, **options):
        return super().manager(*arguments, environ=self.environ, **options)

    def run_manager(self, *arguments, **options):
        return super().run_manager(*arguments, environ=self.environ, **options)


class Slurm(Cluster):
    def test_a_sweep_as_an_array_of_jobs(self):
        self.file("scene.dlg", "type thing\nfield thing.a real m = 0 in 0 1\ncreate thing t\n")
        tables = []
        for extra in ((), ("--slurm",)):
            out = self.folder / f"t{len(tables)}.csv"
            environ = {**self.environ, "DIALOG_MANAGER": str(BIN / "dialog_manager")}
            done = subprocess.run([SOURCE / "scripts/sweep", "--scene", "scene.dlg", "--vary", "t.a=0:1:6", "--run", "0.1", "--measure", "t.a",
                                   "--out", out, *extra], cwd=self.folder, env=environ, capture_output=True, timeout=120, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            tables.append(out.read_text())
        self.assertEqual(tables[1], tables[0])


class SlowSlurm(Cluster):
    # srun hands on what programs say in small pieces, with pauses
    def test_a_session_and_a_scene_give_the_same_world(self):
        _, expected = self.walk()
        there, got = self.walk("srun --quiet -n1 -s")
        self.assertEqual(got, expected)
        self.assertEqual(there.finish(), 0)
        self.assertEqual(self.scene("srun --quiet -n1 -s"), self.scene())


if __name__ == "__main__":
    sailor.main()
