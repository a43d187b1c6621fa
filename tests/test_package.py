# SPDX-License-Identifier: GPL-2.0-or-later
"""The Debian package works from any folder; in a Debian for tests it comes and goes."""

import json
import os
import shutil
import subprocess
import tempfile
import unittest
from functools import lru_cache
from pathlib import Path

import yade.config
from membrane.results.history import read_history
from support import ROOT, scratch

DISPOSABLE = "MEMBRANE_DISPOSABLE"  # set by scripts/in_debian.sh: packages may come and go here
SHORT = ["--no-pictures", "--no-report", "--refine", "1", "--spin-up-tolerance", "0.1"]
# Nobody's own, what other programs note down, and what is only in memory.
ELSEWHERE = "proc sys dev run tmp root sails var/cache var/log var/lib/dpkg var/lib/apt".split()
WHERE = "import membrane\nprint('from', membrane.__file__)"


def said_by(*command, **options):
    """Standard output of a command that succeeds."""
    done = subprocess.run(command, capture_output=True, text=True, **options)
    if done.returncode:
        raise AssertionError(f"{command}: {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout


@lru_cache(maxsize=None)
def package():
    """The package, made anew."""
    said_by(ROOT / "scripts" / "run.sh", "package")
    (made,) = (ROOT / "build" / "package").glob("*.deb")
    return made


def field(name):
    """Of its control file."""
    return said_by("dpkg-deb", "--field", package(), name).strip()


class TestPackage(unittest.TestCase):
    def test_it_is_for_this_yade_alone(self):
        here = yade.config.version.strip()
        installed = said_by("dpkg-query", "-W", "-f=${Version}", "yade")
        self.assertIn(f"yade (= {installed})", field("Depends").split(", "))
        self.assertTrue(field("Version").endswith(f"+yade{here}"), field("Version"))

    def test_its_command_works_without_the_sources(self):
        root, folder = scratch() / "package", scratch() / "anywhere"
        folder.mkdir()
        said_by("dpkg-deb", "--extract", package(), root)
        names = [path.name for path in root.rglob("*")]
        for name in ("guide.md", "example.py", "Snakefile", "miura.fold", "copyright"):
            self.assertIn(name, names)
        self.assertNotIn("__pycache__", names)
        plain = {name: os.environ[name] for name in ("PATH", "HOME") if name in os.environ}
        command = root / "usr" / "bin" / "yade-membrane"
        said_by(command, "deploy", *SHORT, "--duration", "0.01", cwd=folder, env=plain)
        summary = json.loads((folder / "out" / "summary.json").read_text(encoding="utf-8"))
        self.assertEqual(summary["parameters"]["duration"], 0.01)
        for word in ("build", "nonsense"):
            done = subprocess.run([command, word], capture_output=True, text=True)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, f"^yade-membrane: unknown command '{word}', or one .*\n$")


@unittest.skipUnless(os.environ.get(DISPOSABLE), "installs packages: in a Debian made for it only")
class TestInstalled(unittest.TestCase):
    def files(self):
        """All there are, but for those elsewhere."""
        pruned = " -o ".join(f"-path /{folder}" for folder in ELSEWHERE)
        return set(said_by(*f"find / ( {pruned} ) -prune -o -print".split()).splitlines())

    def test_comes_works_for_everyone_and_goes(self):
        before = self.files()
        apt = ["apt-get", "-qy", "--no-install-recommends"]
        said_by(*apt, "install", package())
        self.addCleanup(subprocess.run, [*apt, "purge", "yade-membrane"], capture_output=True)
        folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, folder)
        folder.chmod(0o777)
        nobody = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups", "env", "-i"]
        nobody += ["PATH=/usr/bin:/bin", "LC_ALL=C.UTF-8", f"HOME={folder}"]
        ended = []
        for path in ("law2", "fused"):
            deploy = ["yade-membrane", "deploy", *SHORT, "--duration", "0.05", "--path", path]
            said_by(*nobody, *deploy, "--out", path, cwd=folder)
            ended.append(read_history(folder / path / "history.csv"))
        law2, fused = (history["deployment_rate"] for history in ended)
        self.assertEqual(len(law2), 51)
        self.assertGreater(law2[-1] - law2[0], 0.1)
        self.assertLess(abs(law2 - fused).max(), 0.01)
        script = folder / "where.py"
        script.write_text(WHERE, encoding="utf-8")
        for who in (nobody, ["env", "PYTHONPATH="]):
            said = said_by(*who, "yade", "-n", "-x", script, cwd=folder)
            self.assertIn("from /usr/lib/python3", said)
        said_by(*apt, "purge", "yade-membrane")
        self.assertEqual(self.files() - before, set())
        self.assertIsNone(shutil.which("yade-membrane"))
        self.assertFalse(list(Path("/usr/lib").glob("python3*/dist-packages/membrane")))
