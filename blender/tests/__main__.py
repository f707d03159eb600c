# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension's tests, by Blender's Python module: `cargo xtask test --only blender` runs them.

The .zip is installed as a user would, into a folder of its own. The environment names it (MIDAIR_EXTENSION), the program
(MIDAIR_PROGRAM), a Python with scikit-image (MIDAIR_PEERS_PYTHON) and, where pictures are wanted, a folder for them (MIDAIR_PICTURES).
"""

import sys
import tempfile
import time
import unittest
from pathlib import Path

HERE = Path(__file__).parent


class Lines(unittest.TextTestResult):
    """A line for each test, which the caller counts."""

    def addSuccess(self, test):
        super().addSuccess(test)
        self._told("ok", test)

    def addFailure(self, test, error):
        super().addFailure(test, error)
        self._told("FAILED", test)

    def addError(self, test, error):
        super().addError(test, error)
        self._told("FAILED", test)

    def addSkip(self, test, reason):
        super().addSkip(test, reason)
        print(f"skipped: {test.id()}: {reason}", flush=True)

    def startTest(self, test):
        super().startTest(test)
        self.began = time.process_time()

    def _told(self, outcome, test):
        print(f"{outcome}: {test.id()} ({time.process_time() - self.began:.1f} s of CPU)", flush=True)


def main():
    sys.path.insert(0, str(HERE))
    with tempfile.TemporaryDirectory(prefix="midair-blender-") as folder:
        import bench

        bench.install(folder)
        wanted = sys.argv[1] if len(sys.argv) > 1 else "test_*.py"
        loader = unittest.TestLoader()
        loader.testNamePatterns = [f"*{name}*" for name in sys.argv[2:]] or None
        tests = loader.discover(str(HERE), pattern=wanted)
        outcome = unittest.TextTestRunner(resultclass=Lines, verbosity=0).run(tests)
    sys.exit(not outcome.wasSuccessful())


if __name__ == "__main__":
    main()
