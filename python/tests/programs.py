"""The programs of the suite, to compare with, in a folder of their own."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
GLASS = ROOT / "scenes/wine-glass/wine-glass.sdl"


class InFolder(unittest.TestCase):
    """A test in an empty folder."""

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        self.folder = Path(folder.name)
        os.chdir(self.folder)


@unittest.skipUnless(shutil.which("portray"), "the programs of the suite are not on the path")
class BesidePrograms(InFolder):
    """A test that compares with programs."""

    def run_program(self, *words: object) -> str:
        """Standard output of a command that has to succeed."""
        command = [str(word) for word in words]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, f"{command}: {done.stderr}")
        return done.stdout
